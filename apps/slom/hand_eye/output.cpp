#include "hand_eye/output.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <slom/calibration/number_text.hpp>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::hand_eye {
namespace {

using calibration::HandEyeResult;
using calibration::NumberEstimate;
using calibration::PoseEstimate;
using calibration::PoseStream;
using calibration::withStd;
using Json = nlohmann::ordered_json;

constexpr double to_deg = 180 / std::numbers::pi;

/// Returns a line on the poses of a stream, and one on what they were taken as.
std::string linesOf(const char* moving, const char* fixed, const PoseStream& stream, bool has_times) {
  const std::size_t count = stream.poses.size();
  std::string text = fmt::format("  {:<8}{}: {}", moving, oneLine(stream.file), plural(count, "pose"));
  if (has_times) {
    const double seconds = stream.poses.back().t_s - stream.poses.front().t_s;
    text += fmt::format(" in {:.1f} s, {:.1f} per second", seconds,
                        seconds > 0 ? double(count - 1) / seconds : 0);
  }
  const auto [outer, inner] = stream.is_inverted ? std::pair(moving, fixed) : std::pair(fixed, moving);
  return text +
         fmt::format("\n          taken as {}_T_{}: poses of the {} in the {}\n", outer, inner, inner, outer);
}

/// A row of three components with their clustered and plain standard deviations.
std::string row(const std::string& name, const Eigen::Vector3d& value, const Eigen::Vector3d& clustered,
                const Eigen::Vector3d& plain) {
  std::string text;
  constexpr char axes[] = "xyz";
  for (int k = 0; k < 3; ++k) {
    const auto [number, std] = withStd(value[k], clustered[k]);
    text += fmt::format("  {:<22}{}{:>14}{:>16}{:>16}\n", k == 0 ? name : "", axes[k], number, std,
                        std::isfinite(plain[k]) ? calibration::twoDigits(plain[k]) : "not determined");
  }
  return text;
}

std::string poseText(const char* name, const PoseEstimate& estimate, const char* outer, const char* inner) {
  const auto& R = estimate.pose.orient;
  const Eigen::Vector3d turn = calibration::SO3::log(R) * to_deg;
  return fmt::format("\n{:<25}{:>14}{:>16}{:>16}\n", name, "value", "std clustered", "std") +
         row(fmt::format("translation [m]"), estimate.pose.pos, estimate.std_clustered.head<3>(),
             estimate.std.head<3>()) +
         row("rotation vector [deg]", turn, estimate.std_clustered.tail<3>() * to_deg,
             estimate.std.tail<3>() * to_deg) +
         fmt::format("  quaternion x y z w     {:.8f} {:.8f} {:.8f} {:.8f}\n", R.x(), R.y(), R.z(), R.w()) +
         fmt::format("  p_{} = R p_{} + t\n", outer, inner) +
         fmt::format("  std: along the axes of the {}; small turns about those of the {}\n", outer, inner);
}

std::string numberText(const std::string& name, const NumberEstimate& number, const char* unit) {
  if (number.std == 0) return fmt::format("{:<25}{:>14.6g}{:>16}\n", name, number.value, "known");
  const auto [value, std] = withStd(number.value, number.std_clustered);
  return fmt::format("{:<25}{:>14}{:>16}{:>16}{}\n", name, value, std,
                     std::isfinite(number.std) ? calibration::twoDigits(number.std) : "not determined", unit);
}

std::string outliersText(const HandEyeResult& result) {
  constexpr std::size_t most = 5;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, result.outliers.size()); ++i) {
    const auto& outlier = result.outliers[i];
    text += fmt::format("    {}, {:.4f} s: {:.3g} degrees, {:.3g} mm\n", oneLine(outlier.place), outlier.t_s,
                        outlier.rotation_deg, 1e3 * outlier.translation_m);
  }
  if (result.outliers.size() > most) text += fmt::format("    and {} more\n", result.outliers.size() - most);
  return text;
}

/// Returns what is free, each sentence once.
std::vector<std::string> freeTexts(const HandEyeResult& result) {
  std::vector<std::string> texts;
  for (const auto& free : result.free) {
    if (std::find(texts.begin(), texts.end(), free.text) == texts.end()) texts.push_back(free.text);
  }
  return texts;
}

