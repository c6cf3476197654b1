#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/quality/verdict/doubts.hpp"
#include "slom/calibration/number_text.hpp"
#include "slom/calibration/stream_verdict.hpp"

namespace slom::calibration {
namespace {

/// Largest standard deviations that a good recording leaves.
constexpr double most_place_mm = 10, most_turn_deg = 0.5, most_clock_ms = 1;

/// The larger ones of stated and clustered standard deviations, over all directions.
struct StreamPrecision {
  double place_mm = 0, turn_deg = 0, clock_ms = 0;

  explicit StreamPrecision(const ImuStreamResult& imu) {
    const auto most = [](const vec3& stated, const vec3& clustered) {
      double largest = 0;
      for (int i = 0; i < 3; ++i) largest = std::fmax(largest, std::fmax(stated[i], clustered[i]));
      return largest;
    };
    place_mm = 1000 * most(imu.translation_std, imu.translation_clustered);
    turn_deg = 180 / std::numbers::pi * most(imu.rotation_std, imu.rotation_clustered);
    clock_ms = 1000 * std::fmax(imu.time_offset_std, imu.time_offset_clustered);
  }
};

void doubtPrecision(const ImuStreamResult& imu, std::vector<std::string>& doubts) {
  const StreamPrecision known(imu);
  std::vector<std::string> open;
  if (known.place_mm > most_place_mm)
    open.push_back(fmt::format("the position of {} to {} mm", imu.name, twoDigits(known.place_mm)));
  if (known.turn_deg > most_turn_deg)
    open.push_back(fmt::format("the orientation of {} to {} degrees", imu.name, twoDigits(known.turn_deg)));
  if (known.clock_ms > most_clock_ms)
    open.push_back(fmt::format("the clock of {} to {} ms", imu.name, twoDigits(known.clock_ms)));
  if (!open.empty())
    doubts.push_back(
        fmt::format("the recording determines {} only; turn about all axes more quickly, or for longer",
                    fmt::join(open, " and ")));
}

/// Doubts a clock whose offset changes: a drift makes the clustered standard deviation of the offset large, so the stated
/// one decides.
void doubtClock(const ImuStreamResult& imu, std::vector<std::string>& doubts) {
  constexpr double least = 1e-3, much = 10;  // s, stated standard deviations
  if (!imu.halves) return;
  const double difference = std::abs(imu.halves->time_offset),
               stated = imu.halves->time_offset_std /
                        std::fmax(1, imu.time_offset_clustered / imu.time_offset_std);
  if (difference > least && difference > much * stated)
    doubts.push_back(fmt::format(
        "the clock of {} drifts: its offset differs by {} ms between the halves of the recording; correct the rate of its times",
        imu.name, twoDigits(1e3 * difference)));
}

void doubtHalves(const ImuStreamResult& imu, std::vector<std::string>& doubts) {
  constexpr double much = 3.8;  // standard deviations: by chance in one of 1000 recordings, for seven values
  if (!imu.halves) return;
  const auto [deviations, name] = imu.halves->largest();
  if (deviations > much)
    doubts.push_back(fmt::format(
        "halves of the recording differ by {} standard deviations in {}; errors last longer than the standard deviations "
        "allow for, as by a board that is not flat or a lens that is too simple",
        twoDigits(deviations), name));
}

std::string failureOf(const StreamResult& streams) {
  return fmt::format("The fit of the IMU failed: {}. Its values must not be used.",
                     streams.undetermined.empty() ? streams.message : streams.undetermined);
}

std::string precisionText(const StreamResult& streams) {
  std::vector<std::string> all;
  for (const ImuStreamResult& imu : streams.imus) {
    const StreamPrecision known(imu);
    all.push_back(fmt::format("The pose of {} is known to {} mm and {} degrees, and its clock to {} ms",
                              imu.name, twoDigits(known.place_mm), twoDigits(known.turn_deg),
                              twoDigits(known.clock_ms)));
  }
  return fmt::format("{}", fmt::join(all, ". "));
}

}  // namespace

Verdict verdictOf(const StreamResult& streams, const Result& cameras,
                  const std::optional<StreamAgreement>& agreement) {
  Verdict verdict;
  if (!streams.success()) {
    verdict.sentence = failureOf(streams);
    return verdict;
  }
  if (cameras.quality) doubtTimes(cameras, verdict.doubts);
  for (const ImuStreamResult& imu : streams.imus) doubtClock(imu, verdict.doubts);
  verdict.doubts.insert(verdict.doubts.end(), streams.doubts.begin(), streams.doubts.end());
  if (agreement && !agreement->contradiction.empty() && agreement->largest_name.empty())
    verdict.doubts.push_back("splines and preintegration cannot be compared, because one of the fits failed");
  else if (agreement && !agreement->contradiction.empty())
    verdict.doubts.push_back(fmt::format("splines and preintegration differ by {} standard deviations in {}",
                                         fixedDecimals(agreement->largest, 1), agreement->largest_name));
  for (const ImuStreamResult& imu : streams.imus) doubtHalves(imu, verdict.doubts);
  if (verdict.doubts.empty()) {  // others make the standard deviations large, too
    for (const ImuStreamResult& imu : streams.imus) doubtPrecision(imu, verdict.doubts);
  }
  verdict.level = verdict.doubts.empty() ? Verdict::Level::trustworthy : Verdict::Level::doubtful;
  verdict.sentence =
      precisionText(streams) + (verdict.doubts.empty() ? "." : "; but " + verdict.doubts.front() + ".");
  return verdict;
}

}  // namespace slom::calibration
