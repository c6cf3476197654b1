// What the user asked for on the command line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibrate/types.hpp"

namespace slom::app::calib {

enum class Model { opencv5, opencv4, radial1 };
const char* toString(Model model);

/// `NAME=FILE` of --camera.
struct CameraFile {
  std::string name;
  std::string file;
};

/// What --fix holds at a value instead of estimating it.
struct Fixed {
  std::optional<vec3> acc_bias;   ///< [m/s^2]
  std::optional<double> gravity;  ///< magnitude [m/s^2]; the sign is found from the data
};

/// A parameter of one camera or of all that --fix holds or --bound keeps between two values.
struct LensConstraint {
  std::string option;  ///< as the user wrote it
  std::string camera;  ///< empty: all
  std::string parameter;
  double lower = 0, upper = 0;

  bool isFixed() const { return lower == upper; }
  bool concerns(const std::string& name) const { return camera.empty() || camera == name; }
};

struct Settings {
  std::vector<CameraFile> cameras;
  std::string imu_file;  ///< empty: no IMU
  Model model = Model::opencv5;
  double sigma_px = 0.25;   ///< of u and of v [px]
  double sigma_acc = 0.05;  ///< of each axis [m/s^2]
  Fixed fixed;
  std::vector<LensConstraint> lens;
  int max_iterations = 100;
  std::string json_file;  ///< empty: none
  std::string yaml_file;  ///< empty: none
  std::string report_file;  ///< empty: none
  bool quiet = false;
};

/// The options as text, as CLI11 hands them over.
struct RawOptions {
  std::vector<std::string> cameras;
  std::vector<std::string> fixed, bounded;
  std::string model = "opencv5";
  Settings rest;
};

/// Reads the texts and checks all values; UserError names the option.
Settings parseSettings(const RawOptions& raw);

}  // namespace slom::app::calib
