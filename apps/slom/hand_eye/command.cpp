// `slom hand-eye`: options, then read -> calibrate -> report and JSON.
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include <slom/calibration/hand_eye.hpp>

#include "error.hpp"
#include "fitting/console.hpp"
#include "hand_eye/hand_eye.hpp"
#include "hand_eye/output.hpp"
#include "help.hpp"
#include "output_files.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app {
namespace hand_eye {
namespace {

constexpr const char* help_text =
    R"(slom hand-eye base_hand.csv target_camera.csv --json result.json

Find where a camera sits on a hand, from two streams of poses.
HAND has the poses of the hand in the base (robot, motion capture), CAMERA those of the camera in
the target. The clocks may differ. The report has both transforms, base_T_hand * hand_T_camera =
base_T_target * target_T_camera, and the time offset, t_hand = t_camera + offset. Files are CSV with
the header t_s,x_m,y_m,z_m,qx,qy,qz,qw, or trajectories of TUM (t x y z qx qy qz qw).
)";

/// The options as text from CLI11.
struct RawOptions {
  std::string hand, camera, offset, motions, outlier_sigmas;
  bool no_offset = false, scale = false, pairs = false, invert_hand = false, invert_camera = false;
  ReportOptions report;
};

double numberOf(const std::string& option, const std::string& text, const std::string& remedy,
                bool (*accepts)(double)) {
  double number = 0;
  if (!parseNumber(text, number) || !std::isfinite(number) || !accepts(number))
    throw UserError(fmt::format("{} {}: {}", option, text, remedy));
  return number;
}

void refuseTogether(bool has_both, const char* a, const char* b) {
  if (has_both) throw UserError(fmt::format("{}: contradicts {}; keep one of them", a, b));
}

calibration::HandEyeSettings settingsOf(const RawOptions& raw) {
  calibration::HandEyeSettings settings;
  refuseTogether(raw.no_offset && !raw.offset.empty(), "--no-offset", "--offset");
  refuseTogether(raw.pairs && !raw.offset.empty(), "--pairs", "--offset");
  refuseTogether(raw.pairs && !raw.motions.empty(), "--pairs", "--motions");
  settings.estimate_offset = !raw.no_offset && raw.offset.empty() && !raw.pairs;
  if (!raw.offset.empty())
    settings.time_offset_s =
        numberOf("--offset", raw.offset, "give t_hand - t_camera in seconds", [](double) { return true; });
  settings.drifting = !raw.motions.empty();
  if (settings.drifting)
    settings.motion_s = numberOf("--motions", raw.motions, "give the length of a motion in seconds, above 0",
                                 [](double s) { return s > 0; });
  if (!raw.outlier_sigmas.empty())
    settings.outlier_sigmas =
        numberOf("--outlier-sigmas", raw.outlier_sigmas, "give a number of standard deviations from 2 on",
                 [](double s) { return s >= 2; });
  settings.estimate_scale = raw.scale;
  settings.pairs = raw.pairs;
  return settings;
}

calibration::PoseStream read(const std::string& file, bool is_inverted, bool are_pairs) {
  calibration::PoseStream stream = calibration::readPoseStream(file);
  if (!stream.has_times && !are_pairs)
    throw UserError(fmt::format(
        "{}: there is no column of times; add t_s, or pass --pairs if the rows of both files belong together",
        file));
  if (!is_inverted) return stream;
  for (calibration::StampedPose& pose : stream.poses) pose.pose = pose.pose.inverse();
  stream.is_inverted = true;
  return stream;
}

void writeJson(const Streams& streams, const calibration::HandEyeResult& result, const RawOptions& raw,
               const Console& console) {
  if (raw.report.json_file.empty()) return;
  const std::string json = toJson(streams, result);
  if (raw.report.jsonToStdout()) {
    say(json);
    return;
  }
  OutputFiles files;
  files.add(raw.report.jsonPath(), json);
  files.commit();
  console.print("\nwritten: " + oneLine(raw.report.jsonPath()) + "\n");
}

void run(const RawOptions& raw) {
  const calibration::HandEyeSettings settings = settingsOf(raw);
  checkResultPaths({{"HAND", raw.hand}, {"CAMERA", raw.camera}}, {{"--json", raw.report.jsonPath()}});
  const Console console(raw.report);
  const Streams streams{read(raw.hand, raw.invert_hand, raw.pairs),
                        read(raw.camera, raw.invert_camera, raw.pairs), settings};
  requireWritable({raw.report.jsonPath()});
  console.print(streamsText(streams));
  const calibration::HandEyeResult result = calibration::handEye(streams.hand, streams.camera, settings);
  console.print(resultText(streams, result));
  writeJson(streams, result, raw, console);
  if (result.success()) return;
  sayError(fmt::format("slom: {}\n", oneLine(failureText(streams, result))));
  throw CLI::RuntimeError(exit_not_converged);
}

void addOptions(CLI::App& command, RawOptions& raw) {
  command.add_option("HAND", raw.hand, "poses of the hand in the base")->required()->type_name("");
  command.add_option("CAMERA", raw.camera, "poses of the camera in the target")->required()->type_name("");
  command.add_option("--offset", raw.offset, "known time offset t_hand - t_camera [s]; it is not estimated")
      ->type_name("SECONDS");
  command.add_flag("--no-offset", raw.no_offset, "both files have one clock: --offset 0");
  command.add_flag("--scale", raw.scale,
                   "estimate the scale of the camera's translations too, as of a\nmonocular map");
  command.add_flag("--pairs", raw.pairs,
                   "row i of HAND belongs to row i of CAMERA; times do not count and may\nbe absent");
  command
      .add_option(
          "--motions", raw.motions,
          "compare motions over this time instead of poses (A X = X B), because\nbase or target drift, as "
          "in odometry")
      ->type_name("SECONDS");
  command.add_flag("--invert-hand", raw.invert_hand, "HAND has poses of the base in the hand");
  command.add_flag("--invert-camera", raw.invert_camera,
                   "CAMERA has poses of the target in the camera, as solvePnP gives them");
  command
      .add_option("--outlier-sigmas", raw.outlier_sigmas,
                  "leave out rows that are off by more than this many standard deviations")
      ->type_name("NUMBER")
      ->default_str("5");
  addReportOptions(command, raw.report);
}

}  // namespace
}  // namespace hand_eye

void addHandEyeCommand(CLI::App& app) {
  using namespace hand_eye;
  const auto raw = std::make_shared<RawOptions>();
  CLI::App& command = *app.add_subcommand("hand-eye", help_text);
  command.footer(exit_codes);
  addOptions(command, *raw);
  command.callback([raw] { run(*raw); });
}

}  // namespace slom::app
