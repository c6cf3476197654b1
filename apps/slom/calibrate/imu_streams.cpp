#include "calibrate/imu_streams.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "calibrate/output/report.hpp"
#include "calibrate/sources.hpp"
#include "error.hpp"
#include "fitting/progress.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

std::string numbers(const vec3& v) { return fmt::format("{:.6f} {:.6f} {:.6f}", v[0], v[1], v[2]); }

/// Returns lines on the axes: deviations from an ideal IMU.
std::string axesLines(const ImuAxesResult& axes) {
  if (axes.estimated == ImuAxes::calibrated) return "";
  const ImuModel<>& model = axes.model;
  std::size_t next = 0;
  const auto lines = [&](const auto& values, const char* name, const std::vector<const char*>& components,
                         double unit, const char* unit_name) {
    std::string text;
    for (std::size_t i = 0; i < components.size(); ++i, ++next) {
      const auto std = [&](const std::vector<double>& all) {
        return next < all.size() ? unit * all[next] : unknown;
      };
      text += valueLine(fmt::format("{} {}", name, components[i]), unit * values[Eigen::Index(i)],
                        std(axes.std), std(axes.std_clustered), unit_name);
    }
    return text;
  };
  const std::vector<const char*> square{"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  std::string text = "  deviations of the axes from those of an ideal IMU:\n";
  text += lines(model.force_axes, "acc", {"xx", "yx", "yy", "zx", "zy", "zz"}, 100, "%");
  text += lines(model.gyro_axes, "gyro", square, 100, "%");
  text += lines(model.gyro_by_force, "gyro by acc", square, 1, "rad/s/(m/s^2)");
  if (axes.estimated == ImuAxes::scale_misalignment_size_effect)
    text += lines(model.force_places, "acc", {"y at x", "y at y", "y at z", "z at x", "z at y", "z at z"},
                  1000, "mm");
  return text;
}

/// Returns the lines on the clock and the shutter of a camera.
std::string timingLines(const CameraStreamResult& camera, const std::string& reference) {
  if (!camera.time_offset && !camera.line_delay) return "";
  std::string text =
      fmt::format("\ncamera {} in motion\n  {:<26} {:<13}{}\n", camera.name, "", "stated", "clustered");
  const auto line = [&](const char* name, const std::optional<StreamNumber>& number, double per_unit,
                        const std::string& unit) {
    if (number)
      text += valueLine(name, per_unit * number->value, per_unit * number->std,
                        per_unit * number->std_clustered, unit);
  };
  line("time offset", camera.time_offset, 1e3,
       fmt::format("ms, t_{} = t_{} + offset", camera.name, reference));
  line("line delay", camera.line_delay, 1e6, "us, from one row to the next");
  return text;
}

/// Returns a line on how far the halves of the recording differ.
std::string halvesLine(const ImuAgreement& halves) {
  const vec3 mm(1000 * halves.translation), deg(degrees * halves.rotation);
  const auto [deviations, name] = halves.largest();
  return fmt::format(
      "  halves of the recording differ by ({:.2f}, {:.2f}, {:.2f}) mm, ({:.3f}, {:.3f}, {:.3f}) deg and {:.4f} ms;\n"
      "  at most {} standard deviations, in {}\n",
      mm[0], mm[1], mm[2], deg[0], deg[1], deg[2], 1000 * halves.time_offset, twoDigits(deviations), name);
}

std::string imuLines(const ImuStreamResult& imu, const std::string& reference) {
  std::string text = fmt::format("\nimu {}: {} between {} pairs of successive images\n", imu.name,
                                 plural(imu.samples, "reading"), imu.intervals);
  text += fmt::format("  {:<26} {:<13}{}\n", "", "stated", "clustered");
  text += valueLine("time offset", 1000 * imu.time_offset, 1000 * imu.time_offset_std,
                    1000 * imu.time_offset_clustered,
                    fmt::format("ms, t_{} = t_{} + offset", imu.name, reference));
  text += fmt::format("  from {0} to {1}, p_{1} = R p_{0} + t:\n", reference, imu.name);
  text += vectorLines("translation", imu.left2imu.pos, imu.translation_std, imu.translation_clustered, "m");
  text += rotationLines(imu.left2imu.orient, imu.rotation_vector_std, imu.rotation_vector_clustered);
  text += vectorLines("gyro_bias", imu.gyro_bias, imu.gyro_bias_std, imu.gyro_bias_clustered, "rad/s");
  text += vectorLines("acc_bias", imu.force_bias, imu.force_bias_std, imu.force_bias_clustered, "m/s^2");
  text += axesLines(imu.axes);
  if (imu.halves) text += halvesLine(*imu.halves);
  text += fmt::format(
      "  motion (RMS)  turns {:.2f} {:.2f} {:.2f} rad/s, forces {:.2f} {:.2f} {:.2f} m/s^2 about and along x, y, z of {}\n",
      imu.excitation.turns[0], imu.excitation.turns[1], imu.excitation.turns[2], imu.excitation.forces[0],
      imu.excitation.forces[1], imu.excitation.forces[2], imu.name);
  return text +
         fmt::format(
             "  noise         gyro {:.3g} rad/s/sqrt(Hz), acc {:.3g} m/s^2/sqrt(Hz), {}; residuals {:.2f} and {:.2f} times that\n",
             imu.noise.gyro, imu.noise.force, imu.noise_is_given ? "as given" : "from the residuals",
             imu.gyro_ratio, imu.force_ratio);
}

/// Returns the settings of a fit that prints its iterations, unless quiet.
StreamSettings withProgress(const CommandSettings& settings) {
  StreamSettings stream = settings.stream;
  if (settings.quiet) return stream;
  const auto header_is_printed = std::make_shared<bool>(false);
  stream.progress = [header_is_printed](const IterationRecord& record) {
    if (!std::exchange(*header_is_printed, true)) say("\nIMUs by splines\n" + iterationHeader());
    say(iterationText(record));
    std::fflush(stdout);
  };
  return stream;
}

}  // namespace

