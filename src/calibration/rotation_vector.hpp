// The uncertainty of a rotation, expressed in the components of its rotation vector.
#pragma once

#include <numbers>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

inline constexpr double degrees_per_radian = 180 / std::numbers::pi;

/// Returns the derivative of log(R [+] d) by d at d = 0: the inverse of the right Jacobian of SO(3).
Eigen::Matrix3d rotationVectorJacobian(const SO3& R);

/// Returns the standard deviations of log(R [+] d) for d of this covariance (perturbations on the right) [rad], by
/// the inverse of the right Jacobian of SO(3). Source: Chirikjian, Stochastic Models, Information Theory, and Lie
/// Groups 2, 2012, (10.86).
vec3 rotationVectorStd(const SO3& R, const Eigen::Matrix3d& covariance);

}  // namespace slom::calibration
