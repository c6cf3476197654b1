// The data with the corners where the fit finds those of the board (FittedBoard).
#pragma once

#include <optional>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The caller's data where the board is flat, and otherwise a copy of them on the fitted board. Points that the fit did not know stay as they are.
class DataOnBoard {
 public:
  /// `data` must live as long.
  DataOnBoard(const Dataset& data, const std::optional<FittedBoard>& board);
  DataOnBoard(const DataOnBoard&) = delete;
  DataOnBoard& operator=(const DataOnBoard&) = delete;

  const Dataset& operator*() const { return copy_ ? *copy_ : *data_; }

 private:
  const Dataset* data_;
  std::optional<Dataset> copy_;
};

}  // namespace slom::calibration
