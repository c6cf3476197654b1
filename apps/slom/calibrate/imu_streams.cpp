#include "calibrate/imu_streams.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "calibrate/output/report.hpp"
#include "calibrate/sources.hpp"
#include "error.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

std::string numbers(const vec3& v) { return fmt::format("{:.6f} {:.6f} {:.6f}", v[0], v[1], v[2]); }

std::string imuLines(const ImuStreamResult& imu, const std::string& reference) {
  std::string text = fmt::format("\nimu {}: {} between {} pairs of images\n", imu.name,
                                 plural(imu.samples, "reading"), imu.intervals);
  text += fmt::format("  {:<26} {:<13}{}\n", "", "stated", "clustered");
  text += valueLine("time offset", 1000 * imu.time_offset, 1000 * imu.time_offset_std,
                    1000 * imu.time_offset_clustered,
                    fmt::format("ms, t_{} = t_{} + offset", imu.name, reference));
  text += fmt::format("  from {0} to {1}, p_{1} = R p_{0} + t:\n", reference, imu.name);
  text += vectorLines("translation", imu.left2imu.pos, imu.translation_std, imu.translation_clustered, "m");
  text += rotationLines(imu.left2imu.orient, imu.rotation_vector_std, imu.rotation_vector_clustered);
  text += fmt::format("  gyro bias     {} rad/s\n  acc bias      {} m/s^2\n", numbers(imu.gyro_bias),
                      numbers(imu.force_bias));
  return text +
         fmt::format(
             "  noise         gyro {:.3g} rad/s/sqrt(Hz), acc {:.3g} m/s^2/sqrt(Hz), {}; residuals {:.2f} and {:.2f} times that\n",
             imu.noise.gyro, imu.noise.force, imu.noise_is_given ? "as given" : "from the residuals",
             imu.gyro_ratio, imu.force_ratio);
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
  for (const ImuStreamResult& imu : result.imus) text += imuLines(imu, reference);
  text += fmt::format("\ngravity in the frame of the board: {} m/s^2, direction +- {} deg\n",
                      numbers(result.gravity), twoDigits(result.gravity_direction_std * degrees));
  for (const std::string& note : result.notes) text += bulleted(note);
  return text;
}

}  // namespace slom::app::calib
