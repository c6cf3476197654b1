// What the user asked for on the command line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"
#include "calibrate/input/dataset.hpp"
#include "calibrate/models.hpp"
#include "calibrate/types.hpp"

namespace slom::app::calib {

/// `NAME=FILE` of --camera, or `NAME=PATTERN ...` of --images.
struct CameraFile {
  std::string name;
  std::string file;                     ///< of the corners; or the patterns, for people to read
  std::vector<std::string> patterns{};  ///< of the photographs
};

/// Of --output.
enum class OutputFormat { opencv, ros, kalibr };

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
  std::optional<Board> board;  ///< in the photographs of the cameras; nothing: these have corner files
  std::string corners_folder;  ///< for the corners that were found; empty: none
  std::string imu_file;        ///< empty: no IMU
  Model model = Model::opencv5;
  std::vector<Model> compared;  ///< by --compare; empty: none
  bool model_is_given = true;   ///< otherwise it is the one that the comparison chooses
  double sigma_px = 0.25;       ///< of u and of v [px]
  double sigma_acc = 0.05;      ///< of each axis [m/s^2]
  Fixed fixed;
  std::vector<LensConstraint> lens;
  std::optional<double> sigma_denominator;  ///< of a prior of k4, k5, k6 of opencv8 at 0; nothing: no prior
  int max_iterations = 100;
  double max_seconds = 0;   ///< of the whole run; 0: no limit
  std::string json_file;    ///< empty: none
  std::string yaml_file;    ///< empty: none
  std::string report_file;  ///< empty: none
  OutputFormat format = OutputFormat::opencv;
  std::map<std::string, ImageSize> image_sizes;  ///< by camera, where the user gave them
  bool quiet = false;
};

/// The options as text, as CLI11 hands them over.
struct RawOptions {
  std::vector<std::string> cameras, images;
  BoardOptions board;
  std::vector<std::string> fixed, bounded;
  std::vector<std::string> image_sizes;
  std::string format;  ///< empty: by the name of the file
  std::string model;   ///< empty: opencv5, or what the comparison chooses
  std::vector<std::string> compared;
  bool compare = false;
  Settings rest;
};

/// Reads the texts and checks all values; UserError names the option.
Settings parseSettings(const RawOptions& raw);

}  // namespace slom::app::calib
