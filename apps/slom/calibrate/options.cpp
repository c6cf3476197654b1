#include "calibrate/options.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/library.hpp"
#include "fitting/fit_limits.hpp"
#include "help.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

constexpr const char* help_text =
    R"(slom calibrate --board 9x6 --square 0.025 --images left='left*.jpg' --images right='right*.jpg'
slom calibrate --camera left=left_corners.csv --camera right=right_corners.csv --imu imu.csv \
               --json result.json --output calibration.yaml

Calibrate cameras, and an IMU on their rig, from images of a board.
Needs no start values. The first camera is the reference. With --imu, the board must lie level.

Photographs:  the last number in a file's name is the number of the image.
Corner files: image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px
IMU file:     image,ax_m_s2,ay_m_s2,az_m_s2,valid

Below this header, each corner or reading has a row. Images with the same number were taken at the
same time. Cameras may lack images or corners. Corner files of mrcal (corners.vnl) and OpenCV (XML,
YAML, JSON with image_points) are read too; add --board and --square if they do not state the board.
)";

constexpr const char* footer_text =
    R"(Exit code: 0 success, also if the verdict is doubtful; 1 the fit did not converge or is not
determined (the report says why), images contradict each other, the run was cut short, or standard
output could not be written; 2 wrong options or data.)";

/// Returns lines such as `opencv4: fx fy cx cy k1 k2 p1 p2`, one for each model.
std::string modelTable() {
  std::vector<std::string> lines;
  for (const Model& model : allModels())
    lines.push_back(fmt::format("{}: {}", model.name(), fmt::join(model.parameters(), " ")));
  return fmt::format("{}", fmt::join(lines, "\n"));
}

std::vector<std::string> namesOf(const std::vector<Model>& models) {
  std::vector<std::string> names;
  for (const Model& model : models) names.push_back(model.name());
  return names;
}

/// Adds the options that --help shows. Returns --compare.
CLI::Option* addUsualOptions(CLI::App& command, RawOptions& raw) {
  CommandSettings& settings = raw.rest;
  command
      .add_option("--camera", raw.cameras,
                  "name and corner file; repeat for each camera and part of its recording")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
  command
      .add_option("--images", raw.images,
                  "name and photographs of a camera, files or a pattern in quotes;\n"
                  "repeat for each camera")
      ->type_name("NAME=PATTERN");
  command
      .add_option("--board", raw.board.board,
                  "board in the photographs, or in corner files that do not state it;\n"
                  "9x6: chessboard with 9 by 6 inner corners; charuco:8x5:4x4_50: 8 by 5\n"
                  "squares, markers of the dictionary 4x4_50; aprilgrid:6x6: 6 by 6 tags\n"
                  "36h11, as Kalibr prints them; FILE.yaml: Kalibr target")
      ->type_name("BOARD");
  command.add_option("--square", raw.board.square_m, "side of a square, or of a tag of an AprilGrid [m]")
      ->type_name("NUMBER");
  command.add_option("--marker", raw.board.marker_m, "side of a marker of a ChArUco board [m]")
      ->type_name("NUMBER");
  command
      .add_option("--spacing", raw.board.spacing,
                  "gap between tags of an AprilGrid, divided by the side of a tag")
      ->type_name("NUMBER");
  command.add_option("--imu", raw.imu_files, "accelerometer readings, at most one for each image")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command
      .add_option("--imu-stream", raw.imu_streams,
                  "name and readings of an IMU in motion: time, gyroscope, accelerometer;\n"
                  "repeat for each IMU; images then need times. --help-all has more:\n"
                  "--imu-noise, --lenses, --camera-offsets, --rolling-shutter")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
  command
      .add_option("--intrinsics", raw.model,
                  wrapped("lens: " + listed(namesOf(allModels()), ", ", " or "), 70))
      ->type_name("MODEL")
      ->default_str("opencv5");
  CLI::Option* const compare =
      command
          .add_option(
              "--compare", raw.compared,
              wrapped(fmt::format("fit several models and keep the one that best predicts images it was "
                                  "not fitted to, or --intrinsics; without names: {}",
                                  fmt::join(namesOf(comparedModels()), ", ")),
                      70))
          ->type_name("MODEL,...")
          ->expected(0, int(allModels().size()))
          ->delimiter(',');
  command.add_option("--sigma-px", settings.sigma_px, "standard deviation of u and of v [px]")
      ->type_name("NUMBER")
      ->capture_default_str();
  command
      .add_option("--exclude", raw.excluded,
                  "leave out an image or a corner: 17, 17:5, left.17:5; may be repeated")
      ->type_name("[CAMERA.]IMAGE[:CORNER]")
      ->allow_extra_args(false);
  command.add_option("--json", settings.json_file, "result with all digits, as JSON; -: standard output")
      ->type_name("FILE");
  command
      .add_option("--output", settings.yaml_file,
                  "calibration as YAML for OpenCV, ROS ('{name}' in the file's name) or\n"
                  "Kalibr (camchain in the file's name)")
      ->type_name("FILE");
  command
      .add_option("--report", settings.report_file,
                  "how far to trust the calibration, as a page for the browser")
      ->type_name("FILE");
  command.add_flag("--quiet", settings.quiet, "print only errors");
  return compare;
}

