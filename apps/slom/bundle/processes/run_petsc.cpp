#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <slom/distributed.hpp>
#include <slom/io/bal.hpp>
#include <slom/io/scene_model.hpp>

#include "bundle/check.hpp"
#include "bundle/checkpoint.hpp"
#include "bundle/fit/fit.hpp"
#include "bundle/fit/free_directions.hpp"
#include "bundle/output/output.hpp"
#include "bundle/output/report.hpp"
#include "bundle/processes/run.hpp"
#include "fitting/checkpoints.hpp"
#include "fitting/fit_limits.hpp"
#include "fitting/on_processes.hpp"
#include "fitting/progress.hpp"
#include "fitting/result_files.hpp"
#include "fitting/words.hpp"
#include "output_files.hpp"

namespace slom::app::bundle {

namespace {

using distributed::PetscSolver;
using distributed::Processes;
using distributed::ScenePart;

/// The variables and observations of a part, named by their numbers in the file.
struct PartFit {
  PartFit(const ScenePart& part, const FitOptions& options) {
    prepare(options, est);
    const io::Scene& scene = part.scene;
    for (std::size_t i = 0; i < part.cameras.size(); ++i)
      variables.cameras.push_back(est.insertRV(scene.cameras[i], fmt::format("camera {}", part.cameras[i])));
    for (std::size_t i = 0; i < part.points.size(); ++i)
      variables.points.push_back(est.insertRV(scene.points[i], fmt::format("point {}", part.points[i])));
    io::insertObservations(est, scene, variables, options.loss);
  }
  /// Names the cameras: other processes may have the same ones.
  distributed::SharedVariables shared(const ScenePart& part) const {
    distributed::SharedVariables result;
    for (std::size_t i = 0; i < part.cameras.size(); ++i)
      result.share(est, variables.cameras[i], std::uint64_t(part.cameras[i]), part.own_cameras[i] != 0);
    return result;
  }

  Estimator est;
  io::SceneVariables variables;
};

double rmsOf(const Processes& processes, const ScenePart& part) {
  return std::sqrt(processes.sum(part.scene.sumOfSquares()) / double(part.observation_count));
}

SceneNumbers numbersOf(const ScenePart& part) {
  return {part.cameras, part.points, part.camera_count, part.point_count, part.observation_count};
}

/// Returns, by place, whether the camera belongs to this process.
std::vector<char> ownCameras(const PetscSolver& solver, const PartFit& fit) {
  std::vector<char> own;
  for (const auto& camera : fit.variables.cameras) own.push_back(solver.isOwn(camera) ? 1 : 0);
  return own;
}

/// The text of the fitted scene, which process 0 gets in pieces.
class SceneGatherer {
 public:
  SceneGatherer(const Processes& processes, const ScenePart& part, const std::vector<char>& is_camera_own)
      : processes_(processes), part_(part) {
    for (std::size_t i = 0; i < is_camera_own.size(); ++i) {
      if (is_camera_own[i] != 0) own_cameras_.push_back(i);
    }
  }

  void gather(Format format, const distributed::TextSink& f) const {
    const auto cameras = std::size_t(part_.camera_count), points = std::size_t(part_.point_count);
    std::string head;
    if (format == Format::ply) {
      appendPlyHead(head, points, cameras);
      say(head, f);
      gatherPoints([](std::string& text, const auto& point) { appendPly(text, point); }, f);
      gatherCameras([](std::string& text, const auto& camera) { appendPly(text, camera); }, f);
    } else {
      io::appendBalCounts(head, cameras, points, std::size_t(part_.observation_count));
      say(head, f);
      gatherObservations(f);
      gatherCameras([](std::string& text, const auto& camera) { io::appendBal(text, camera); }, f);
      gatherPoints([](std::string& text, const auto& point) { io::appendBal(text, point); }, f);
    }
  }

 private:
  void say(const std::string& head, const distributed::TextSink& f) const {
    processes_.agree([&] {
      if (processes_.rank() == 0) f(head);
    });
  }
  void gatherObservations(const distributed::TextSink& f) const {
    const auto append = [&](std::size_t i, std::string& text) {
      Observation o = part_.scene.observations[i];
      o.camera = part_.cameras[std::size_t(o.camera)];
      o.point = part_.points[std::size_t(o.point)];
      io::appendBal(text, o);
    };
    distributed::gatherInOrder(
        processes_, part_.observation_count,
        {part_.observations.size(), [&](std::size_t i) { return part_.observations[i]; }, append}, f);
  }
  template <class Append>
  void gatherCameras(const Append& append, const distributed::TextSink& f) const {
    distributed::gatherInOrder(
        processes_, part_.camera_count,
        {own_cameras_.size(), [&](std::size_t i) { return std::int64_t(part_.cameras[own_cameras_[i]]); },
         [&](std::size_t i, std::string& text) { append(text, part_.scene.cameras[own_cameras_[i]]); }},
        f);
  }
  template <class Append>
  void gatherPoints(const Append& append, const distributed::TextSink& f) const {
    distributed::gatherInOrder(
        processes_, part_.point_count,
        {part_.points.size(), [&](std::size_t i) { return std::int64_t(part_.points[i]); },
         [&](std::size_t i, std::string& text) { append(text, part_.scene.points[i]); }},
        f);
  }

