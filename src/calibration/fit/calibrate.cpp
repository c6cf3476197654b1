#include "slom/calibration/calibrate.hpp"

#include "calibration/data/check.hpp"
#include "calibration/fit/joint_fit.hpp"
#include "calibration/limits.hpp"
#include "calibration/models/definition.hpp"

namespace slom::calibration {

std::string sentenceOf(const slom::Error& error) {
  const std::string text(error.sentence());
  return text.substr(0, text.find_first_of(":;"));
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
