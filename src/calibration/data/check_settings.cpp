#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration/data/check.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Numbers that a setting may have. Others are mistakes, or have squares that are not finite.
struct Range {
  double least, most;
  const char* unit;

  bool holds(double value) const { return least <= value && value <= most; }
  std::string text() const { return fmt::format("from {:g} to {:g}{}", least, most, unit); }
};

constexpr Range pixel_sigmas{1e-6, 1e6, " px"}, reading_sigmas{1e-6, 1e6, " m/s^2"},
    prior_sigmas{1e-6, 1e6, ""}, board_sigmas{1e-9, most_corner_m, " m"},
    gravities{1e-3, most_reading_m_s2, " m/s^2"}, biases{-most_reading_m_s2, most_reading_m_s2, " m/s^2"};

[[noreturn]] void refuseSetting(const std::string& sentence, const std::string& subject) {
  throw DataError("slom.calibration.bad-settings", sentence, subject);
}

void requireWithin(const char* setting, double value, const Range& range) {
  if (range.holds(value)) return;
  refuseSetting(
      fmt::format("Settings::{} is {}; give {}", setting, value,
                  value > 0 && std::isfinite(value) ? "a number " + range.text() : "a positive number"),
      setting);
}

/// Returns the possible values of a lens parameter, by the first letter of its name: focal length (f), principal
/// point (c), or another.
Range rangeOf(const std::string& parameter) {
  if (parameter.starts_with('f')) return {1e-3, 1e9, " px"};
  if (parameter.starts_with('c')) return {-1e6, 1e6, " px"};
  return {-1e6, 1e6, ""};
}

/// Throws if the values that a constraint allows contain none that a lens may have.
void requirePossible(const LensConstraint& constraint) {
  const auto& [camera, parameter, lower, upper] = constraint;
  const Range range = rangeOf(parameter);
  if (lower <= range.most && upper >= range.least) return;
  const std::string where = constraint.isFixed() ? fmt::format("fixed at {}", lower)
                                                 : fmt::format("to lie between {} and {}", lower, upper);
  refuseSetting(fmt::format("{} is {}; give {} {}", parameter, where,
                            constraint.isFixed() ? "a value" : "limits that allow values", range.text()),
                parameter);
}

/// Throws if a parameter of a camera is constrained twice.
void requireConstraintsOnce(const std::vector<LensConstraint>& constraints) {
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const LensConstraint &one = constraints[i], &other = constraints[j];
      if (one.parameter != other.parameter) continue;
      if (!one.concerns(other.camera) && !other.concerns(one.camera)) continue;
      const std::string& camera = one.camera.empty() ? other.camera : one.camera;
      throw DataError(
          "slom.calibration.bad-settings",
          fmt::format("{} of {} is constrained twice, by lens[{}] and lens[{}]; keep one of the two",
                      one.parameter, camera.empty() ? "all cameras" : "camera " + camera, j, i),
          one.parameter);
    }
  }
}

void requireNumbers(const Settings& settings) {
  requireWithin("sigma_px", settings.sigma_px, pixel_sigmas);
  requireWithin("sigma_acc", settings.sigma_acc, reading_sigmas);
  if (settings.sigma_denominator)
    requireWithin("sigma_denominator", *settings.sigma_denominator, prior_sigmas);
  if (settings.sigma_board) requireWithin("sigma_board", *settings.sigma_board, board_sigmas);
  if (settings.fixed.gravity) requireWithin("fixed.gravity", *settings.fixed.gravity, gravities);
  if (settings.fixed.acc_bias) {
    const vec3& bias = *settings.fixed.acc_bias;
    if (!std::all_of(bias.begin(), bias.end(), [](double x) { return biases.holds(x); })) {
      refuseSetting(fmt::format("Settings::fixed.acc_bias is ({:.6g}, {:.6g}, {:.6g}); give numbers {}",
                                bias.x(), bias.y(), bias.z(), biases.text()),
                    "fixed.acc_bias");
    }
  }
  if (settings.max_iterations < 1) {
    refuseSetting(
        fmt::format("Settings::max_iterations is {}; give a number from 1 on", settings.max_iterations),
        "max_iterations");
  }
  if (!(settings.limits.max_seconds >= 0)) {
    refuseSetting(fmt::format("Settings::limits.max_seconds is {}; give a number from 0 on",
                              settings.limits.max_seconds),
                  "limits.max_seconds");
  }
}

/// Throws if a constraint names a parameter or camera that does not exist, or allows no possible value.
void requireSense(const LensConstraint& constraint, const Model& model, const Dataset& data) {
  const auto& [camera, parameter, lower, upper] = constraint;
  const std::vector<std::string>& parameters = model.parameters();
  if (std::find(parameters.begin(), parameters.end(), parameter) == parameters.end()) {
    refuseSetting(fmt::format("the model {} has no parameter {} to constrain; its parameters are {}",
                              model.name(), parameter, fmt::join(parameters, ", ")),
                  parameter);
  }
  const auto concerns = [&](const CameraData& one) { return constraint.concerns(one.name); };
  if (std::none_of(data.cameras.begin(), data.cameras.end(), concerns)) {
    refuseSetting(
        fmt::format("there is no camera {} whose {} can be constrained; correct the name", camera, parameter),
        camera);
  }
  if (std::isnan(lower) || std::isnan(upper)) {
    refuseSetting(fmt::format("{} is to lie between {} and {}; give numbers", parameter, lower, upper),
                  parameter);
  }
  if (!(lower <= upper)) {
    refuseSetting(
        fmt::format("{} cannot lie between {} and {}; give the lower limit first", parameter, lower, upper),
        parameter);
  }
  requirePossible(constraint);
}

}  // namespace

void checkSettings(const Dataset& data, const Settings& settings) {
  requireNumbers(settings);
  if (data.cameras.empty()) refuseSetting("the data set has no camera; add one", "cameras");
  for (const LensConstraint& constraint : settings.lens) requireSense(constraint, settings.model, data);
  requireConstraintsOnce(settings.lens);
}

}  // namespace slom::calibration
