#include "calibrate/output/formats.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/output/yaml.hpp"
#include "calibrate/result_paths.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

/// Returns the lens with Basalt's name of the model and its numbers in Basalt's order.
std::optional<ForeignLens> lensForBasalt(const Model& model, const std::vector<double>& parameters) {
  if (model.name() == "fisheye") {
    ForeignLens lens = model.forKalibr(parameters).value();
    lens.intrinsics.insert(lens.intrinsics.end(), lens.distortion.begin(), lens.distortion.end());
    return ForeignLens{"kb4", "", lens.intrinsics};
  }
  if (model.name() == "double_sphere") {
    const std::vector<double> xi_first = model.forKalibr(parameters).value().intrinsics;
    std::vector<double> numbers(xi_first.begin() + 2, xi_first.end());
    numbers.insert(numbers.end(), xi_first.begin(), xi_first.begin() + 2);
    return ForeignLens{"ds", "", numbers};
  }
  std::optional<ForeignLens> lens = model.forOpencv(parameters);
  if (!lens) return {};
  constexpr std::size_t rational = 8;  // k1 k2 p1 p2 k3 k4 k5 k6
  lens->distortion.resize(rational, 0);
  lens->intrinsics.insert(lens->intrinsics.end(), lens->distortion.begin(), lens->distortion.end());
  return ForeignLens{"pinhole-radtan8", "", lens->intrinsics};
}

const char* nameOf(OutputFormat format) {
  switch (format) {
    case OutputFormat::ros:
      return "ROS";
    case OutputFormat::openvins:
      return "OpenVINS";
    case OutputFormat::basalt:
      return "Basalt";
    default:
      return "OpenCV";
  }
}

}  // namespace

std::string lostTimes(OutputFormat format, const StreamResult& streams) {
  const bool has_offsets = format == OutputFormat::kalibr || format == OutputFormat::openvins;
  std::vector<std::string> lost;
  for (const CameraStreamResult& camera : streams.cameras) {
    if (camera.time_offset && !has_offsets)
      lost.push_back(
          fmt::format("the time offset of {}, {:.4f} ms", camera.name, 1e3 * camera.time_offset->value));
    if (camera.line_delay)
      lost.push_back(
          fmt::format("the line delay of {}, {:.3f} us", camera.name, 1e6 * camera.line_delay->value));
  }
  if (lost.empty()) return "";
  return fmt::format("  this format has no place for {}\n", fmt::join(lost, ", "));
}

std::vector<OutputText> outputTexts(const Result& result, const StreamResult* streams,
                                    const CommandSettings& settings) {
  switch (settings.format) {
    case OutputFormat::opencv:
      return {{settings.yaml_file, toOpencvYaml(result)}};
    case OutputFormat::kalibr:
      return {{settings.yaml_file, toKalibrYaml(result, streams)}};
    case OutputFormat::openvins: {
      const std::vector<std::string> names = outputFiles(settings);
      return {{names[0], toOpenvinsCameras(result, *streams)},
              {names[1], toOpenvinsImu(streams->imus.front())}};
    }
    case OutputFormat::basalt:
      return {{settings.yaml_file, toBasaltJson(result, streams->imus.front())}};
    case OutputFormat::ros:
      break;
  }
  std::vector<OutputText> files;
  const std::vector<std::string> names = outputFiles(settings);
  for (std::size_t c = 0; c < names.size(); ++c) files.push_back({names[c], toRosYaml(result.cameras[c])});
  return files;
}

double offsetOf(const StreamResult& streams, std::size_t camera) {
  const double offset = streams.imus.front().time_offset;
  if (camera >= streams.cameras.size()) return offset;
  return offset - streams.cameras[camera].time_offset.value_or(StreamNumber()).value;
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
    case OutputFormat::openvins: {
      std::optional<ForeignLens> lens = model.forKalibr(parameters);
      if (lens && lens->camera_model != "pinhole") lens.reset();
      return lens;
    }
    case OutputFormat::basalt:
      return lensForBasalt(model, parameters);
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
  const bool needs_imu = settings.format == OutputFormat::openvins || settings.format == OutputFormat::basalt;
  if (!settings.yaml_file.empty() && needs_imu && settings.imu_streams.empty())
    throw UserError(fmt::format("--output {}: {} needs the pose of an IMU; add --imu-stream NAME=FILE",
                                settings.yaml_file, nameOf(settings.format)));
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
                  nameOf(settings.format), settings.model.name(), fmt::join(known, " or "),
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
        settings.yaml_file,
        settings.format == OutputFormat::kalibr ? "a camchain"
        : settings.format == OutputFormat::ros  ? "camera_info"
                                                : nameOf(settings.format),
        camera.file, camera.name));
  }
}

}  // namespace slom::app::calib
