#include "calibration/hand_eye/other_reading.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/hand_eye/start.hpp"

namespace slom::calibration {
namespace {

constexpr OtherReading as_given{}, inverse_poses{true, false}, w_first{false, true},
    w_first_inverse{true, true};

/// Readings of hand and camera to try, simple ones first. Inverting both streams in addition exchanges the unknowns and
/// changes no residual, so of two such readings one is enough.
constexpr std::pair<OtherReading, OtherReading> readings_to_try[] = {
    {as_given, inverse_poses},   {as_given, w_first},         {w_first, as_given},       {w_first, w_first},
    {as_given, w_first_inverse}, {w_first_inverse, as_given}, {w_first, w_first_inverse}};

/// Returns whether the poses of the file would be inverted.
bool invertsFile(const OtherReading& seems, const PoseStream& stream) {
  return seems.is_inverse != stream.is_inverted;
}

/// Inverts both streams in addition if files are then taken as they are.
void preferFilesAsTheyAre(const PoseStream& hand, const PoseStream& camera, HandEyeResult& result) {
  if (!invertsFile(result.hand_seems, hand) || !invertsFile(result.camera_seems, camera)) return;
  result.hand_seems.is_inverse = !result.hand_seems.is_inverse;
  result.camera_seems.is_inverse = !result.camera_seems.is_inverse;
}

/// Adds what a stream agrees better with, and what to do.
void describe(const OtherReading& seems, const PoseStream& stream, const std::string& name, const char* more,
              std::vector<std::string>& changes, std::vector<std::string>& remedies) {
  if (seems.has_w_first) {
    changes.push_back(fmt::format("the quaternions of {} in the order w, x, y, z", name));
    remedies.push_back("name its columns qw,qx,qy,qz in a header");
  }
  if (!seems.is_inverse) return;
  changes.push_back(stream.is_inverted ? fmt::format("the poses of {} as the file has them", name)
                                       : fmt::format("the inverse poses of {}{}", name, more));
  remedies.push_back(stream.is_inverted ? "do not invert them" : "invert them");
}

}  // namespace

bool findOtherReading(const Streams& streams, const PoseStream& hand, const PoseStream& camera, double shift,
                      const HandEyeSettings& settings, HandEyeResult& result) {
  constexpr double far_better = 4, alike = 1.5;
  const double extent = std::max(extentOf(streams), 1e-3);
  const auto misfitOf = [&](const OtherReading& of_hand, const OtherReading& of_camera) {
    const HandEyeStart start =
        startAt(streams, shift, settings, {{of_hand, hand.is_inverted}, {of_camera, camera.is_inverted}});
    return start.misfit_m + extent * start.misfit_rad;
  };
  // Rotations alone cannot tell inverse poses from another order of quaternions: positions decide.
  double least = misfitOf(as_given, as_given) / far_better * alike;
  bool is_found = false;
  for (const auto& [of_hand, of_camera] : readings_to_try) {
    const double misfit = misfitOf(of_hand, of_camera);
    if (!(alike * misfit < least)) continue;
    least = misfit;
    result.hand_seems = of_hand;
    result.camera_seems = of_camera;
    is_found = true;
  }
  if (is_found) preferFilesAsTheyAre(hand, camera, result);
  return is_found;
}

std::string sentenceOnReading(const PoseStream& hand, const std::string& hand_name, const PoseStream& camera,
                              const std::string& camera_name, const HandEyeResult& result) {
  std::vector<std::string> changes, remedies;
  const bool is_ambiguous = !hand.is_inverted && !camera.is_inverted && !result.hand_seems.has_w_first &&
                            !result.camera_seems.has_w_first;
  const std::string either = is_ambiguous ? fmt::format(", or those of {},", hand_name) : "";
  describe(result.hand_seems, hand, hand_name, "", changes, remedies);
  describe(result.camera_seems, camera, camera_name, either.c_str(), changes, remedies);
  remedies.erase(std::unique(remedies.begin(), remedies.end()), remedies.end());
  return fmt::format("{} agree far better, so {}", fmt::join(changes, " and "),
                     fmt::join(remedies, ", and "));
}

}  // namespace slom::calibration
