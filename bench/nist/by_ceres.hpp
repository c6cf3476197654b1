/// The same fits by Ceres.
#pragma once

#include "support/nist/fit.hpp"

namespace slom::bench {

enum class CeresMethod { levenberg_marquardt, dog_leg };

/// Initial trust region of Ceres, the inverse of its damping.
constexpr double kCeresRadius = 1e4;

/// Fits by Ceres. Tolerances and iterations are those of Ceres' own program for these problems (examples/nist.cc),
/// except the function tolerance. Derivatives are automatic, systems are solved by dense QR. Standard deviations are
/// ceres::Covariance times RSS / redundancy.
testing::nist::Fit fitByCeres(const testing::nist::Problem& problem, const Eigen::VectorXd& start,
                              CeresMethod method, double initial_radius);

}  // namespace slom::bench
