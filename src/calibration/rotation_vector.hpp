// The uncertainty of a rotation, seen in the components of its rotation vector.
#pragma once

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// How log(R [+] d) follows d: the inverse of the right Jacobian of SO(3).
Eigen::Matrix3d rotationVectorJacobian(const SO3& R);

/// Standard deviations of log(R [+] d) for d of this covariance (perturbations on the right) [rad], by the
/// inverse of the right Jacobian of SO(3); Chirikjian, Stochastic Models, Information Theory, and Lie Groups
/// 2, 2012, (10.86).
vec3 rotationVectorStd(const SO3& R, const Eigen::Matrix3d& covariance);

}  // namespace slom::calibration