std::vector<ImuFile> parseImuStreams(const std::vector<std::string>& streams,
                                     const std::vector<std::string>& noises,
                                     const std::vector<CameraFile>& cameras) {
  std::vector<ImuFile> imus;
  for (const std::string& text : streams) {
    const NamedFileText named =
        parseNamedFile("--imu-stream", text, "NAME=FILE, as in --imu-stream imu0=imu0.csv");
    const auto has_name = [&](const auto& one) { return one.name == named.name; };
    if (std::any_of(imus.begin(), imus.end(), has_name) ||
        std::any_of(cameras.begin(), cameras.end(), has_name))
      throw UserError(
          fmt::format("--imu-stream {}: the name {} is taken; give each sensor its own", text, named.name));
    imus.push_back({named.name, named.file, ""});
  }
  for (const std::string& text : noises) {
    const NamedFileText named =
        parseNamedFile("--imu-noise", text, "NAME=FILE, as in --imu-noise imu0=imu.yaml");
    const auto imu =
        std::find_if(imus.begin(), imus.end(), [&](const ImuFile& one) { return one.name == named.name; });
    if (imu == imus.end())
      throw UserError(
          fmt::format("--imu-noise {0}: there is no IMU {1}; add --imu-stream {1}=FILE, or correct the name",
                      text, named.name));
    if (!imu->noise_file.empty())
      throw UserError(
          fmt::format("--imu-noise {}: the noise of {} is given twice; keep one", text, named.name));
    imu->noise_file = named.file;
  }
  return imus;
}

std::vector<ImuStream> readImuStreams(const CommandSettings& settings) {
  std::vector<ImuStream> streams;
  for (const ImuFile& imu : settings.imu_streams) {
    streams.push_back(readImuStream(imu.name, imu.file));
    if (!imu.noise_file.empty()) streams.back().noise = readImuNoise(imu.noise_file);
  }
  return streams;
}

