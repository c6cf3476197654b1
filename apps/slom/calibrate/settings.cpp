#include "calibrate/settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/imu_streams.hpp"
#include "calibrate/known_lenses.hpp"
#include "calibrate/result_paths.hpp"
#include "calibrate/sources.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "output_files.hpp"
#include "plausible.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

constexpr double standard_gravity = 9.80665;  // m/s^2

/// Parses `count` numbers separated by commas.
std::vector<double> parseNumbers(const std::string& option, const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* end = text.data() + text.size();
  while (numbers.size() < count) {
    double number = 0;
    const auto [stop, error] = std::from_chars(at, end, number);
    if (error != std::errc() || !std::isfinite(number)) break;
    numbers.push_back(number);
    at = stop;
    if (at == end || *at != ',') break;
    ++at;
  }
  if (numbers.size() != count || at != end) {
    throw UserError(
        fmt::format("{}: the value must be {}", option,
                    count == 1 ? "a number" : fmt::format("{} numbers separated by commas", count)));
  }
  return numbers;
}

void fixBias(const std::string& option, const std::string* value, Fixed& fixed) {
  if (fixed.acc_bias) throw UserError(fmt::format("{}: acc_bias is already fixed; give it once", option));
  const std::vector<double> b = value ? parseNumbers(option, *value, 3) : std::vector<double>{0, 0, 0};
  for (const double number : b) {
    if (std::abs(number) <= most_m_s2) continue;
    throw UserError(fmt::format("{}: bias out of range; give values between {:g} and {:g} m/s^2", option,
                                -most_m_s2, most_m_s2));
  }
  fixed.acc_bias = vec3(b[0], b[1], b[2]);
}

void fixGravity(const std::string& option, const std::string* value, Fixed& fixed) {
  if (fixed.gravity) throw UserError(fmt::format("{}: gravity is already fixed; give it once", option));
  fixed.gravity = value ? parseNumbers(option, *value, 1)[0] : standard_gravity;
  if (!(*fixed.gravity > 0)) {
    throw UserError(
        fmt::format("{}: give the magnitude of gravity, a positive number in m/s^2; its sign is found from "
                    "the data",
                    option));
  }
  if (*fixed.gravity >= least_gravity && *fixed.gravity <= most_m_s2) return;
  throw UserError(fmt::format("{}: gravity out of range; give a magnitude between {:g} and {:g} m/s^2",
                              option, least_gravity, most_m_s2));
}

/// Fixes one quantity. `value` is nullptr if the option has none.
using Fixer = void (*)(const std::string& option, const std::string* value, Fixed&);
const std::map<std::string, Fixer> fixers{{"acc_bias", fixBias}, {"gravity", fixGravity}};

bool isFocalLength(const std::string& parameter) { return parameter[0] == 'f'; }
bool isCentre(const std::string& parameter) { return parameter[0] == 'c'; }

