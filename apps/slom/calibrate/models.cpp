#include "calibrate/models.hpp"

#include <fmt/format.h>

#include "calibrate/camera_models.hpp"
#include "error.hpp"

namespace slom::app::calib {
namespace {

template <class Camera>
std::vector<std::string> namesOf() {
  return {Camera::component_names.begin(), Camera::component_names.end()};
}

}  // namespace

const char* toString(Model model) {
  switch (model) {
    case Model::radial1:
      return "radial1";
    case Model::opencv4:
      return "opencv4";
    case Model::opencv5:
      return "opencv5";
    case Model::opencv8:
      return "opencv8";
    case Model::fisheye:
      return "fisheye";
  }
  return "";
}

std::vector<std::string> parametersOf(Model model) {
  switch (model) {
    case Model::radial1:
      return namesOf<Radial1<>>();
    case Model::opencv4:
      return namesOf<Opencv4<>>();
    case Model::opencv5:
      return namesOf<Opencv5<>>();
    case Model::opencv8:
      return namesOf<Opencv8<>>();
    case Model::fisheye:
      return namesOf<Fisheye<>>();
  }
  return {};
}

Model parseModel(const std::string& option, const std::string& name) {
  for (const Model model : all_models) {
    if (name == toString(model)) return model;
  }
  throw UserError(
      fmt::format("{} {}: the models are opencv4, opencv5, opencv8, fisheye and radial1", option, name));
}

}  // namespace slom::app::calib
