// `slom calibrate`: options, then read -> calibrate -> report and files.
#include <cstdio>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "calibrate/calibrate.hpp"
#include "calibrate/fit/calibration.hpp"
#include "calibrate/html/page.hpp"
#include "calibrate/input/read.hpp"
#include "calibrate/output/json.hpp"
#include "calibrate/output/report.hpp"
#include "calibrate/output/yaml.hpp"
#include "calibrate/quality/assess.hpp"
#include "calibrate/settings.hpp"
#include "error.hpp"
#include "fitting/progress.hpp"
#include "output_files.hpp"

namespace slom::app {
namespace {

using namespace calib;

constexpr const char* help_text =
    R"(slom calibrate --camera left=left_corners.csv --camera right=right_corners.csv --imu imu.csv \
               --json result.json --output calibration.yaml

Calibrate cameras, and an IMU on the same rig, from the corners of a flat board.
Needs no initial guess. The first camera is the reference. With an IMU, the world's z axis must be vertical.

Corner files: image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px
IMU file:     image,ax_m_s2,ay_m_s2,az_m_s2,valid
One row for each corner or reading, below this header. Images with the same number were taken at the same
time; images and corners may be missing in some cameras.
)";

constexpr const char* footer_text =
    R"(Exit code: 0 success, 1 the fit did not converge or is not determined (the report says why),
2 wrong options or data.)";

Dataset readDataset(const Settings& settings) {
  Dataset data;
  for (const CameraFile& camera : settings.cameras)
    data.cameras.push_back(readCorners(camera.name, camera.file));
  if (!settings.imu_file.empty()) data.imu = readImu(settings.imu_file);
  return data;
}

Progress printedProgress() {
  const auto header_is_printed = std::make_shared<bool>(false);
  return {[](const AloneReport& alone) { fmt::print("{}", aloneText(alone)); },
          [header_is_printed](const IterationRecord& record) {
            if (!std::exchange(*header_is_printed, true)) fmt::print("\nall together\n{}", iterationHeader());
            fmt::print("{}", iterationText(record));
            std::fflush(stdout);
          }};
}

/// A result that failed goes to JSON, which says so, but not to YAML, whose readers would take it for good.
void writeFiles(const Dataset& data, const Result& result, const Settings& settings) {
  OutputFiles files;
  if (!settings.json_file.empty()) files.add(settings.json_file, toJson(result));
  const bool yaml = !settings.yaml_file.empty() && result.success();
  if (yaml) files.add(settings.yaml_file, toOpencvYaml(result));
  if (!settings.report_file.empty()) files.add(settings.report_file, toHtml(data, result));
  files.commit();
  if (settings.quiet || (settings.json_file.empty() && settings.yaml_file.empty() && settings.report_file.empty())) return;
  fmt::print("\n");
  if (!settings.json_file.empty()) fmt::print("written: {}\n", settings.json_file);
  if (yaml) fmt::print("written: {}\n", settings.yaml_file);
  if (!settings.report_file.empty()) fmt::print("written: {}\n", settings.report_file);
  if (!settings.yaml_file.empty() && !yaml)
    fmt::print("not written, because the fit failed: {}\n", settings.yaml_file);
}

void run(const RawOptions& raw) {
  const Settings settings = parseSettings(raw);
  const Dataset data = readDataset(settings);
  requireWritable({settings.json_file, settings.yaml_file, settings.report_file});
  if (!settings.quiet) fmt::print("{}", dataText(data, settings));
  Result result = calibrate(data, settings, settings.quiet ? Progress{} : printedProgress());
  if (!settings.json_file.empty() || !settings.report_file.empty()) result.quality = assess(data, settings, result);
  if (!settings.quiet) fmt::print("{}", reportText(result));
  writeFiles(data, result, settings);
  if (result.success()) return;
  fmt::print(stderr, "slom: the calibration failed: {}\n",
             result.converged ? "the data do not determine all parameters" : result.message);
  throw CLI::RuntimeError(exit_not_converged);
}

}  // namespace

void addCalibrateCommand(CLI::App& app) {
  const auto raw = std::make_shared<RawOptions>();
  Settings& settings = raw->rest;
  CLI::App& command = *app.add_subcommand("calibrate", help_text);
  command.footer(footer_text);
  command.add_option("--camera", raw->cameras, "a camera's name and corner file; once for each camera")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
  command.add_option("--imu", settings.imu_file, "accelerometer readings, one for an image at most")
      ->type_name("FILE");
  command
      .add_option("--intrinsics", raw->model,
                  "fx fy cx cy k1 k2 p1 p2 k3, the same without k3, or f cx cy k1")
      ->type_name("opencv5|opencv4|radial1")
      ->capture_default_str();
  command.add_option("--sigma-px", settings.sigma_px, "standard deviation of u and of v [px]")
      ->type_name("NUMBER")
      ->capture_default_str();
  command
      .add_option("--sigma-acc", settings.sigma_acc, "standard deviation of each axis of a reading [m/s^2]")
      ->type_name("NUMBER")
      ->capture_default_str();
  command
      .add_option("--fix", raw->fixed,
                  "hold a value instead of estimating it; may be repeated:\n"
                  "acc_bias (0,0,0) or acc_bias=X,Y,Z; gravity (9.80665) or gravity=MAGNITUDE [m/s^2];\n"
                  "a parameter of all cameras or one, k3 (0), left.k3 (0), cx=320")
      ->type_name("NAME[=VALUE]")
      ->allow_extra_args(false);
  command
      .add_option("--bound", raw->bounded, "keep a camera's parameter between two values, k3=-1,1 or left.fx=400,600; may be repeated")
      ->type_name("NAME=LOWER,UPPER")
      ->allow_extra_args(false);
  command.add_option("--max-iterations", settings.max_iterations, "of a fit")
      ->type_name("NUMBER")
      ->capture_default_str();
  command.add_option("--json", settings.json_file, "result with all digits, as JSON")->type_name("FILE");
  command.add_option("--output", settings.yaml_file, "calibration as YAML for OpenCV's FileStorage")
      ->type_name("FILE");
  command.add_option("--report", settings.report_file, "how far the calibration can be trusted, as a page for the browser")
      ->type_name("FILE");
  command.add_flag("--quiet", settings.quiet, "print errors only");
  command.callback([raw] { run(*raw); });
}

}  // namespace slom::app
