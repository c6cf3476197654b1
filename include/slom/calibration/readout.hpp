/// Rolling shutters: cameras that read out the rows of an image one after another.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

struct Dataset;
struct Result;

/// The time from the reading of the first row of an image to that of the last row, in intervals between successive
/// image numbers. If negative, the rows are read upwards.
struct Readout {
  double value = 0;
  double std = std::numeric_limits<double>::quiet_NaN();  ///< for noise alone
  double std_clustered =
      std::numeric_limits<double>::quiet_NaN();  ///< for errors that successive images share

  /// Returns the larger standard deviation: few blocks of images may show a clustered one that is too small.
  double largestStd() const { return std_clustered > std ? std_clustered : std; }
};

/// Estimate of a rolling shutter from the residuals of a fit without readout.
struct ReadoutTrial {
  Readout readout;  ///< to first order
  /// p-value: that images without readout show as much by chance (ResidualPattern::probability).
  double probability = 1;
  /// Returns whether a readout is significant.
  bool isFound() const;
};

/// Returns a trial for each camera of a successful result; nothing if its corners are not known to move, or if its readout
/// was estimated. `data` must be those passed to calibrate().
std::vector<std::optional<ReadoutTrial>> compareReadout(const Dataset& data, const Result& result);

}  // namespace slom::calibration
