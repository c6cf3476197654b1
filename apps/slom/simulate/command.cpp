#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "error.hpp"
#include "printable.hpp"
#include "simulate/simulate.hpp"
#include "simulate/stereo_imu.hpp"
#include "simulate/stereo_imu_files.hpp"
#include "simulate/stereo_imu_stream.hpp"
#include "simulate/stereo_imu_stream_files.hpp"

namespace slom::app {

namespace {

/// Adds a numeric option. `accepts` returns whether a number is allowed; `remedy` describes the allowed numbers.
template <class Number>
void addNumber(CLI::App& command, const std::string& name, Number& value, const std::string& help,
               bool (*accepts)(Number), const std::string& remedy) {
  const auto read = [name, &value, accepts, remedy](const std::string& text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !accepts(number)) {
      throw UserError(fmt::format("{} is {}; give {}", name, text, remedy));
    }
    value = number;
  };
  command.add_option_function<std::string>(name, read, help)
      ->type_name("NUMBER")
      ->default_str(fmt::format("{}", value));
}

bool isAnySeed(std::uint64_t) { return true; }
bool isNumberOfImages(int n) { return n >= 3 && n <= 10000; }
bool isSigma(double sigma) { return std::isfinite(sigma) && sigma >= 0; }
bool isDensity(double density) { return std::isfinite(density) && density > 0; }
bool isDuration(double seconds) { return seconds >= 2 && seconds <= 3600; }
bool isRate(double rate) { return rate >= 1 && rate <= 10000; }
bool isOffset(double seconds) { return std::abs(seconds) <= 1e6; }
bool isPhase(double seconds) { return std::abs(seconds) <= 1; }
bool isLineDelay(double seconds) { return std::abs(seconds) <= 1e-3; }

void addStereoImu(CLI::App& simulate) {
  struct Arguments {
    StereoImuOptions options;
    std::string output;
  };
  const auto arguments = std::make_shared<Arguments>();
  StereoImuOptions& options = arguments->options;
  CLI::App& command = *simulate.add_subcommand(
      "stereo-imu",
      "slom simulate stereo-imu --seed 1 --output simulated\n\n"
      "Simulate a stereo camera with an accelerometer and a level board.\n"
      "Writes left_corners.csv, right_corners.csv and imu.csv for slom calibrate, and truth.json.\n");
  command.add_option("--output", arguments->output, "folder for the files; created if it is missing")
      ->type_name("FOLDER")
      ->required();
  addNumber(command, "--seed", options.seed, "of the random views and noise; equal seeds give equal files",
            isAnySeed, "a whole number from 0 to 18446744073709551615");
  addNumber(command, "--images", options.images, "number of views", isNumberOfImages,
            "a whole number from 3, below which no camera can be calibrated, to 10000");
  addNumber(command, "--sigma-px", options.sigma_px, "noise of a corner's u and v [px]", isSigma,
            "a standard deviation in px, 0 for corners without noise");
  addNumber(command, "--sigma-acc", options.sigma_acc, "noise of each axis of the accelerometer [m/s^2]",
            isSigma, "a standard deviation in m/s^2, 0 for readings without noise");
  command.callback([arguments] {
    const StereoImuData data = simulateStereoImu(arguments->options);
    writeStereoImu(data, arguments->options, arguments->output);
    say(fmt::format("{} images: {} corners left, {} right; written with the truth to {}\n",
                    arguments->options.images, data.left.size(), data.right.size(),
                    oneLine(arguments->output)));
  });
}

void addNoise(CLI::App& command, ImuNoise& noise) {
  const std::string remedy = "a positive density";
  addNumber(command, "--gyro-noise", noise.gyro, "density of its white noise [rad/s/sqrt(Hz)]", isDensity,
            remedy);
  addNumber(command, "--gyro-walk", noise.gyro_walk, "density of its bias' walk [rad/s^2/sqrt(Hz)]",
            isDensity, remedy);
  addNumber(command, "--acc-noise", noise.force, "density of its white noise [m/s^2/sqrt(Hz)]", isDensity,
            remedy);
  addNumber(command, "--acc-walk", noise.force_walk, "density of its bias' walk [m/s^3/sqrt(Hz)]", isDensity,
            remedy);
}

void addMotion(CLI::App& command, SimulatedMotion& motion) {
  const auto read = [&motion](const std::string& text) {
    const std::map<std::string, SimulatedMotion> motions{{"full", SimulatedMotion::full},
                                                         {"translation", SimulatedMotion::translation},
                                                         {"one-axis", SimulatedMotion::one_axis},
                                                         {"rest", SimulatedMotion::rest}};
    const auto found = motions.find(text);
    if (found == motions.end())
      throw UserError(fmt::format("--motion is {}; give full, translation, one-axis or rest", text));
    motion = found->second;
  };
  command
      .add_option_function<std::string>(
          "--motion", read,
          "of the rig while the IMU records: full, translation, one-axis or rest;\n"
          "before all but full, the cameras alone record a full motion as long")
      ->type_name("MOTION")
      ->default_str("full");
}

void addStereoImuStream(CLI::App& simulate) {
  struct Arguments {
    StereoImuStreamOptions options;
    std::string output;
  };
  const auto arguments = std::make_shared<Arguments>();
  StereoImuStreamOptions& options = arguments->options;
  CLI::App& command = *simulate.add_subcommand(
      "stereo-imu-stream",
      "slom simulate stereo-imu-stream --seed 1 --output simulated\n\n"
      "Simulate a stereo camera with an IMU, moved in front of an AprilGrid.\n"
      "Writes cam0_corners.csv, cam1_corners.csv, imu0.csv and imu.yaml for slom calibrate, and truth.json.\n");
  command.add_option("--output", arguments->output, "folder for the files; created if it is missing")
      ->type_name("FOLDER")
      ->required();
  addNumber(command, "--seed", options.seed, "of the random motion and noise; equal seeds give equal files",
            isAnySeed, "a whole number from 0 to 18446744073709551615");
  addNumber(command, "--seconds", options.seconds, "length of the recording, see --motion", isDuration,
            "a number of seconds from 2 to 3600");
  addNumber(command, "--camera-rate", options.camera_rate, "images per second", isRate,
            "a rate from 1 to 10000 Hz");
  addNumber(command, "--imu-rate", options.imu_rate, "readings per second", isRate,
            "a rate from 1 to 10000 Hz");
  addNumber(command, "--sigma-px", options.sigma_px, "noise of a corner's u and v [px]", isSigma,
            "a standard deviation in px, 0 for corners without noise");
  addNoise(command, options.noise);
  addNumber(command, "--time-offset", options.time_offset, "t_imu - t_camera [s]", isOffset,
            "a number of seconds from -1e6 to 1e6");
  addNumber(command, "--camera-offset", options.camera_offset, "t_cam1 - t_cam0 [s]", isOffset,
            "a number of seconds from -1e6 to 1e6");
  addNumber(command, "--camera-phase", options.camera_phase, "from an image of cam0 to one of cam1 [s]",
            isPhase, "a number of seconds from -1 to 1");
  addNumber(command, "--line-delay", options.line_delay, "time between rows of an image [s]", isLineDelay,
            "a number of seconds from -1e-3 to 1e-3");
  addMotion(command, options.motion);
  command.callback([arguments] {
    const StereoImuStreamData data = simulateStereoImuStream(arguments->options);
    writeStereoImuStream(data, arguments->options, arguments->output);
    say(fmt::format("{} s: {} corners cam0, {} cam1, {} readings; written with the truth to {}\n",
                    arguments->options.seconds, data.corners[0].size(), data.corners[1].size(),
                    data.imu.size(), oneLine(arguments->output)));
  });
}

}  // namespace

void addSimulateCommand(CLI::App& app) {
  CLI::App* simulate = app.add_subcommand(
      "simulate",
      "slom simulate stereo-imu --seed 1 --output simulated\n\nWrite simulated measurements with known true parameters.\n");
  simulate->require_subcommand(1);
  addStereoImu(*simulate);
  addStereoImuStream(*simulate);
}

}  // namespace slom::app
