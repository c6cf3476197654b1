#include "calibrate/output/formats.hpp"

#include <fmt/format.h>

#include "calibrate/output/yaml.hpp"
#include "calibrate/result_paths.hpp"
#include "error.hpp"

namespace slom::app::calib {
std::vector<OutputText> outputTexts(const Result& result, const Settings& settings) {
  switch (settings.format) {
    case OutputFormat::opencv:
      return {{settings.yaml_file, toOpencvYaml(result)}};
    case OutputFormat::kalibr:
      return {{settings.yaml_file, toKalibrYaml(result)}};
    case OutputFormat::ros:
      break;
  }
  std::vector<OutputText> files;
  const std::vector<std::string> names = outputFiles(settings);
  for (std::size_t c = 0; c < names.size(); ++c) files.push_back({names[c], toRosYaml(result.cameras[c])});
  return files;
}

void requireModelOf(const Settings& settings) {
  const bool is_unknown = settings.model == Model::opencv5 || settings.model == Model::opencv8;
  if (settings.yaml_file.empty() || settings.format != OutputFormat::kalibr || !is_unknown) return;
  throw UserError(
      fmt::format("--output {}: Kalibr has no distortion model like {}; calibrate with --intrinsics opencv4 "
                  "(its radtan) or "
                  "fisheye (its equidistant)",
                  settings.yaml_file, toString(settings.model)));
}

void requireImageSizes(const Settings& settings, const std::vector<CameraData>& cameras) {
  if (settings.yaml_file.empty() || settings.format == OutputFormat::opencv) return;
  for (const CameraData& camera : cameras) {
    if (camera.image_size) continue;
    throw UserError(fmt::format(
        "--output {}: {} stores the size of the images, which {} does not say; give it as in --image-size "
        "{}=640x480",
        settings.yaml_file, settings.format == OutputFormat::kalibr ? "a camchain" : "camera_info",
        camera.file, camera.name));
  }
}

}  // namespace slom::app::calib
