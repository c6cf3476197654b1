// Correlation of long series.
#pragma once

#include <vector>

namespace slom::calibration {

/// Returns c[k] = sum_i a[i] b[i + k - (a.size() - 1)] for all shifts at which the series overlap, by fast Fourier
/// transforms; a.size() + b.size() - 1 numbers.
std::vector<double> crossCorrelation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace slom::calibration
