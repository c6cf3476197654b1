/// Rolling shutters: cameras that read out the rows of an image one after the other.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

struct Dataset;
struct Result;

/// The time from the reading of the first row of an image to that of the last one, in intervals from one image number to the next. Below 0: the rows are
/// read upwards.
struct Readout {
  double value = 0;
  double std = std::numeric_limits<double>::quiet_NaN();  ///< for noise alone
  double std_clustered =
      std::numeric_limits<double>::quiet_NaN();  ///< for errors that successive images share
};

/// What residuals of a fit without readout say about it.
struct ReadoutTrial {
  Readout readout;  ///< to first order
  double probability =
      1;  ///< that images without readout show as much by chance (ResidualPattern::probability)
  /// Whether it is there beyond chance.
  bool isFound() const;
};

/// By camera, of a result that succeeded; nothing where corners are not known to move. `data` as passed to calibrate().
std::vector<std::optional<ReadoutTrial>> compareReadout(const Dataset& data, const Result& result);

}  // namespace slom::calibration
