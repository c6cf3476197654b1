#include <array>
#include <cmath>

#include <fmt/format.h>

#include "calibration/quality/verdict/doubts.hpp"
#include "slom/calibration/assess.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

std::string thirdOf(const FurtherView& view) {
  constexpr std::array<const char*, 3> rows{"upper", "middle", "lower"}, columns{"left", "middle", "right"};
  if (view.row == 1 && view.column == 1) return "middle";
  if (view.row == 1) return columns[std::size_t(view.column)];
  if (view.column == 1) return fmt::format("{} middle", rows[std::size_t(view.row)]);
  return fmt::format("{} {}", rows[std::size_t(view.row)], columns[std::size_t(view.column)]);
}

}  // namespace

std::string placeOf(const FurtherView& view, const Result& result) {
  const std::string attitude =
      view.edge_away.empty()
          ? "facing the camera"
          : fmt::format("tilted by {:.0f} degrees, its {} edge farther away", view.tilt_deg, view.edge_away);
  return fmt::format("a board {}, in the {} of the image of {}, at {} m", attitude, thirdOf(view),
                     result.cameras[view.camera].name, twoDigits(view.distance_m));
}

std::string sentenceOf(const FurtherView& view, const Result& result) {
  const auto is_third = [](int i) { return i >= 0 && i < 3; };
  if (view.camera >= result.cameras.size() || !is_third(view.column) || !is_third(view.row)) {
    throw DataError(
        "slom.calibration.bad-question",
        fmt::format("there is no camera {} with a column {} and a row {}; pass one of the further views of "
                    "this result's quality",
                    view.camera, view.column, view.row),
        "view");
  }
  return fmt::format("{}: from {} to {} px{}", placeOf(view, result), twoDigits(view.before_px),
                     twoDigits(view.after_px), std::isfinite(view.of_distance_m) ? "" : " at infinity");
}

}  // namespace slom::calibration
