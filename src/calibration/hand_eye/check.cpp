#include "calibration/hand_eye/check.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include <fmt/format.h>

#include "calibration/hand_eye/track.hpp"
#include "calibration/text.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

[[noreturn]] void badStream(const std::string& sentence) {
  throw DataError("slom.calibration.bad-stream", sentence);
}
[[noreturn]] void badSettings(const std::string& sentence) {
  throw DataError("slom.calibration.bad-settings", sentence);
}

std::string nameOf(const PoseStream& stream) { return stream.file.empty() ? "stream" : stream.file; }

bool isFinite(const StampedPose& pose) {
  return std::isfinite(pose.t_s) && pose.pose.pos.allFinite() && pose.pose.orient.coeffs().allFinite();
}

void checkStream(const PoseStream& stream, bool has_order) {
  constexpr std::size_t least_poses = 3;
  if (stream.poses.size() < least_poses)
    badStream(fmt::format("{}: there {} {}; record at least {}, with turns about two axes", nameOf(stream),
                          stream.poses.size() == 1 ? "is" : "are", counted(stream.poses.size(), "pose"),
                          least_poses));
  for (std::size_t i = 0; i < stream.poses.size(); ++i) {
    if (!isFinite(stream.poses[i]))
      badStream(fmt::format("{}: the pose is not finite; leave it out", stream.place(i)));
    if (!has_order || i == 0) continue;
    const double before = stream.poses[i - 1].t_s, now = stream.poses[i].t_s;
    if (now < before)
      badStream(
          fmt::format("{}: the time {:.9f} s is {:.6g} s before the one above; sort the rows by time, or "
                      "remove those of a clock that was set back",
                      stream.place(i), now, before - now));
  }
  if (has_order && !(stream.poses.back().t_s > stream.poses.front().t_s))
    badStream(fmt::format("{}: all poses have the same time; write the time of each, or pass pairs of poses",
                          nameOf(stream)));
}

/// Returns the words in the name of a file without its folders, in small letters.
std::vector<std::string> wordsInName(const std::string& file) {
  std::vector<std::string> words(1);
  for (const char c : file.substr(file.find_last_of("/\\") + 1)) {
    if (std::isalpha(static_cast<unsigned char>(c)) != 0)
      words.back() += char(std::tolower(static_cast<unsigned char>(c)));
    else
      words.emplace_back();
  }
  return words;
}

}  // namespace

void checkStreams(const PoseStream& hand, const PoseStream& camera, const HandEyeSettings& settings) {
  if (!std::isfinite(settings.time_offset_s))
    badSettings(fmt::format("HandEyeSettings::time_offset_s is {:g}; give seconds", settings.time_offset_s));
  if (!(settings.motion_s > 0) || !std::isfinite(settings.motion_s))
    badSettings(fmt::format("HandEyeSettings::motion_s is {:g}; give seconds above 0", settings.motion_s));
  if (!(settings.outlier_sigmas >= 2))
    badSettings(fmt::format("HandEyeSettings::outlier_sigmas is {:g}; give a number from 2 on",
                            settings.outlier_sigmas));
  for (const PoseStream* stream : {&hand, &camera}) {
    if (!settings.pairs && !stream->has_times)
      badStream(
          fmt::format("{}: there is no column of times; add t_s, or pass pairs of poses", nameOf(*stream)));
    checkStream(*stream, !settings.pairs);
  }
  if (settings.pairs && hand.poses.size() != camera.poses.size())
    badStream(fmt::format(
        "{} has {} and {} has {}; give a row in both for each moment, or compare them by time", nameOf(hand),
        counted(hand.poses.size(), "pose"), nameOf(camera), counted(camera.poses.size(), "pose")));
}

std::vector<std::string> noticesOf(const PoseStream& stream) {
  std::vector<std::string> notices;
  std::size_t equal = 0, first_equal = 0, gaps = 0, largest = 0;
  double longest = 0, missing = 0;
  const Track track(stream.poses, stream.poses.front().t_s);
  for (std::size_t i = 1; i < stream.poses.size(); ++i) {
    const double step = stream.poses[i].t_s - stream.poses[i - 1].t_s;
    if (step == 0 && equal++ == 0) first_equal = i;
    if (step <= track.mostStep()) continue;
    ++gaps;
    missing += step;
    if (step > longest) longest = step, largest = i;
  }
  if (equal > 0)
    notices.push_back(
        fmt::format("{}: {} the time of the row above (first at {:.6f} s); the later one is left out",
                    stream.place(first_equal), equal == 1 ? "1 row has" : fmt::format("{} rows have", equal),
                    stream.poses[first_equal].t_s));
  if (gaps > 0)
    notices.push_back(fmt::format(
        "{}: {} without poses, {:.3g} s in all, the longest {:.3g} s before {:.6f} s; nothing is interpolated there",
        stream.place(largest), counted(gaps, "gap"), missing, longest, stream.poses[largest].t_s));
  return notices;
}

std::string noticeOfNames(const PoseStream& hand, const PoseStream& camera) {
  constexpr std::array of_hands{"hand", "base", "robot", "arm", "gripper", "flange", "tool", "tcp", "mocap"};
  constexpr std::array of_cameras{"camera", "cam", "target", "board", "tag", "eye", "pnp"};
  const auto hasOne = [](const PoseStream& stream, const auto& words) {
    const std::vector<std::string> all = wordsInName(stream.file);
    return std::any_of(words.begin(), words.end(), [&](const char* word) {
      return std::find(all.begin(), all.end(), word) != all.end();
    });
  };
  if (!hasOne(hand, of_cameras) || hasOne(hand, of_hands) || !hasOne(camera, of_hands) ||
      hasOne(camera, of_cameras))
    return "";
  return fmt::format(
      "by their names, {} is of a camera and {} of a hand, but they were given the other way round; the poses fit either "
      "way, with inverse transforms, so give the file of the hand first",
      nameOf(hand), nameOf(camera));
}

}  // namespace slom::calibration
