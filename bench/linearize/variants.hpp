/// Residuals and Jacobians of each data set: written by hand, by Ceres, by SLoM. The data must outlive the
/// variants.
#pragma once

#include <vector>

#include "linearize/data.hpp"
#include "support/variants.hpp"

namespace slom::bench {

/// What an expert writes: closed formulas, one measurement after the other, no product with a known zero.
Variant byHand(const BalData& data);
Variant byHand(const PoseGraphData& data);
Variant byHand(const StereoData& data);

/// ceres::AutoDiffCostFunction, evaluated without a ceres::Problem around it.
Variant byCeres(const BalData& data);
Variant byCeres(const PoseGraphData& data);
Variant byCeres(const StereoData& data);

/// slom::Linearizer on one thread, all it does included: once with the functions of measurements.hpp as they
/// stand, (where the library has it) vectorised, and with functions of double alone, which it differentiates
/// numerically.
std::vector<Variant> bySlom(const BalData& data);
std::vector<Variant> bySlom(const PoseGraphData& data);
std::vector<Variant> bySlom(const StereoData& data);

}  // namespace slom::bench