std::string streamLines(const StreamResult& result, const std::string& reference) {
  std::string text;
  for (const CameraStreamResult& camera : result.cameras) text += timingLines(camera, reference);
  for (const ImuStreamResult& imu : result.imus) text += imuLines(imu, reference);
  text += fmt::format(
      "\nnoise of a corner in the fit with the IMU: {} px, from the residuals; --sigma-px does not change it\n",
      twoDigits(result.sigma_px));
  text +=
      fmt::format("\ngravity in the frame of the board: {} m/s^2, direction {}\n", numbers(result.gravity),
                  std::isfinite(result.gravity_direction_std)
                      ? fmt::format("+- {} deg stated, {} deg clustered",
                                    twoDigits(result.gravity_direction_std * degrees),
                                    twoDigits(result.gravity_direction_clustered * degrees))
                      : "not determined");
  if (!result.notes.empty()) text += "\nnotes on the IMU\n";
  for (const std::string& note : result.notes) text += bulleted(note);
  return text;
}

FittedStreams fitStreams(const Dataset& data, const CommandSettings& settings, const Result& cameras,
                         const std::vector<ImuStream>& imus) {
  StreamSettings stream = withProgress(settings);
  FittedStreams fitted{calibrateStreams(data, settings, cameras, imus, stream)};
  if (!settings.compares_paths) return fitted;
  stream.path = StreamPath::splines;
  fitted.agreement = agreementOf(fitted.result, calibrateStreams(data, settings, cameras, imus, stream));
  return fitted;
}

StreamResult fitMovingCameras(Dataset& data, CommandSettings& settings, const std::vector<ImuStream>& imus) {
  MovingCameras moving = calibrateMovingCameras(data, settings, imus, withProgress(settings));
  settings.rolling_shutter = false;
  if (moving.result.converged) data = std::move(moving.simultaneous);
  return std::move(moving.result);
}

FittedStreams comparedStreams(StreamResult moving, const Dataset& data, const CommandSettings& settings,
                              const Result& cameras, const std::vector<ImuStream>& imus) {
  FittedStreams fitted{std::move(moving)};
  if (!settings.compares_paths || !fitted.success()) return fitted;
  StreamSettings stream = settings.stream;
  stream.path = StreamPath::preintegration;
  stream.camera_offsets = false;
  fitted.agreement = agreementOf(calibrateStreams(data, settings, cameras, imus, stream), fitted.result);
  return fitted;
}

std::string agreementLines(const StreamAgreement& agreement) {
  const auto difference = [](const std::string& name, double value, double std, const char* unit) {
    return fmt::format("  {:<14} {:>10.4f} {:<4} {:>6.2f} standard deviations\n", name, value, unit,
                       std::abs(value) / std);
  };
  std::string text;
  if (agreement.largest_name.empty() && !agreement.contradiction.empty())
    return "\nsplines minus preintegration\n" + bulleted(agreement.contradiction);
  for (const ImuAgreement& imu : agreement.imus) {
    text += fmt::format("\nimu {}: splines minus preintegration\n", imu.name);
    text += difference("time offset", 1000 * imu.time_offset, 1000 * imu.time_offset_std, "ms");
    for (int i = 0; i < 3; ++i)
      text += difference(std::string("translation.") + "xyz"[i], 1000 * imu.translation[i],
                         1000 * imu.translation_std[i], "mm");
    for (int i = 0; i < 3; ++i)
      text += difference(std::string("rotation.") + "xyz"[i], degrees * imu.rotation[i],
                         degrees * imu.rotation_std[i], "deg");
  }
  text += difference("gravity", degrees * agreement.gravity_angle, degrees * agreement.gravity_std, "deg");
  if (!agreement.contradiction.empty()) text += bulleted(agreement.contradiction);
  return text;
}

}  // namespace slom::app::calib
