#include "calibrate/output/formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/output/yaml.hpp"
#include "calibrate/result_paths.hpp"
#include "error.hpp"

namespace slom::app::calib {
std::vector<OutputText> outputTexts(const Result& result, const std::optional<StreamResult>& streams,
                                    const CommandSettings& settings) {
  switch (settings.format) {
    case OutputFormat::opencv:
      return {{settings.yaml_file, toOpencvYaml(result)}};
    case OutputFormat::kalibr:
      return {{settings.yaml_file, toKalibrYaml(result, streams ? &streams->imus.front() : nullptr)}};
    case OutputFormat::ros:
      break;
  }
  std::vector<OutputText> files;
  const std::vector<std::string> names = outputFiles(settings);
  for (std::size_t c = 0; c < names.size(); ++c) files.push_back({names[c], toRosYaml(result.cameras[c])});
  return files;
}

std::optional<ForeignLens> lensFor(OutputFormat format, const Model& model,
                                   const std::vector<double>& parameters) {
  switch (format) {
    case OutputFormat::opencv:
      return model.forOpencv(parameters);
    case OutputFormat::ros:
      return model.forRos(parameters);
    case OutputFormat::kalibr:
      return model.forKalibr(parameters);
  }
  return {};
}

ForeignLens lensFor(OutputFormat format, const CameraResult& camera) {
  std::vector<double> parameters;
  for (const Parameter& parameter : camera.parameters) parameters.push_back(parameter.value);
  return lensFor(format, Model(camera.model), parameters).value();
}

void requireModelOf(const CommandSettings& settings) {
  const auto is_known = [&](const Model& model) {
    return lensFor(settings.format, model, std::vector<double>(model.parameters().size())).has_value();
  };
  if (settings.yaml_file.empty() || is_known(settings.model)) return;
  if (settings.format == OutputFormat::kalibr) {
    throw UserError(fmt::format(
        "--output {}: Kalibr has no distortion model like {}; calibrate with --intrinsics opencv4 "
        "(its radtan) or "
        "fisheye (its equidistant)",
        settings.yaml_file, settings.model.name()));
  }
  std::vector<std::string> known;
  for (const Model& model : allModels()) {
    if (is_known(model)) known.push_back(model.name());
  }
  throw UserError(
      fmt::format("--output {}: {} has no lens like {}; calibrate with --intrinsics {}{}", settings.yaml_file,
                  settings.format == OutputFormat::ros ? "ROS" : "OpenCV", settings.model.name(),
                  fmt::join(known, " or "),
                  settings.model.forKalibr(std::vector<double>(settings.model.parameters().size()))
                      ? ", or write Kalibr's camchain by --format kalibr"
                      : ""));
}

void requireImageSizes(const CommandSettings& settings, const std::vector<CameraData>& cameras) {
  if (settings.yaml_file.empty() || settings.format == OutputFormat::opencv) return;
  for (const CameraData& camera : cameras) {
    if (camera.image_size) continue;
    throw UserError(fmt::format(
        "--output {}: {} needs the image size, which {} does not state; give it, as in --image-size "
        "{}=640x480",
        settings.yaml_file, settings.format == OutputFormat::kalibr ? "a camchain" : "camera_info",
        camera.file, camera.name));
  }
}

}  // namespace slom::app::calib
