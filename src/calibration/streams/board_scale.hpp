// A board of another size than stated.
#pragma once

#include <algorithm>
#include <functional>

#include "calibration/streams/problem.hpp"

namespace slom::calibration {

/// Returns whether the size differs from the stated one.
bool isOtherSize(const BoardScale& scale);

/// Returns the size that an estimator has fitted: its larger standard deviation only if the size differs, because
/// clustering takes long. `by_blocks()` returns the clustered covariances.
BoardScale boardScaleOf(const Estimator& est, const VarID<mtk::Scalar<>>& board_scale,
                        const auto& by_blocks) {
  BoardScale scale{double(*board_scale), est.standardDeviation(board_scale)[0]};
  if (isOtherSize(scale)) scale.std = std::max(scale.std, by_blocks().standardDeviation(board_scale)[0]);
  return scale;
}

/// Adds a note if the readings fit a board of another size much better. `fit` returns that size, and may throw slom::Error.
void noteBoardScale(const std::function<BoardScale()>& fit, ImuAxes axes, StreamResult& result);

}  // namespace slom::calibration