/// Returns focal lengths, the principal point, and the other parameters of the models, each once.
std::vector<std::string> namesOfParameters() {
  std::vector<std::string> names;
  for (const Model& model : allModels()) {
    for (const std::string& name : model.parameters()) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  const auto rank = [](const std::string& name) {
    return isFocalLength(name) ? std::pair(0, name) : std::pair(isCentre(name) ? 1 : 2, std::string());
  };
  std::stable_sort(names.begin(), names.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
  return names;
}
const std::vector<std::string>& lensParameters() {
  static const std::vector<std::string> names = namesOfParameters();
  return names;
}

/// Parses `k3` or `left.k3`; returns nothing if no camera has such a parameter.
std::optional<LensOption> parseLensName(const std::string& option, const std::string& name) {
  const auto dot = name.rfind('.');
  LensOption constraint;
  constraint.option = option;
  if (dot != std::string::npos) constraint.camera = name.substr(0, dot);
  constraint.parameter = dot == std::string::npos ? name : name.substr(dot + 1);
  const std::vector<std::string>& known = lensParameters();
  if (std::find(known.begin(), known.end(), constraint.parameter) == known.end()) return {};
  return constraint;
}

/// The limits of a parameter in any camera.
struct LensLimits {
  const char* what;
  double lower, upper;
  const char* unit;

  std::string text() const {
    return fmt::format("{} lies between {:g} and {:g}{}", what, lower, upper, unit);
  }
};

LensLimits limitsOf(const std::string& parameter) {
  if (isFocalLength(parameter)) return {"a focal length", least_focal_px, most_focal_px, " px"};
  if (isCentre(parameter)) return {"the principal point", -most_px, most_px, " px"};
  return {"a coefficient of distortion", -most_distortion, most_distortion, ""};
}

/// Fixes a parameter. Distortion is fixed at 0 if the option gives no value.
LensOption fixLens(LensOption constraint, const std::string* value) {
  if (value == nullptr && (isFocalLength(constraint.parameter) || isCentre(constraint.parameter))) {
    throw UserError(
        fmt::format("{0}: the value is missing; give it in px, as in {0}=320", constraint.option));
  }
  const double at = value ? parseNumbers(constraint.option, *value, 1)[0] : 0;
  const LensLimits limits = limitsOf(constraint.parameter);
  if (at < limits.lower || at > limits.upper)
    throw UserError(fmt::format("{}: {}; give such a value", constraint.option, limits.text()));
  constraint.lower = constraint.upper = at;
  return constraint;
}

std::vector<LensOption> parseBounds(const std::vector<std::string>& texts) {
  std::vector<LensOption> bounds;
  for (const std::string& text : texts) {
    const std::string option = "--bound " + text;
    const auto equals = text.find('=');
    auto constraint = parseLensName(option, text.substr(0, equals));
    if (!constraint || equals == std::string::npos) {
      throw UserError(fmt::format(
          "{}: write PARAMETER=LOWER,UPPER with a camera's parameter ({}), as in --bound k3=-1,1 or "
          "--bound left.fx=400,600",
          option, fmt::join(lensParameters(), ", ")));
    }
    const std::vector<double> limits = parseNumbers(option, text.substr(equals + 1), 2);
    if (!(limits[0] < limits[1]))
      throw UserError(fmt::format("{}: the lower limit must be below the upper one", option));
    const LensLimits possible = limitsOf(constraint->parameter);
    if (limits[1] < possible.lower || limits[0] > possible.upper)
      throw UserError(
          fmt::format("{}: {}, and these limits allow none of that; give others", option, possible.text()));
    constraint->lower = limits[0];
    constraint->upper = limits[1];
    bounds.push_back(*constraint);
  }
  return bounds;
}

/// Checks that each option names an existing parameter and camera, and that no two options name the same.
void checkLens(const CommandSettings& settings, const Model& model) {
  const std::vector<std::string>& parameters = model.parameters();
  for (std::size_t i = 0; i < settings.lens_options.size(); ++i) {
    const LensOption& one = settings.lens_options[i];
    if (std::find(parameters.begin(), parameters.end(), one.parameter) == parameters.end()) {
      throw UserError(fmt::format("{}: the model {} has no {}; its parameters are {}", one.option,
                                  model.name(), one.parameter, fmt::join(parameters, ", ")));
    }
    const auto is_named = [&](const CameraFile& camera) { return camera.name == one.camera; };
    if (!one.camera.empty() && std::none_of(settings.cameras.begin(), settings.cameras.end(), is_named)) {
      throw UserError(
          fmt::format("{}: there is no camera {}; give it by --camera, or leave the name out for all cameras",
                      one.option, one.camera));
    }
    for (std::size_t j = 0; j < i; ++j) {
      const LensOption& other = settings.lens_options[j];
      if (other.parameter != one.parameter ||
          (!other.camera.empty() && !one.camera.empty() && other.camera != one.camera))
        continue;
      throw UserError(
          fmt::format("{}: constrains the same parameter as {}; keep one of them", one.option, other.option));
    }
  }
}

Fixed parseFixed(const std::vector<std::string>& texts, std::vector<LensOption>& lens) {
  Fixed fixed;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    const std::string name = text.substr(0, equals), option = "--fix " + text;
    const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
    const std::string* const given = equals == std::string::npos ? nullptr : &value;
    if (const auto constraint = parseLensName(option, name)) {
      lens.push_back(fixLens(*constraint, given));
      continue;
    }
    const auto fixer = fixers.find(name);
    if (fixer == fixers.end()) {
      std::vector<std::string> names;
      for (const auto& [known, unused] : fixers) names.push_back(known);
      throw UserError(fmt::format("{}: unknown parameter \"{}\"; fix {} or a camera parameter: {}", option,
                                  name, fmt::join(names, ", "), fmt::join(lensParameters(), ", ")));
    }
    fixer->second(option, given, fixed);
  }
  return fixed;
}

/// Parses `17`, `17:5` or `left.17:5`.
std::vector<Exclusion> parseExclusions(const std::vector<std::string>& texts,
                                       const std::vector<CameraFile>& cameras) {
  std::vector<Exclusion> exclusions;
  for (const std::string& text : texts) {
    const auto dot = text.rfind('.'), colon = text.find(':', dot == std::string::npos ? 0 : dot);
    const std::size_t first = dot == std::string::npos ? 0 : dot + 1;
    Exclusion one;
    if (dot != std::string::npos) one.camera = text.substr(0, dot);
    const std::string_view all(text), image = all.substr(first, std::min(colon, text.size()) - first);
    const bool has_corner = colon != std::string::npos;
    int corner = 0;
    if (!parseNumber(image, one.image) || (has_corner && !parseNumber(all.substr(colon + 1), corner))) {
      throw UserError(fmt::format(
          "--exclude {}: write IMAGE, IMAGE:CORNER or CAMERA.IMAGE:CORNER, as in --exclude 17 or --exclude {}.17:5",
          text, cameras.front().name));
    }
    if (has_corner) one.corner = corner;
    exclusions.push_back(one);
  }
  return exclusions;
}

Robust parseRobust(const std::string& text) {
  if (text == "none") return Robust::none;
  if (text == "reject") return Robust::reject;
  if (text == "huber") return Robust::huber;
  if (text == "cauchy") return Robust::cauchy;
  throw UserError(fmt::format(
      "--robust {}: unknown treatment of gross corners; give none, reject, huber or cauchy", text));
}

/// Parses what the noise grows with. --compare tries all if it is not given.
void parseSigmaBy(const RawOptions& raw, CommandSettings& settings) {
  settings.is_compared = raw.compare;
  settings.sigma_by_is_given = !raw.sigma_by.empty() || !raw.compare;
  if (raw.sigma_by.empty()) return;
  for (const SigmaBy by : {SigmaBy::constant, SigmaBy::speed, SigmaBy::slant, SigmaBy::distance}) {
    settings.sigma_by = by;
    if (raw.sigma_by == toString(by)) return;
  }
  throw UserError(
      fmt::format("--sigma-by {}: unknown quantity; give constant, speed, slant or distance", raw.sigma_by));
}

/// Parses the shape of the board. --compare tries all if it is not given.
void parseBoardShape(const RawOptions& raw, CommandSettings& settings) {
  settings.board_shape_is_given = !raw.board_shape.empty() || !raw.compare;
  if (raw.board_shape == "bent") {
    settings.board_shape = BoardShape::bent;
  } else if (raw.board_shape == "free") {
    settings.board_shape = BoardShape::free;
  } else if (!raw.board_shape.empty() && raw.board_shape != "flat") {
    throw UserError(fmt::format("--board-shape {}: unknown shape; give flat, bent or free", raw.board_shape));
  }
  if (!raw.sigma_board) return;
  const double sigma = *raw.sigma_board;
  if (!(sigma > 0 && std::isfinite(sigma)))
    throw UserError(fmt::format("--sigma-board {}: a standard deviation must be positive", sigma));
  if (sigma < least_sigma_board || sigma > most_sigma) {
    throw UserError(fmt::format("--sigma-board {}: standard deviation out of range; give {:g} to {:g} m",
                                sigma, least_sigma_board, most_sigma));
  }
  if (settings.board_shape != BoardShape::free) {
    throw UserError(
        fmt::format("--sigma-board {}: applies only to a free board; add --board-shape free", sigma));
  }
  settings.sigma_board = sigma;
}

Model parseModel(const std::string& option, const std::string& name) {
  try {
    return Model(name);
  } catch (const DataError& error) {
    throw UserError(fmt::format("{} {}", option, error.sentence()));
  }
}

void parseModels(const RawOptions& raw, CommandSettings& settings) {
  settings.model_is_given = !raw.model.empty() || !raw.compare;
  if (!raw.model.empty()) settings.model = parseModel("--intrinsics", raw.model);
  for (const std::string& name : raw.compared) {
    if (!name.empty()) settings.compared.push_back(parseModel("--compare", name));
  }
  if (raw.compare && settings.compared.empty()) settings.compared = comparedModels();
  if (!settings.model_is_given) settings.model = settings.compared.front();
}

void requireSigma(const char* option, double value, const char* unit) {
  if (!(value > 0 && std::isfinite(value)))
    throw UserError(fmt::format("{} {}: a standard deviation must be positive", option, value));
  if (value >= least_sigma && value <= most_sigma) return;
  throw UserError(fmt::format("{} {}: standard deviation out of range; give {:g} to {:g} {}", option, value,
                              least_sigma, most_sigma, unit));
}

/// Refuses a name before the file, as --imu-stream takes it.
void refuseNamedImu(const std::string& text) {
  const std::size_t end_of_name = text.find('=');
  if (end_of_name == std::string::npos || std::filesystem::exists(text)) return;
  throw UserError(fmt::format(
      "--imu {0}: takes a file without a name; for an IMU in motion, give --imu-stream {0}, and for readings at rest "
      "--imu {1}",
      text, text.substr(end_of_name + 1)));
}

void checkPaths(const CommandSettings& settings) {
  std::vector<NamedFile> inputs;
  for (const CameraFile& camera : settings.cameras) {
    for (const std::string& file : camera.files) inputs.push_back({"--camera " + camera.name, file});
  }
  inputs.push_back({"--imu", settings.imu_file});
  for (const ImuFile& imu : settings.imu_streams) {
    inputs.push_back({"--imu-stream " + imu.name, imu.file});
    if (!imu.noise_file.empty()) inputs.push_back({"--imu-noise " + imu.name, imu.noise_file});
  }
  checkResultPaths(inputs, resultFiles(settings));
}

}  // namespace

