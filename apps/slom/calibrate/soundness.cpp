#include "calibrate/soundness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "plausible.hpp"

namespace slom::app::calib {
namespace {

/// Views that contradict the others, in one sentence; empty: none.
std::string contradiction(const Result& result) {
  constexpr std::size_t most = 5;
  if (result.strays.empty()) return "";
  std::vector<std::string> names;
  double least = most_px, largest = 0;
  for (const Stray& stray : result.strays) {
    const double error = std::isfinite(stray.error_px) ? stray.error_px : most_px;
    least = std::min(least, error);
    largest = std::max(largest, error);
    if (names.size() < most) names.push_back(fmt::format("{}.{}", stray.camera, stray.image));
  }
  const std::size_t count = result.strays.size();
  const std::string errors[] = {fixedDecimals(least, 0), fixedDecimals(largest, 0)};
  const std::string by = errors[0] == errors[1] ? errors[0] : errors[0] + " to " + errors[1];
  const std::string all = fmt::format("{}{}", fmt::join(names, ", "),
                                      count > most ? fmt::format(" and {} more", count - most) : "");
  if (count == 1)
    return fmt::format(
        "an image contradicts the others, by {} px: {}; leave it out by --exclude, or correct its number", by,
        all);
  return fmt::format(
      "{} images contradict the others, by {} px: {}; leave them out by --exclude, or correct their numbers",
      count, by, all);
}

}  // namespace

Unsoundness unsoundnessOf(const Result& result) {
  if (!result.strays.empty()) return {"images contradict each other", contradiction(result)};
  for (const ImuFinding& finding : imuFindings(result)) {
    if (finding.is_unusable)
      return {"the readings of the IMU cannot be right", finding.fault + "; " + finding.remedy};
  }
  return {};
}

}  // namespace slom::app::calib
