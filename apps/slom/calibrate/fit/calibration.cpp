#include "calibrate/fit/calibration.hpp"

#include <stdexcept>

#include "calibrate/camera_models.hpp"
#include "calibrate/input/check.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

/// f<Camera>() for the camera type of a model.
template <class F>
Result withModel(Model model, const F& f) {
  switch (model) {
    case Model::radial1:
      return f.template operator()<Radial1<>>();
    case Model::opencv4:
      return f.template operator()<Opencv4<>>();
    case Model::opencv5:
      return f.template operator()<Opencv5<>>();
    case Model::opencv8:
      return f.template operator()<Opencv8<>>();
    case Model::fisheye:
      return f.template operator()<Fisheye<>>();
  }
  throw std::logic_error("slom calibrate: unknown model");
}

}  // namespace

std::string sentenceOf(const slom::Error& error) {
  const std::string text = withoutId(error);
  return text.substr(0, text.find_first_of(":;"));
}

Result calibrate(const Dataset& data, const Settings& settings, const Progress& progress) {
  checkDataset(data);
  return withModel(settings.model,
                   [&]<class Camera>() { return calibrateModel<Camera>(data, settings, progress); });
}

Result calibrateFrom(const Result& start, const Dataset& data, const Settings& settings) {
  checkConnected(data);
  return withModel(settings.model,
                   [&]<class Camera>() { return calibrateModelFrom<Camera>(start, data, settings); });
}

}  // namespace slom::app::calib
