// The command line, as the user wrote it and as checked settings.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/detect/board.hpp"
#include "calibrate/library.hpp"
#include "fitting/console.hpp"

namespace slom::app::calib {

/// `NAME=FILE` of --camera, or `NAME=PATTERN ...` of --images. Several options for one camera are joined.
struct CameraFile {
  std::string name;
  std::string file;                     ///< the corner files or the patterns, as text for people
  std::vector<std::string> patterns{};  ///< patterns of the photographs
  std::vector<std::string> files{};     ///< corner files
};

/// `NAME=FILE` of --imu-stream, with the file of --imu-noise.
struct ImuFile {
  std::string name, file;
  std::string noise_file;  ///< empty: none
};

/// The format of --output.
enum class OutputFormat { opencv, ros, kalibr, openvins, basalt };

/// A constraint of --fix or --bound, and the option as the user wrote it.
struct LensOption : LensConstraint {
  std::string option;
};

/// The settings of the library, and those of the command besides calibrating.
struct CommandSettings : Settings, ReportOptions {
  std::vector<CameraFile> cameras;
  std::optional<Board> board;  ///< in the photographs of the cameras; nothing: the cameras have corner files
  std::optional<BoardOfFiles>
      board_of_files;  ///< what the options say about a board in corner files; nothing: no option is given
  std::string corners_folder;        ///< for the corners that were found; empty: not written
  std::string imu_file;              ///< empty: no IMU
  std::vector<ImuFile> imu_streams;  ///< IMUs in motion
  StreamSettings stream;             ///< of these
  bool compares_paths = false;       ///< also fits them by splines
  /// Clocks or shutters of the cameras are estimated with the motion, before their own calibration.
  bool cameras_move = false;
  std::vector<LensOption> lens_options;  ///< Settings::lens follows from them
  std::vector<Model> compared;           ///< models of --compare; empty: none
  bool model_is_given = true;            ///< false: the comparison chooses the model
  bool board_shape_is_given = true;      ///< likewise
  bool sigma_by_is_given = true;         ///< likewise
  bool is_compared = false;              ///< by --compare
  std::string yaml_file;                 ///< empty: none
  std::string report_file;               ///< empty: none
  OutputFormat format = OutputFormat::opencv;
  std::map<std::string, ImageSize> image_sizes;  ///< by camera, if the user gave them
  std::vector<Exclusion> exclusions;             ///< of --exclude
};

/// The options as text, as CLI11 passes them.
struct RawOptions {
  std::vector<std::string> cameras, images, imu_files, imu_streams, imu_noises;
  BoardOptions board;
  std::vector<std::string> fixed, bounded, excluded;
  std::vector<std::string> lenses;  ///< of --lenses
  std::vector<std::string> image_sizes;
  std::string format;  ///< empty: by the name of the file
  std::string robust = "reject";
  std::string imu_reads;               ///< empty: reaction
  std::string imu_model;               ///< empty: calibrated
  std::string imu_motion;              ///< empty: splines if the cameras move, otherwise preintegration
  std::optional<double> knot_spacing;  ///< [s]
  std::string sigma_by;                ///< empty: constant, or what the comparison chooses
  std::string board_shape;             ///< empty: flat, or what the comparison chooses
  std::optional<double> sigma_board;   ///< [m]
  std::string model;                   ///< empty: opencv5, or what the comparison chooses
  std::vector<std::string> compared;
  bool compare = false;
  CommandSettings rest;
};

/// Reads the texts and checks all values. UserError names the option.
CommandSettings parseSettings(const RawOptions& raw);

}  // namespace slom::app::calib
