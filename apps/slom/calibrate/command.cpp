// `slom calibrate`: read -> calibrate -> report and files.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "calibrate/calibrate.hpp"
#include "calibrate/detect/read_photos.hpp"
#include "calibrate/html/page.hpp"
#include "calibrate/imu_streams.hpp"
#include "calibrate/library.hpp"
#include "calibrate/options.hpp"
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
#include "output_files.hpp"
#include "plausible.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app {
namespace calib {
namespace {

/// Reports how time stamps were paired.
void sayPairing(const ImageNumbers& numbers, const CommandSettings& settings) {
  if (const std::string sentence = sentenceOf(numbers); !settings.quiet && !sentence.empty())
    say(sentence + "\n");
}

/// Refuses a --square that is unlikely in metres, if the corner file says how many corners the board has.
void requireSquareInMetres(const CommandSettings& settings, const Dataset& data) {
  if (!settings.board_of_files || settings.board_of_files->columns > 0) return;
  double across = 0;
  for (const Corner& corner : fullestView(data).corners)
    across = std::max(across, (corner.world - fullestView(data).corners.front().world).norm());
  requireMetres("--square", settings.board_of_files->square_m, across);
}

/// Reads the data. `numbers` receives the image numbers in the files.
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
      throw UserError(
          fmt::format("--image-size {}={}x{}: {} {} x {} pixels; drop this option{}", camera.name, size.width,
                      size.height, settings.board ? "the photographs have" : camera.file + ": images have",
                      known->width, known->height, settings.board ? "" : ", or correct the file"));
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

Progress printedProgress() {
  const auto header_is_printed = std::make_shared<bool>(false);
  return {[](const SingleCameraReport& alone) { say(singleCameraText(alone)); },
          [header_is_printed](const IterationRecord& record) {
            if (!std::exchange(*header_is_printed, true)) say("\nall together\n" + iterationHeader());
            say(iterationText(record));
            std::fflush(stdout);
          }};
}

/// Writes the results. A result that is not sound goes to JSON, which says so, but not to YAML, whose readers would
/// trust it.
void writeFiles(const Dataset& data, const Result& result, const std::optional<FittedStreams>& fitted,
                const CommandSettings& settings, const ImageNumbers& numbers) {
  const StreamResult* streams = fitted ? &fitted->result : nullptr;
  OutputFiles files;
  std::string said;
  if (!settings.jsonPath().empty()) {
    files.add(settings.json_file, toJson(result, numbers, fitted));
    said += fmt::format("written: {}\n", oneLine(settings.json_file));
  }
  const Unsoundness unsound = unsoundnessOf(result);
  const bool has_imu = !streams || streams->success();
  if (result.success() && unsound.isNone() && has_imu && !settings.yaml_file.empty()) {
    for (const OutputText& output : outputTexts(result, streams, settings)) {
      files.add(output.file, output.text);
      said += fmt::format("written: {}\n", oneLine(output.file));
    }
    if (streams) said += lostTimes(settings.format, *streams);
  } else {
    for (const std::string& file : outputFiles(settings))
      said += fmt::format("not written, because {}: {}\n",
                          !result.success()         ? "the fit failed"
                          : has_imu                 ? unsound.because
                          : fitted->refusal.empty() ? "the fit of the IMU failed"
                                                    : "the readings of the IMU were refused",
                          oneLine(file));
  }
  if (!settings.report_file.empty()) {
    files.add(settings.report_file, toHtml(data, result, fitted));
    said += fmt::format("written: {}\n", oneLine(settings.report_file));
  }
  files.commit();
  if (settings.jsonToStdout())
    std::fputs(toJson(result, numbers, fitted).c_str(), stdout);  // main() checks that it arrived
  if (!settings.quiet && !said.empty()) say("\n" + said);
}

/// Throws before the work starts if its results could not be written.
void requireResultsWritable(const CommandSettings& settings) {
  std::vector<std::string> files = outputFiles(settings);
  files.push_back(settings.jsonPath());
  files.push_back(settings.report_file);
  requireWritable(files);
}

/// Returns what --compare is to choose: everything that no other option sets.
Choices choicesOf(const CommandSettings& settings) {
  return {settings.compared, !settings.model_is_given, !settings.board_shape_is_given,
          !settings.sigma_by_is_given,
          settings.is_compared && !settings.rolling_shutter && !settings.cameras_move};
}

/// Reports what each comparison found. Before the fit, refuses a model that the output format cannot hold.
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

/// Reads the data of the run. Ends the run if the time is over before there are data to calibrate.
Dataset readInTime(const CommandSettings& settings, ImageNumbers& numbers) {
  try {
    return readDataset(settings, numbers);
  } catch (const RunEnded& ended) {
    sayError(fmt::format(
        "slom: {} during the search for the board in photographs, so nothing was calibrated; pass a "
        "larger --max-seconds\n",
        ended.what()));
    throw CLI::RuntimeError(exit_not_converged);
  }
}

/// Returns the assessment for the verdict, the page and the JSON. If time runs out and the user asked for no page and no
/// JSON, there is none, and the report has no verdict.
std::optional<Quality> assessed(const Dataset& data, const CommandSettings& settings, const Result& result) {
  const bool is_asked_for = !settings.json_file.empty() || !settings.report_file.empty();
  if (settings.quiet && !is_asked_for) return {};
  std::optional<Quality> quality = assess(data, settings, result);
  if (!is_asked_for && !quality->cut_short.empty()) quality.reset();
  return quality;
}

/// Returns what is missing if the run did not do all that it was asked for; empty otherwise.
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
    return (result.success() ? "the calibration is unusable: " : "the calibration failed: ") +
           unsound.sentence;
  for (const std::optional<Comparison>& comparison : {result.comparison, result.board_comparison}) {
    if (comparison && !comparison->cut_short.empty())
      return "the comparison was cut short: " + comparison->cut_short;
  }
  if (result.quality && !result.quality->cut_short.empty())
    return "the assessment was cut short: " + result.quality->cut_short;
  return "";
}

std::string failureOf(const FittedStreams& fitted) {
  const StreamResult& streams = fitted.result;
  if (!fitted.refusal.empty() || streams.success()) return fitted.refusal;
  return "the calibration of the IMU failed: " +
         (streams.undetermined.empty() ? streams.message : streams.undetermined);
}

/// Returns the fit of the IMUs, or why their readings cannot be used: the result of the cameras stands without them.
template <class Fit>
FittedStreams fittedOrRefused(const CommandSettings& settings, const Fit& fit) {
  try {
    return fit();
  } catch (const DataError& error) {
    FittedStreams refused;
    refused.refusal = inWordsOfOptions(settings, error);
    refused.verdict.sentence = "There are no values of the IMU. " + refused.refusal + ".";
    return refused;
  }
}

/// Prints what was found about the cameras, and about the IMUs if there are any.
void sayResults(const Result& result, const std::optional<FittedStreams>& streams) {
  say(reportText(result, streams ? "verdict on the cameras" : "verdict"));
  if (!streams) return;
  if (streams->refusal.empty()) say(streamLines(streams->result, result.cameras.front().name));
  if (streams->agreement) say(agreementLines(*streams->agreement));
  say(verdictText("verdict on the IMU", streams->verdict));
}

/// Refuses words that belong to no option. If one of them is a file, it most often belongs to a camera.
void refuseExtras(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (words.empty()) return;
  std::error_code ignored;
  if (words.size() == 1 && std::filesystem::is_regular_file(words.front(), ignored)) {
    throw UserError(fmt::format(
        "{0}: the file belongs to no camera; pass --camera NAME={0} for corners, or --images NAME={0} for "
        "photographs",
        words.front()));
  }
  throw CLI::ExtrasError(command.get_name(),
                         {words.rbegin(), words.rend()});  // CLI11 lists them from the last on
}

void run(const RawOptions& raw) {
  CommandSettings settings = parseSettings(raw);
  // Until the data are read, there is nothing to write, so Ctrl-C ends the program.
  FitLimits limits(settings.limits.max_seconds, FitLimits::Interrupts::end_the_program);
  settings.limits = limitsOf(limits);
  if (settings.board) requireResultsWritable(settings);  // before the search for boards, which takes long
  if (settings.model_is_given) requireModelOf(settings);
  ImageNumbers numbers;
  Dataset data = readInTime(settings, numbers);
  requireImageSizes(settings, data.cameras);
  requireResultsWritable(settings);
  limits.catchInterrupts();
  if (!settings.quiet) say(dataText(data));
  for (const std::string& file : settings.quiet ? std::vector<std::string>() : cornerFiles(settings))
    say(fmt::format("written: {}\n", oneLine(file)));
  const std::vector<ImuStream> imus = inWordsOfOptions(settings, [&] { return readImuStreams(settings); });
  std::optional<StreamResult> moving;
  if (settings.cameras_move)
    moving = inWordsOfOptions(settings, [&] { return fitMovingCameras(data, settings, imus); });
  Result result = inWordsOfOptions(
      settings, [&] { return calibrateByChoice(data, settings, choicesOf(settings), progressOf(settings)); });
  if (result.comparison) result.comparison = inWordsOfOptions(settings, *result.comparison);
  std::optional<FittedStreams> streams;
  const bool has_streams = !imus.empty() && result.success();
  // Assessment and IMUs need the cameras' result, but not each other.
  std::future<std::optional<Quality>> quality =
      std::async(has_streams ? std::launch::async : std::launch::deferred,
                 [&] { return assessed(data, settings, result); });
  if (has_streams)
    streams = fittedOrRefused(settings, [&] {
      return moving ? comparedStreams(std::move(*moving), data, settings, result, imus)
                    : fitStreams(data, settings, result, imus);
    });
  result.quality = quality.get();
  if (streams && streams->refusal.empty())
    streams->verdict = verdictOf(streams->result, result, streams->agreement);
  if (!settings.quiet) sayResults(result, streams);
  writeFiles(data, result, streams, settings, numbers);
  std::string failure = failureOf(result);
  const bool is_refusal = failure.empty() && streams && !streams->refusal.empty();
  if (failure.empty() && streams) failure = failureOf(*streams);
  if (failure.empty()) return;
  if (!imus.empty() && !result.strays.empty() && !settings.stream.camera_offsets && result.cameras.size() > 1)
    failure += "; if the cameras are not synchronised, add --camera-offsets";
  sayError(fmt::format("slom: {}\n", oneLine(failure)));
  throw CLI::RuntimeError(is_refusal ? exit_user_error : exit_not_converged);
}

}  // namespace
}  // namespace calib

void addCalibrateCommand(CLI::App& app) {
  using namespace calib;
  const auto raw = std::make_shared<RawOptions>();
  CLI::App& command = *app.add_subcommand("calibrate");
  CLI::Option* const compare = addOptions(command, *raw);
  command.callback([raw, compare, &command] {
    refuseExtras(command);
    raw->compare = compare->count() > 0;
    run(*raw);
  });
}

}  // namespace slom::app
