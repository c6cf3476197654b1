#include "calibration/hand_eye/words.hpp"

#include <cmath>

#include <fmt/format.h>

#include "calibration/hand_eye/other_reading.hpp"
#include "calibration/text.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

std::string nameOf(const PoseStream& stream, const char* otherwise) {
  return stream.file.empty() ? otherwise : stream.file;
}

std::string spanOf(const PoseStream& stream) {
  return fmt::format("{:.3f} s to {:.3f} s", stream.poses.front().t_s, stream.poses.back().t_s);
}

[[noreturn]] void noCommonTime(const std::string& sentence) {
  throw DataError("slom.calibration.no-common-time", sentence);
}

/// Warns if the clocks differ by more than a second: a delayed sensor, or another epoch.
void warnOfClocks(const std::string& hand, const std::string& camera, double offset, HandEyeResult& result) {
  constexpr double delay = 1, epoch = 1e5;
  const double size = std::abs(offset);
  if (size < delay) return;
  const std::string& late = offset > 0 ? hand : camera;
  const std::string& early = offset > 0 ? camera : hand;
  if (size < epoch) {
    result.warnings.push_back(fmt::format(
        "the stamps of {} are {:.3f} s later than those of {}; if both shall have one clock, correct the sensor that is "
        "delayed",
        late, size, early));
  } else {
    result.warnings.push_back(
        fmt::format("the clocks of {} and {} have other epochs: {:.3f} s apart; add the offset to the "
                    "times of the camera wherever both are used",
                    hand, camera, size));
  }
}

void warnOfOverlap(const Streams& streams, const std::string& slow, const std::string& fast,
                   HandEyeResult& result) {
  constexpr double most_unused = 0.2;
  if (result.unused <= most_unused * double(streams.rows.size())) return;
  result.warnings.push_back(
      fmt::format("{} of {} rows of {} have no pose of {} at their time; record both for the whole motion",
                  result.unused, streams.rows.size(), slow, fast));
}

void warnOfOutliers(const HandEyeResult& result, std::vector<std::string>& warnings) {
  constexpr double many = 0.2;
  const int compared = result.motions > 0 ? result.motions : result.rows;
  if (double(result.outliers.size()) <= many * compared) return;
  warnings.push_back(fmt::format(
      "{} of {} rows are outliers; look at their times in both recordings, and leave out where one of them lost track",
      result.outliers.size(), compared));
}

/// Warns if noise of the poses looks like motion to the fit.
void warnOfMotion(const Streams& streams, const std::string& fast, const Freedom& freedom,
                  const HandEyeSettings& settings, HandEyeResult& result) {
  constexpr double weak = 10, noisy = 2;
  if (freedom.least_response < weak && result.free.empty())
    result.warnings.push_back(fmt::format(
        "the motion is weak: it moves the residuals only {:.1f} times as much as noise does, so values may be "
        "off by some percent more than stated; turn the hand farther, about several axes",
        freedom.least_response));
  if (!settings.estimate_offset || settings.pairs || freedom.motion_per_step > noisy) return;
  const Track& track = streams.interpolates_hand ? streams.hand : streams.camera;
  result.warnings.push_back(fmt::format(
      "successive poses of {} differ by noise rather than by motion, so the time offset may be off by half "
      "their distance, {:.2g} s, more than stated; smooth them, or leave out rows",
      fast, track.step() / 2));
}

}  // namespace

void requireCommonTime(const HandEyeStart& start, const PoseStream& hand, const PoseStream& camera,
                       const HandEyeSettings& settings) {
  if (start.rows >= int(least_items)) return;
  const std::string spans = fmt::format("{} lasts from {}, {} from {}", nameOf(hand, "the hand"),
                                        spanOf(hand), nameOf(camera, "the camera"), spanOf(camera));
  if (settings.estimate_offset || settings.pairs)
    noCommonTime(
        fmt::format("{}: nowhere do both move alike; record one motion with both, of some seconds", spans));
  noCommonTime(
      fmt::format("{}: with the time offset {:g} s they have {} in common; correct the offset, or let it be "
                  "estimated",
                  spans, settings.time_offset_s, counted(std::size_t(start.rows), "row")));
}

void requireItems(const RobustFit& fit, const Streams& streams, const PoseStream& hand,
                  const PoseStream& camera) {
  if (fit.goodItems().size() >= least_items) return;
  noCommonTime(
      fmt::format("{} and {}: {} of {} agree with each other; record one motion with both, with turns of 20 "
                  "degrees or more",
                  nameOf(hand, "hand"), nameOf(camera, "camera"), fit.goodItems().size(),
                  slom::calibration::counted(streams.rows.size(), "row")));
}

void judge(const Streams& streams, const PoseStream& hand, const PoseStream& camera,
           const HandEyeSettings& settings, const HandEyeStart& start, const Freedom& freedom,
           HandEyeResult& result) {
  const std::string hand_name = nameOf(hand, "the hand"), camera_name = nameOf(camera, "the camera");
  if (!settings.pairs) {
    warnOfClocks(hand_name, camera_name, result.time_offset_s.value, result);
    warnOfOverlap(streams, streams.interpolates_hand ? camera_name : hand_name,
                  streams.interpolates_hand ? hand_name : camera_name, result);
  }
  warnOfOutliers(result, result.warnings);
  warnOfMotion(streams, streams.interpolates_hand ? hand_name : camera_name, freedom, settings, result);
  // As large as the motion itself: no motion is explained.
  constexpr double unlike = 0.5, least_turn = 5;
  const double turns = result.turns_deg.norm();
  const bool agree_in_turns = result.rms_rotation_deg<unlike * turns, turn = turns> least_turn;
  const bool agree_in_moves = result.rms_translation_m < unlike * extentOf(streams);
  const bool are_few = double(result.outliers.size()) < 0.5 * std::max(result.motions, result.rows);
  const bool is_one_motion = (turn ? agree_in_turns : agree_in_moves) && are_few;
  if (is_one_motion && agree_in_moves) return;
  const bool is_found = findOtherReading(streams, hand, camera, start.alike_shift, settings, result);
  if (is_one_motion && !is_found) return;
  result.converged = false;
  result.free.clear();
  result.message = fmt::format(
      "{} and {} do not describe one motion: residuals of {:.3g} degrees and {:.3g} m remain, of turns of {:.3g} degrees",
      hand_name, camera_name, result.rms_rotation_deg, result.rms_translation_m, turns);
  result.message +=
      is_found
          ? "; " + sentenceOnReading(hand, hand_name, camera, camera_name, result)
          : "; check that both are on one rigid body, that quaternions are qx,qy,qz,qw, and the frames of the poses";
}

}  // namespace slom::calibration
