#include "slom/calibration/calibrate.hpp"

#include "calibration/data/check.hpp"
#include "calibration/fit/joint_fit.hpp"
#include "calibration/limits.hpp"
#include "calibration/models/definition.hpp"

namespace slom::calibration {

std::string sentenceOf(const slom::Error& error) {
  const bool names_unknown = error.id() == "slom.rank-deficient" && !error.subject().empty();
  return names_unknown ? "the measurements do not determine " + error.subject() : std::string(error.fault());
}

Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress) {
  checkSettings(data, settings);
  checkDataset(data);
  return settings.model.definition().calibrate(data, started(settings), progress);
}

Result calibrateFrom(const Result& start, const Dataset& data, const Settings& settings) {
  checkConnected(data);
  return settings.model.definition().calibrate_from(start, data, settings);
}

}  // namespace slom::calibration