namespace {

bool parseImuReads(const std::string& text, const CommandSettings& settings) {
  if (text.empty()) return false;
  if (text != "gravity" && text != "reaction")
    throw UserError(fmt::format("--imu-reads {}: unknown reading at rest; give gravity or reaction", text));
  if (settings.imu_file.empty())
    throw UserError(fmt::format(
        "--imu-reads {}: {}", text,
        settings.imu_streams.empty()
            ? "there is no IMU; add --imu FILE or drop this option"
            : "the option is for --imu; drop it, and if the accelerometer of an --imu-stream reports gravity itself at "
              "rest, change the sign of its three columns"));
  return text == "gravity";
}

ImuAxes parseImuModel(const std::string& text, const CommandSettings& settings) {
  if (text.empty()) return ImuAxes::calibrated;
  if (settings.imu_streams.empty())
    throw UserError(fmt::format(
        "--imu-model {}: there is no IMU in motion; add --imu-stream NAME=FILE or drop this option", text));
  for (const ImuAxes axes :
       {ImuAxes::calibrated, ImuAxes::scale_misalignment, ImuAxes::scale_misalignment_size_effect}) {
    if (text == toString(axes)) return axes;
  }
  throw UserError(fmt::format(
      "--imu-model {}: the models are calibrated, scale-misalignment and scale-misalignment-size-effect",
      text));
}

/// Sets whether clocks and shutters of the cameras are estimated with the motion.
void parseMovingCameras(const std::string& motion, CommandSettings& settings) {
  const bool has_offsets = settings.stream.camera_offsets;
  if (has_offsets && settings.imu_streams.empty())
    throw UserError(
        "--camera-offsets: there is no IMU in motion; add --imu-stream NAME=FILE or drop this option");
  if (has_offsets && settings.cameras.size() < 2)
    throw UserError("--camera-offsets: there is one camera only; add another one or drop this option");
  settings.cameras_move = !settings.imu_streams.empty() && (has_offsets || settings.rolling_shutter);
  if (!settings.cameras_move) return;
  const char* const option = has_offsets ? "--camera-offsets" : "--rolling-shutter";
  if (motion == "preintegration")
    throw UserError(
        fmt::format("{}: with an --imu-stream, needs splines; drop --imu-motion preintegration", option));
}

/// Sets how IMUs in motion are fitted.
void parseImuMotion(const RawOptions& raw, CommandSettings& settings) {
  const std::string& motion = raw.imu_motion;
  if (!motion.empty() && motion != "preintegration" && motion != "splines" && motion != "both")
    throw UserError(
        fmt::format("--imu-motion {}: unknown motion; give preintegration, splines or both", motion));
  if (!motion.empty() && settings.imu_streams.empty())
    throw UserError(fmt::format(
        "--imu-motion {}: there is no IMU in motion; add --imu-stream NAME=FILE or drop this option",
        motion));
  parseMovingCameras(motion, settings);
  settings.compares_paths = motion == "both";
  if (motion == "splines" || (motion.empty() && settings.cameras_move))
    settings.stream.path = StreamPath::splines;
  if (!raw.knot_spacing) return;
  constexpr double least = 0.001, most = 10;
  const double spacing = *raw.knot_spacing;
  if (motion != "both" && settings.stream.path != StreamPath::splines)
    throw UserError(fmt::format(
        "--knot-spacing {}: needs splines; add --imu-motion splines or both, or drop this option", spacing));
  if (!(spacing >= least && spacing <= most))
    throw UserError(
        fmt::format("--knot-spacing {}: spacing out of range; give {:g} to {:g} s", spacing, least, most));
  settings.stream.knot_spacing = spacing;
}

/// Refuses values of an IMU that is not there. With streams, a fixed gravity is theirs.
void checkFixedOfImu(CommandSettings& settings) {
  Fixed& fixed = settings.fixed;
  if (!settings.imu_streams.empty() && fixed.gravity) settings.stream.gravity = *fixed.gravity;
  if (!settings.imu_file.empty()) return;
  if (!settings.imu_streams.empty()) fixed.gravity.reset();
  if (fixed.acc_bias || fixed.gravity) {
    throw UserError(fmt::format("--fix {}: there is no IMU; add --imu FILE or drop --fix",
                                fixed.acc_bias ? "acc_bias" : "gravity"));
  }
}

}  // namespace

