// `slom calibrate`: options, then read -> calibrate -> report and files.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/calibrate.hpp"
#include "calibrate/detect/read_photos.hpp"
#include "calibrate/html/page.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/comparison_text.hpp"
#include "calibrate/output/formats.hpp"
#include "calibrate/output/json.hpp"
#include "calibrate/output/report.hpp"
#include "calibrate/result_paths.hpp"
#include "calibrate/settings.hpp"
#include "calibrate/soundness.hpp"
#include "calibrate/words_of_options.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/progress.hpp"
#include "help.hpp"
#include "output_files.hpp"
#include "plausible.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app {
namespace calib {
namespace {

constexpr const char* help_text =
    R"(slom calibrate --board 9x6 --square 0.025 --images left='left*.jpg' --images right='right*.jpg'
slom calibrate --camera left=left_corners.csv --camera right=right_corners.csv --imu imu.csv \
               --json result.json --output calibration.yaml

Calibrate cameras, and an IMU on the same rig, from images of a flat board.
Needs no start values. The first camera is the reference. With an IMU, the board must lie level.

Photographs:  the last number in a file's name is the number of the image.
Corner files: image,corner,world_x_m,world_y_m,world_z_m,u_px,v_px
IMU file:     image,ax_m_s2,ay_m_s2,az_m_s2,valid

Below this header, each corner or reading has a row. Images with the same number were taken at the
same time. Cameras may lack images or corners. Corner files of mrcal (corners.vnl) and OpenCV (XML,
YAML, JSON with image_points) are read too; add --board and --square if they do not state the board.
)";

constexpr const char* footer_text =
    R"(Exit code: 0 success; 1 the fit did not converge or is not determined (the report says why), images
contradict each other, the run was cut short, or standard output could not be written; 2 wrong options or
data.)";

/// How time stamps were paired.
void sayPairing(const ImageNumbers& numbers, const CommandSettings& settings) {
  if (const std::string sentence = sentenceOf(numbers); !settings.quiet && !sentence.empty())
    say(sentence + "\n");
}

/// Refuses a --square that is hardly in metres, if the corner file says how many corners the board has.
void requireSquareInMetres(const CommandSettings& settings, const Dataset& data) {
  if (!settings.board_of_files || settings.board_of_files->columns > 0) return;
  double across = 0;
  for (const Corner& corner : fullestView(data).corners)
    across = std::max(across, (corner.world - fullestView(data).corners.front().world).norm());
  requireMetres("--square", settings.board_of_files->square_m, across);
}

/// `numbers` gets the image numbers as files have them.
Dataset readDataset(const CommandSettings& settings, ImageNumbers& numbers) {
  Dataset data;
  if (settings.board) {
    data.cameras = readPhotos(settings, numbers);
  } else {
    std::vector<CameraFiles> files;
    for (const CameraFile& camera : settings.cameras) files.push_back({camera.name, camera.files});
    data = inWordsOfOptions(settings, [&] {
      return settings.board_of_files ? readRig(files, settings.imu_file, *settings.board_of_files, &numbers)
                                     : readRig(files, settings.imu_file, &numbers);
    });
    requireSquareInMetres(settings, data);
    sayPairing(numbers, settings);
  }
  for (CameraData& camera : data.cameras) {
    const auto given = settings.image_sizes.find(camera.name);
    if (given == settings.image_sizes.end()) continue;
    const ImageSize& size = given->second;
    const std::optional<ImageSize>& known = camera.image_size;
    if (known && (known->width != size.width || known->height != size.height)) {
      throw UserError(fmt::format(
          "--image-size {}={}x{}: {} {} x {} pixels; leave the option out{}", camera.name, size.width,
          size.height, settings.board ? "the photographs have" : camera.file + ": images have", known->width,
          known->height, settings.board ? "" : ", or correct the file"));
    }
    camera.image_size = size;
  }
  if (!settings.imu_file.empty() && !data.imu) data.imu = readImu(settings.imu_file);
  inWordsOfOptions(settings, [&] {
    exclude(data, settings.exclusions);
    leaveOutCopies(data);
  });
  return data;
}

/// `opencv4: fx fy cx cy k1 k2 p1 p2`, a line for each model.
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

Progress printedProgress() {
  const auto header_is_printed = std::make_shared<bool>(false);
  return {[](const SingleCameraReport& alone) { say(singleCameraText(alone)); },
          [header_is_printed](const IterationRecord& record) {
            if (!std::exchange(*header_is_printed, true)) say("\nall together\n" + iterationHeader());
            say(iterationText(record));
            std::fflush(stdout);
          }};
}