  const Processes& processes_;
  const ScenePart& part_;
  std::vector<std::size_t> own_cameras_;  // places
};

void requireWritableResults(const Processes& processes, const Settings& settings) {
  processes.agree([&] {
    std::vector<std::string> results = settings.output_files;
    results.push_back(settings.report.jsonPath());
    if (processes.rank() == 0) requireWritable(results);
  });
}

void writeScene(const Processes& processes, const Settings& settings, const SceneGatherer& scene,
                ResultFiles& files) {
  for (const std::string& file : settings.output_files) {
    writeInPieces(processes, files, file,
                  [&](const distributed::TextSink& f) { scene.gather(formatOf(file), f); });
  }
}

void run(const Processes& processes, const Settings& settings, const Stopwatch& total) {
  ScenePart part = distributed::readScene(processes, settings.file);
  const ReportOptions report_options = onThisProcess(processes, settings.report);
  const Console console(report_options);
  requireWritableResults(processes, settings);
  const SceneNumbers numbers = numbersOf(part);
  const auto checkpointIn = [&](const std::string& folder) {
    return distributed::Checkpoint(processes, folder, problemOf(part.scene, numbers));
  };
  if (!settings.checkpoint.resume_from.empty())
    takeValues(checkpointIn(settings.checkpoint.resume_from), numbers, part.scene);
  distributed::Checkpoint checkpoint = checkpointIn(settings.checkpoint.write_to);
  if (!settings.checkpoint.write_to.empty()) checkpoint.requireWritable();
  const SceneCheck check = checkScene(part.scene, numbers, processes);
  RunReport report;
  report.warnings = check.warnings;
  const FitOptions options = onThisProcess(settings.fit);
  report.threads = threadsOf(options);
  const double rms_before = rmsOf(processes, part);
  report.load_seconds = total.seconds();
  console.print(sceneText(part.scene.file, numbers, check));
  const FitLimits limits(settings.fit.max_seconds);
  const Stopwatch setup;
  std::unique_ptr<PartFit> fit;
  const PetscSolver* solver = nullptr;
  processes.agree([&] {
    fit = std::make_unique<PartFit>(part, options);
    auto petsc = std::make_unique<PetscSolver>(fit->est, fit->shared(part), petscOptionsOf(settings.fit));
    solver = petsc.get();
    fit->est.changeSolver(std::move(petsc));
  });
  report.setup_seconds = setup.seconds();
  Options fit_options = optionsOf(settings, console);
  CheckpointClock clock(settings.checkpoint, processes, [&] {
    checkpoint.write(
        valuesOf(fit->variables.cameras, fit->variables.points, numbers, ownCameras(*solver, *fit)));
  });
  clock.follow(fit_options);
  report.summary = fit->est.optimize(fit_options);
  clock.finish();
  FitLimits::nameIn(report.summary);
  putIntoWordsOfTheCommand(report.summary);
  fit->variables.writeTo(part.scene);
  report.free_directions = similarity * check.parts + int(check.points_seen_once);  // at least
  report.has_all_free_directions = false;
  report.total_seconds = total.seconds();
  const double rms_after = rmsOf(processes, part);
  console.print(outcomeText(outcomeOf(report)) + rmsText(rms_before, rms_after) +
                fmt::format("  solver: {}\n", report.summary.solver) + processesText(processes));
  if (std::string text = behindText(part.scene, numbers, processes); !text.empty())
    report.summary.warnings.push_back(std::move(text));
  for (std::string& warning : unusedOptionsTexts()) report.summary.warnings.push_back(std::move(warning));
  for (const std::string& warning : report.summary.warnings) console.print("  warning: " + warning + "\n");
  ResultFiles files(report, report_options);
  writeScene(processes, settings, SceneGatherer(processes, part, ownCameras(*solver, *fit)), files);
  processes.agree([&] {
    if (processes.rank() == 0) files.finish(console);
  });
  requireConvergedOnProcesses(processes, report, dominantText(part.scene, numbers, processes));
}

}  // namespace

void runOnProcesses(const Settings& settings, const Stopwatch& total) {
  onProcesses([&](const Processes& processes) {
    processes.agree([&] { petscOptionsOf(settings.fit); });
    run(processes, settings, total);
  });
}

}  // namespace slom::app::bundle