Json jsonOf(const PoseEstimate& estimate) {
  const Eigen::Matrix3d R = estimate.pose.orient.toRotationMatrix();
  Json json;
  json["rotation"] = Json::array();
  for (int i = 0; i < 9; ++i) json["rotation"].push_back(R(i / 3, i % 3));
  const auto& q = estimate.pose.orient;
  json["quaternion_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
  json["translation"] = {estimate.pose.pos[0], estimate.pose.pos[1], estimate.pose.pos[2]};
  for (int k = 0; k < 6; ++k) json["std"].push_back(estimate.std[k]);
  for (int k = 0; k < 6; ++k) json["std_clustered"].push_back(estimate.std_clustered[k]);
  return json;
}

Json jsonOf(const NumberEstimate& number, bool is_estimated) {
  return {{"value", number.value},
          {"std", number.std},
          {"std_clustered", number.std_clustered},
          {"estimated", is_estimated}};
}

}  // namespace

std::string streamsText(const Streams& streams) {
  const bool has_times = !streams.settings.pairs;
  return "hand-eye calibration\n" + linesOf("hand", "base", streams.hand, has_times) +
         linesOf("camera", "target", streams.camera, has_times);
}

std::string resultText(const Streams& streams, const HandEyeResult& result) {
  std::string text = poseText("hand_T_camera", result.hand_T_camera, "hand", "camera");
  if (result.base_T_target) text += poseText("base_T_target", *result.base_T_target, "base", "target");
  text += "\n";
  if (!streams.settings.pairs)
    text += numberText("time offset [s]", result.time_offset_s, "") + "  t_hand = t_camera + offset\n";
  if (streams.settings.estimate_scale) text += numberText("scale of the camera", result.scale, "");
  text += fmt::format("\n  {} compared, {} without a pose of the other file\n",
                      result.motions > 0 ? plural(std::size_t(result.motions), "motion")
                                         : plural(std::size_t(result.rows), "row"),
                      result.unused);
  text += fmt::format("  residuals: {:.3g} degrees and {:.3g} mm RMS, {:.3g} degrees and {:.3g} mm median\n",
                      result.rms_rotation_deg, 1e3 * result.rms_translation_m, result.median_rotation_deg,
                      1e3 * result.median_translation_m);
  text += fmt::format("  turns of the hand about three axes: {:.3g}, {:.3g} and {:.3g} degrees RMS\n",
                      result.turns_deg[0], result.turns_deg[1], result.turns_deg[2]);
  text += fmt::format("  {} left out{}\n", plural(result.outliers.size(), "outlier"),
                      result.outliers.empty() ? "" : ":") +
          outliersText(result);
  for (const std::string& free : freeTexts(result)) text += bulleted("not determined: " + free) + "\n";
  for (const std::string& warning : result.warnings) text += bulleted("warning: " + oneLine(warning)) + "\n";
  return text + (result.success() ? "\nConverged; the motion determines everything.\n" : "");
}

std::string failureText(const Streams& streams, const HandEyeResult& result) {
  std::string text = result.message;
  for (const auto& [stream, seems, option] : {std::tuple(&streams.hand, &result.hand_seems, "--invert-hand"),
                                              {&streams.camera, &result.camera_seems, "--invert-camera"}}) {
    if (seems->is_inverse) text += fmt::format(": {} {}", stream->is_inverted ? "drop" : "pass", option);
  }
  if (!result.converged) return text;
  return result.free.front().text;
}

std::string toJson(const Streams& streams, const HandEyeResult& result) {
  const auto& settings = streams.settings;
  Json json;
  json["converged"] = result.converged;
  json["message"] = result.message;
  json["undetermined"] = Json::array();
  for (const std::string& free : freeTexts(result)) json["undetermined"].push_back(free);
  json["warnings"] = result.warnings;
  json["hand_T_camera"] = jsonOf(result.hand_T_camera);
  json["base_T_target"] = result.base_T_target ? jsonOf(*result.base_T_target) : Json();
  json["time_offset_s"] = jsonOf(result.time_offset_s, settings.estimate_offset);
  json["scale"] = jsonOf(result.scale, settings.estimate_scale);
  json["rows"] = result.rows;
  json["rows_unused"] = result.unused;
  json["motions"] = result.motions;
  json["rms_rotation_deg"] = result.rms_rotation_deg;
  json["rms_translation_m"] = result.rms_translation_m;
  json["median_rotation_deg"] = result.median_rotation_deg;
  json["median_translation_m"] = result.median_translation_m;
  json["sigma_rotation_deg"] = result.sigma_rotation_rad * to_deg;
  json["sigma_translation_m"] = result.sigma_translation_m;
  json["turns_deg"] = {result.turns_deg[0], result.turns_deg[1], result.turns_deg[2]};
  json["block_s"] = result.block_s;
  json["outliers"] = Json::array();
  for (const auto& outlier : result.outliers)
    json["outliers"].push_back({{"place", outlier.place},
                                {"t_s", outlier.t_s},
                                {"rotation_deg", outlier.rotation_deg},
                                {"translation_m", outlier.translation_m}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace slom::app::hand_eye