/// A result that is not sound goes to JSON, which says so, but not to YAML, whose readers would take it for good.
void writeFiles(const Dataset& data, const Result& result, const CommandSettings& settings,
                const ImageNumbers& numbers) {
  OutputFiles files;
  std::string said;
  if (!settings.json_file.empty()) {
    files.add(settings.json_file, toJson(result, numbers));
    said += fmt::format("written: {}\n", oneLine(settings.json_file));
  }
  const Unsoundness unsound = unsoundnessOf(result);
  if (result.success() && unsound.isNone() && !settings.yaml_file.empty()) {
    for (const OutputText& output : outputTexts(result, settings)) {
      files.add(output.file, output.text);
      said += fmt::format("written: {}\n", oneLine(output.file));
    }
  } else {
    for (const std::string& file : outputFiles(settings))
      said += fmt::format("not written, because {}: {}\n",
                          result.success() ? unsound.because : "the fit failed", oneLine(file));
  }
  if (!settings.report_file.empty()) {
    files.add(settings.report_file, toHtml(data, result));
    said += fmt::format("written: {}\n", oneLine(settings.report_file));
  }
  files.commit();
  if (!settings.quiet && !said.empty()) say("\n" + said);
}

/// Finds out before the work that its results could not be written.
void requireResultsWritable(const CommandSettings& settings) {
  std::vector<std::string> files = outputFiles(settings);
  files.push_back(settings.json_file);
  files.push_back(settings.report_file);
  requireWritable(files);
}

/// What --compare leaves open: what no other option gives.
Choices choicesOf(const CommandSettings& settings) {
  return {settings.compared, !settings.model_is_given, !settings.board_shape_is_given,
          !settings.sigma_by_is_given, settings.is_compared && !settings.rolling_shutter};
}

/// Says what each comparison found, and refuses a model that the output format cannot hold before the fit.
ChoiceProgress progressOf(const CommandSettings& settings) {
  ChoiceProgress progress;
  progress.before_fit = [&](const Settings&) {
    requireModelOf(settings);
    if (!settings.quiet) say(aloneHeader(settings));
  };
  progress.models = [&](const Comparison& comparison, const Settings&) {
    const bool is_again = !settings.board_shape_is_given && settings.board_shape != BoardShape::flat;
    if (!settings.quiet && is_again) say(fmt::format("\nwith a {} board:\n", toString(settings.board_shape)));
    if (!settings.quiet) say(comparisonText(inWordsOfOptions(settings, comparison)));
    requireModelOf(settings);
  };
  if (settings.quiet) return progress;
  progress.board_shapes = [](const Comparison& comparison) { say(boardShapesText(comparison)); };
  progress.noise = [](const NoiseComparison& noise, const Result& result) { say(noiseText(noise, result)); };
  progress.readout = [](const auto& trials, const Result& result) { say(readoutText(trials, result)); };
  progress.fit = printedProgress();
  return progress;
}

/// What the run is about. Ends it when the time is over before there is anything to calibrate.
Dataset readInTime(const CommandSettings& settings, ImageNumbers& numbers) {
  try {
    return readDataset(settings, numbers);
  } catch (const RunEnded& ended) {
    sayError(fmt::format(
        "slom: {} while photographs were searched for the board, so nothing was calibrated; allow "
        "more by --max-seconds\n",
        ended.what()));
    throw CLI::RuntimeError(exit_not_converged);
  }
}

/// Assesses the result for the verdict, the page and the JSON. If time runs out and the user asked for no page and no JSON, the report has no
/// verdict.
void assessResult(const Dataset& data, const CommandSettings& settings, Result& result) {
  const bool is_asked_for = !settings.json_file.empty() || !settings.report_file.empty();
  if (settings.quiet && !is_asked_for) return;
  result.quality = assess(data, settings, result);
  if (!is_asked_for && !result.quality->cut_short.empty()) result.quality.reset();
}

/// What is missing in a run that did not do all that it was asked for; empty otherwise.
std::string failureOf(const Result& result) {
  const bool is_cut_short = !result.converged && !FitLimits::reasonToEnd().empty();
  if (!result.success() && (result.strays.empty() || is_cut_short)) {
    return "the calibration failed: " +
           (result.undetermined.empty() || is_cut_short
                ? result.message +
                      (result.better_model || !result.causes.empty() ? "; " + causeText(result) : "")
                : "the data do not determine all parameters: " + result.undetermined);
  }
  if (const Unsoundness unsound = unsoundnessOf(result); !unsound.isNone())
    return (result.success() ? "the calibration is of no use: " : "the calibration failed: ") +
           unsound.sentence;
  for (const std::optional<Comparison>& comparison : {result.comparison, result.board_comparison}) {
    if (comparison && !comparison->cut_short.empty())
      return "the comparison was cut short: " + comparison->cut_short;
  }
  if (result.quality && !result.quality->cut_short.empty())
    return "the assessment was cut short: " + result.quality->cut_short;
  return "";
}

