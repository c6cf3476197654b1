#include "calibration/streams/board_scale.hpp"

#include <cmath>

#include <fmt/format.h>

#include "calibration/streams/doubt.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double least_board_deviations = 4;
constexpr double least_board_change = 0.005;

}  // namespace

bool isOtherSize(const BoardScale& scale) {
  const double change = std::abs(scale.value - 1);
  return change > least_board_change && change > least_board_deviations * scale.std;
}

BoardScale StreamProblem::boardScale(const Options& options) {
  freeBoardScale();
  if (!optimize(options).converged) return {};
  return boardScaleOf(est_, board_scale_, [&] { return byBlocks(); });
}

void noteBoardScale(const std::function<BoardScale()>& fit, ImuAxes axes, StreamResult& result) {
  if (!result.success()) return;
  BoardScale scale;
  try {
    scale = fit();
  } catch (const slom::Error&) {
    return;  // the result without the scale stands
  }
  if (!isOtherSize(scale)) return;
  // Gravity holds the scale of the accelerometer only if that is estimated.
  addDoubt(fmt::format("the readings fit a board that is {:.4f} +- {:.4f} times as large as stated",
                       scale.value, scale.std),
           axes == ImuAxes::calibrated
               ? "measure --square. A wrong scale of the accelerometer looks alike: if the size is right, "
                 "add --imu-model scale-misalignment."
               : "measure --square, and check the value of gravity.",
           result);
}

}  // namespace slom::calibration
