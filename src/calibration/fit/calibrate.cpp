#include "slom/calibration/calibrate.hpp"

#include "calibration/data/check.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/well_formed.hpp"
#include "calibration/fit/rig_fit.hpp"
#include "calibration/limits.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/quality/clustered.hpp"

namespace slom::calibration {

std::string sentenceOf(const slom::Error& error) {
  const bool names_unknown = error.id() == "slom.rank-deficient" && !error.subject().empty();
  return names_unknown ? "the measurements do not determine " + error.subject() : std::string(error.fault());
}

Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress) {
  checkSettings(data, settings);
  requireWellFormed(data);
  const SortedDataset sorted(data);
  checkDataset(*sorted);
  Progress of_caller = progress;
  if (progress.single_camera) {
    of_caller.single_camera = [&](SingleCameraReport report) {
      report.camera = &sorted.ofCaller(*report.camera);
      progress.single_camera(report);
    };
  }
  Result result = settings.model.definition().calibrate(*sorted, started(settings), of_caller);
  addClustered(*sorted, result);
  return result;
}

Result calibrateFrom(const Result& start, const Dataset& data, const Settings& settings) {
  checkConnected(data);
  Result result = settings.model.definition().calibrate_from(start, data, settings);
  addClustered(data, result);
  return result;
}

}  // namespace slom::calibration