/// Adds the options that only --help-all shows.
void addMoreOptions(CLI::App& command, RawOptions& raw) {
  CommandSettings& settings = raw.rest;
  command
      .add_option("--corners-out", settings.corners_folder,
                  "folder for the corners found in photographs: NAME_corners.csv, which\n"
                  "--camera reads")
      ->type_name("FOLDER");
  command
      .add_option("--image-size", raw.image_sizes,
                  "size of the images of a camera if its corner file does not state it\n"
                  "[px]; without NAME: of all cameras that are not named")
      ->type_name("NAME=WxH");
  command
      .add_option("--format", raw.format,
                  "format of --output: OpenCV's FileStorage, ROS camera_info, Kalibr's\n"
                  "camchain, or files of OpenVINS or Basalt, which need an --imu-stream;\n"
                  "otherwise ros if the name has {name} in it, kalibr if it has camchain,\n"
                  "openvins if it has imucam_chain, or opencv")
      ->type_name("opencv|ros|kalibr|openvins|basalt");
  command
      .add_option("--imu-reads", raw.imu_reads,
                  "what the accelerometer of --imu reports at rest: the reaction to\n"
                  "gravity, which points up, or gravity")
      ->type_name("reaction|gravity")
      ->default_str("reaction");
  command
      .add_option("--imu-noise", raw.imu_noises,
                  "noise densities of an --imu-stream, as in Kalibr's imu.yaml; otherwise\n"
                  "estimated from the residuals")
      ->type_name("NAME=FILE")
      ->allow_extra_args(false);
  command
      .add_option("--imu-model", raw.imu_model,
                  "errors of the axes of an --imu-stream to estimate: none; scales,\n"
                  "misalignments and the gyroscope's sensitivity to forces; or also\n"
                  "the places of the accelerometers")
      ->type_name("calibrated|scale-misalignment|scale-misalignment-size-effect")
      ->default_str("calibrated");
  command
      .add_option("--imu-motion", raw.imu_motion,
                  "how an --imu-stream is fitted: readings integrated between images, a\n"
                  "spline through all readings and images, or both, compared")
      ->type_name("preintegration|splines|both")
      ->default_str("preintegration");
  command
      .add_flag("--camera-offsets", settings.stream.camera_offsets,
                "estimate the time offset of each camera to the first, by splines;\n"
                "needs an --imu-stream; images need not be simultaneous")
      ->disable_flag_override();
  command
      .add_option("--knot-spacing", raw.knot_spacing, "time between knots of the spline [s]; otherwise 0.03")
      ->type_name("NUMBER");
  command
      .add_option("--sigma-acc", settings.sigma_acc, "standard deviation of each axis of a reading [m/s^2]")
      ->type_name("NUMBER")
      ->capture_default_str();
  command
      .add_option("--fix", raw.fixed,
                  "fix a value instead of estimating it; may be repeated:\n"
                  "acc_bias (0,0,0) or acc_bias=X,Y,Z [m/s^2];\n"
                  "gravity (9.80665) or gravity=MAGNITUDE [m/s^2];\n"
                  "or a parameter of all cameras or of one: k3 (0), left.k3 (0), cx=320;\n"
                  "the models have\n" +
                      modelTable())
      ->type_name("NAME[=VALUE]")
      ->allow_extra_args(false);
  command
      .add_option("--bound", raw.bounded,
                  "keep a parameter of cameras between two values: k3=-1,1 or\n"
                  "left.fx=400,600; may be repeated")
      ->type_name("NAME=LOWER,UPPER")
      ->allow_extra_args(false);
  command
      .add_option("--lenses", raw.lenses,
                  "hold the lenses at known values: Kalibr's camchain for all cameras in\n"
                  "their order, or NAME=FILE, a camchain or EuRoC's sensor.yaml with one\n"
                  "camera; sets --intrinsics")
      ->type_name("[NAME=]FILE")
      ->allow_extra_args(false);
  command
      .add_option("--board-shape", raw.board_shape,
                  "what is estimated of the board: nothing; a bend, by three numbers; or\n"
                  "each corner by itself. --compare tries all three, unless this is given")
      ->type_name("flat|bent|free")
      ->default_str("flat");
  command
      .add_option("--sigma-board", raw.sigma_board,
                  "of a free board: standard deviation of each coordinate of a corner\n"
                  "from its stated place [m]; otherwise estimated")
      ->type_name("NUMBER");
  command
      .add_option("--robust", raw.robust,
                  "gross corners, which contradict the others: reject leaves them out of\n"
                  "the fit and lists them; none keeps them; by huber and cauchy, all\n"
                  "corners count less the farther off they are")
      ->type_name("none|reject|huber|cauchy")
      ->capture_default_str();
  command
      .add_option("--sigma-by", raw.sigma_by,
                  "what --sigma-px grows with, by as much as the residuals say: motion of\n"
                  "the corners from image to image, slant of the board, or its distance.\n"
                  "--compare tries all of them, unless this is given")
      ->type_name("constant|speed|slant|distance")
      ->default_str("constant");
  command
      .add_flag("--rolling-shutter", settings.rolling_shutter,
                "estimate the time in which the rows of an image are read out: from an\n"
                "--imu-stream, by splines; otherwise from recordings with image numbers\n"
                "at equal intervals; --compare tries it")
      ->disable_flag_override();
  command.add_option("--max-iterations", settings.max_iterations, "limit of iterations of a fit")
      ->type_name("NUMBER")
      ->capture_default_str();
  addTimeLimit(command, settings.limits.max_seconds);
}

}  // namespace

CLI::Option* addOptions(CLI::App& command, RawOptions& raw) {
  command.description(help_text);
  command.footer(footer_text);
  command.set_help_all_flag("--help-all", "print this help with all options");
  CLI::Option* const compare = addUsualOptions(command, raw);
  command.option_defaults()->group(more_options);
  addMoreOptions(command, raw);
  command.allow_extras();
  return compare;
}

}  // namespace slom::app::calib
