#include "calibrate/fit/calibration.hpp"

#include <stdexcept>

#include "calibrate/camera_models.hpp"
#include "calibrate/input/check.hpp"

namespace slom::app::calib {

std::string sentenceOf(const slom::Error& error) {
  const std::string text = error.what();
  const std::size_t id_end = text.find("] ");
  const std::size_t begin = id_end == std::string::npos ? 0 : id_end + 2;
  return text.substr(begin, text.find_first_of(":;", begin) - begin);
}

Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress) {
  checkDataset(data);
  switch (settings.model) {
    case Model::radial1:
      return calibrateModel<Radial1<>>(data, settings, progress);
    case Model::opencv4:
      return calibrateModel<Opencv4<>>(data, settings, progress);
    case Model::opencv5:
      return calibrateModel<Opencv5<>>(data, settings, progress);
    case Model::opencv8:
      return calibrateModel<Opencv8<>>(data, settings, progress);
    case Model::fisheye:
      return calibrateModel<Fisheye<>>(data, settings, progress);
  }
  throw std::logic_error("slom calibrate: unknown model");
}

}  // namespace slom::app::calib
