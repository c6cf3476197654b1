// Compared models as people read them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// A table, and which model to take.
std::string comparisonText(const Comparison& comparison);
/// The same of the shapes of the board.
std::string boardShapesText(const Comparison& comparison);
/// The same of what the noise grows with.
std::string noiseText(const NoiseComparison& comparison, const Result& result);
/// The same of the readout of rows, by camera.
std::string readoutText(const std::vector<std::optional<ReadoutTrial>>& trials, const Result& result);

}  // namespace slom::app::calib
