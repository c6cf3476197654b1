#include "calibrate/result_paths.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "error.hpp"

namespace slom::app::calib {
namespace {

constexpr std::string_view placeholder = "{name}";

constexpr std::string_view openvins_cameras = "imucam_chain", openvins_imu = "imu_chain";

/// Returns the file of the IMU beside OpenVINS' file of the cameras.
std::string imuFileOf(const std::string& output) {
  const std::filesystem::path path(output);
  std::string name = path.filename().string();
  const auto at = name.find(openvins_cameras);
  if (at != std::string::npos)
    name.replace(at, openvins_cameras.size(), openvins_imu);
  else
    name = path.stem().string() + "_imu" + path.extension().string();
  return (path.parent_path() / name).string();
}

std::string fileOf(const std::string& output, const std::string& camera) {
  const auto at = output.find(placeholder);
  return at == std::string::npos ? output : std::string(output).replace(at, placeholder.size(), camera);
}

}  // namespace

OutputFormat parseFormat(const std::string& format, const std::string& file, std::size_t cameras) {
  const bool has_placeholder = file.find(placeholder) != std::string::npos;
  const bool is_camchain =
      std::filesystem::path(file).filename().string().find("camchain") != std::string::npos;
  const bool is_openvins =
      std::filesystem::path(file).filename().string().find(openvins_cameras) != std::string::npos;
  if (!format.empty() && file.empty())
    throw UserError(
        fmt::format("--format {}: no output file is given; add --output FILE or drop --format", format));
  if (format == "basalt") return OutputFormat::basalt;
  if (format == "openvins" || (format.empty() && is_openvins)) return OutputFormat::openvins;
  if (format == "opencv" || (format.empty() && !has_placeholder && !is_camchain)) return OutputFormat::opencv;
  if (format == "kalibr" || (format.empty() && is_camchain)) return OutputFormat::kalibr;
  if (format != "ros" && !format.empty())
    throw UserError(
        fmt::format("--format {}: the formats are opencv, ros, kalibr, openvins and basalt", format));
  if (cameras > 1 && !has_placeholder) {
    throw UserError(
        fmt::format("--output {}: ROS needs one file for each camera; write {{name}} in place of the "
                    "camera's name, as in --output '{{name}}.yaml'",
                    file));
  }
  return OutputFormat::ros;
}

std::vector<std::string> outputFiles(const CommandSettings& settings) {
  if (settings.yaml_file.empty()) return {};
  if (settings.format == OutputFormat::openvins) return {settings.yaml_file, imuFileOf(settings.yaml_file)};
  if (settings.format != OutputFormat::ros) return {settings.yaml_file};
  std::vector<std::string> files;
  for (const CameraFile& camera : settings.cameras) files.push_back(fileOf(settings.yaml_file, camera.name));
  return files;
}

std::vector<std::string> cornerFiles(const CommandSettings& settings) {
  if (settings.corners_folder.empty()) return {};
  std::vector<std::string> files;
  for (const CameraFile& camera : settings.cameras)
    files.push_back(std::filesystem::path(settings.corners_folder) / (camera.name + "_corners.csv"));
  return files;
}

std::vector<NamedFile> resultFiles(const CommandSettings& settings) {
  std::vector<NamedFile> files{{"--json", settings.jsonPath()}, {"--report", settings.report_file}};
  for (const std::string& file : outputFiles(settings)) files.push_back({"--output", file});
  for (const std::string& file : cornerFiles(settings)) files.push_back({"--corners-out", file});
  return files;
}

}  // namespace slom::app::calib
