// Texts about compared models.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns a table, and which model to take.
std::string comparisonText(const Comparison& comparison);
/// Returns a table for shapes of the board, and which shape to take.
std::string boardShapesText(const Comparison& comparison);
/// Returns a table for quantities that the noise may grow with, and which one to take.
std::string noiseText(const NoiseComparison& comparison, const Result& result);
/// Returns a table for the readout of rows, by camera, and whether there is one.
std::string readoutText(const std::vector<std::optional<ReadoutTrial>>& trials, const Result& result);

}  // namespace slom::app::calib
