/// The same fits by Ceres.
#pragma once

#include "support/nist/fit.hpp"

namespace slom::bench {

enum class CeresMethod { levenberg_marquardt, dog_leg };

/// Ceres begins with a trust region of 1e4, which is its inverse damping.
constexpr double kCeresRadius = 1e4;

/// Tolerances and iterations as in Ceres' own program for these problems (examples/nist.cc), but for the function tolerance;
/// derivatives are automatic, systems are solved by dense QR. Standard deviations: ceres::Covariance times RSS / redundancy.
testing::nist::Fit fitByCeres(const testing::nist::Problem& problem, const Eigen::VectorXd& start,
                              CeresMethod method, double initial_radius);

}  // namespace slom::bench
