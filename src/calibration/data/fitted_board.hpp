// The data with corners moved to where the fit places the corners of the board (FittedBoard).
#pragma once

#include <optional>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The caller's data if the board is flat, otherwise a copy of them on the fitted board. Points that are not in the
/// fit keep their coordinates.
class DataOnBoard {
 public:
  /// Takes the data. `data` must outlive this object.
  DataOnBoard(const Dataset& data, const std::optional<FittedBoard>& board);
  DataOnBoard(const DataOnBoard&) = delete;
  DataOnBoard& operator=(const DataOnBoard&) = delete;

  const Dataset& operator*() const { return copy_ ? *copy_ : *data_; }

 private:
  const Dataset* data_;
  std::optional<Dataset> copy_;
};

}  // namespace slom::calibration