/// Words that belong to no option; a file among them is most often a camera's.
void refuseExtras(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return;
  std::error_code ignored;
  if (words.size() == 1 && std::filesystem::is_regular_file(words.front(), ignored)) {
    throw UserError(fmt::format(
        "{0}: say which camera this is of: --camera NAME={0} for corners, --images NAME={0} for photographs",
        words.front()));
  }
  throw CLI::ExtrasError(command.get_name(),
                         {words.rbegin(), words.rend()});  // it lists them from the last on
}

void run(const RawOptions& raw) {
  CommandSettings settings = parseSettings(raw);
  // There is nothing to write before the data are read: until then Ctrl-C ends the program.
  FitLimits limits(settings.limits.max_seconds, FitLimits::Interrupts::end_the_program);
  settings.limits = limitsOf(limits);
  if (settings.board) requireResultsWritable(settings);  // before the search for boards, which takes long
  if (settings.model_is_given) requireModelOf(settings);
  ImageNumbers numbers;
  const Dataset data = readInTime(settings, numbers);
  requireImageSizes(settings, data.cameras);
  requireResultsWritable(settings);
  limits.catchInterrupts();
  if (!settings.quiet) say(dataText(data));
  for (const std::string& file : settings.quiet ? std::vector<std::string>() : cornerFiles(settings))
    say(fmt::format("written: {}\n", oneLine(file)));
  Result result = inWordsOfOptions(
      settings, [&] { return calibrateByChoice(data, settings, choicesOf(settings), progressOf(settings)); });
  if (result.comparison) result.comparison = inWordsOfOptions(settings, *result.comparison);
  assessResult(data, settings, result);
  if (!settings.quiet) say(reportText(result));
  writeFiles(data, result, settings, numbers);
  const std::string failure = failureOf(result);
  if (failure.empty()) return;
  sayError(fmt::format("slom: {}\n", oneLine(failure)));
  throw CLI::RuntimeError(exit_not_converged);
}

/// Adds the options that --help shows. Returns --compare.
CLI::Option* addUsualOptions(CLI::App& command, RawOptions& raw) {
  CommandSettings& settings = raw.rest;
  command
      .add_option("--camera", raw.cameras,
                  "name and corner file of a camera; repeat for each camera, and for each\n"
                  "part of its recording")
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
  command.add_option("--json", settings.json_file, "result with all digits, as JSON")->type_name("FILE");
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

/// Adds the options that --help-all alone shows.
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
                  "format of --output: OpenCV's FileStorage, ROS camera_info or Kalibr's\n"
                  "camchain; otherwise ros if the name has {name} in it, kalibr if it has\n"
                  "camchain, or opencv")
      ->type_name("opencv|ros|kalibr");
  command
      .add_option("--imu-reads", raw.imu_reads,
                  "what the accelerometer reports at rest: the reaction to gravity, which\n"
                  "points up, or gravity")
      ->type_name("reaction|gravity")
      ->default_str("reaction");
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
  command.add_flag("--rolling-shutter", settings.rolling_shutter,
                   "estimate the time in which the rows of an image are read out, from\n"
                   "recordings with image numbers at equal intervals; --compare tries it");
  command.add_option("--max-iterations", settings.max_iterations, "limit of iterations of a fit")
      ->type_name("NUMBER")
      ->capture_default_str();
  addTimeLimit(command, settings.limits.max_seconds);
}

}  // namespace
}  // namespace calib

void addCalibrateCommand(CLI::App& app) {
  using namespace calib;
  const auto raw = std::make_shared<RawOptions>();
  CLI::App& command = *app.add_subcommand("calibrate", help_text);
  command.footer(footer_text);
  command.set_help_all_flag("--help-all", "print this help with all options");
  CLI::Option* const compare = addUsualOptions(command, *raw);
  command.option_defaults()->group(more_options);
  addMoreOptions(command, *raw);
  command.allow_extras();
  command.callback([raw, compare, &command] {
    refuseExtras(command);
    raw->compare = compare->count() > 0;
    run(*raw);
  });
}

}  // namespace slom::app
