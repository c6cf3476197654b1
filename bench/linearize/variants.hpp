/// Residuals and Jacobians of each data set: written by hand, by Ceres, by SLoM. The data must outlive the
/// variants.
#pragma once

#include <vector>

#include "linearize/data.hpp"
#include "support/variants.hpp"

namespace slom::bench {

/// Closed formulas as an expert writes them, one measurement after another, without products with known zeros.
Variant byHand(const BalData& data);
Variant byHand(const PoseGraphData& data);
Variant byHand(const StereoData& data);

/// ceres::AutoDiffCostFunction, evaluated without a ceres::Problem.
Variant byCeres(const BalData& data);
Variant byCeres(const PoseGraphData& data);
Variant byCeres(const StereoData& data);

/// Variants of slom::Linearizer on one thread, including all its work. They use the functions of measurements.hpp as
/// they are, the same functions vectorised (if the library supports it), and functions of double alone, which the
/// library differentiates numerically.
std::vector<Variant> bySlom(const BalData& data);
std::vector<Variant> bySlom(const PoseGraphData& data);
std::vector<Variant> bySlom(const StereoData& data);

}  // namespace slom::bench