CommandSettings parseSettings(const RawOptions& raw) {
  CommandSettings settings = raw.rest;
  if (settings.jsonToStdout()) settings.quiet = true;  // nothing but the JSON is on standard output
  if (raw.imu_files.size() > 1) {
    throw UserError(fmt::format(
        "--imu {}: takes only one file; put the readings of all parts of the recording into one file, "
        "with the numbers of their images",
        raw.imu_files.back()));
  }
  if (!raw.imu_files.empty()) {
    settings.imu_file = raw.imu_files.front();
    refuseNamedImu(settings.imu_file);
  }
  parseSources(raw, settings);
  settings.imu_streams = parseImuStreams(raw.imu_streams, raw.imu_noises, settings.cameras);
  settings.robust = parseRobust(raw.robust);
  settings.imu_reads_gravity = parseImuReads(raw.imu_reads, settings);
  settings.stream.axes = parseImuModel(raw.imu_model, settings);
  parseImuMotion(raw, settings);
  parseSigmaBy(raw, settings);
  parseBoardShape(raw, settings);
  settings.exclusions = parseExclusions(raw.excluded, settings.cameras);
  settings.fixed = parseFixed(raw.fixed, settings.lens_options);
  for (const LensOption& bound : parseBounds(raw.bounded)) settings.lens_options.push_back(bound);
  if (!raw.lenses.empty() && raw.compare)
    throw UserError("--compare: the lenses are known by --lenses; drop one of the two");
  parseModels(raw, settings);
  settings.image_sizes = parseImageSizes(raw.image_sizes, settings.cameras);
  holdLenses(raw.lenses, raw.model, settings);
  settings.lens.assign(settings.lens_options.begin(), settings.lens_options.end());
  checkLens(settings, settings.model);
  for (const Model& model : settings.compared) checkLens(settings, model);
  requireSigma("--sigma-px", settings.sigma_px, "px");
  requireSigma("--sigma-acc", settings.sigma_acc, "m/s^2");
  if (settings.max_iterations < 1) {
    throw UserError(fmt::format("--max-iterations {}: give a number from 1 on", settings.max_iterations));
  }
  requireTimeLimit(settings.limits.max_seconds);
  checkFixedOfImu(settings);
  settings.format = parseFormat(raw.format, settings.yaml_file, settings.cameras.size());
  checkPaths(settings);
  return settings;
}

}  // namespace slom::app::calib
