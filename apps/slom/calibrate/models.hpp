// The camera models by name; camera_models.hpp says what they compute.
#pragma once

#include <string>
#include <vector>

namespace slom::app::calib {

enum class Model { radial1, opencv4, opencv5, opencv8, fisheye };

/// All of them, by rising number of parameters.
inline constexpr Model all_models[] = {Model::radial1, Model::opencv4, Model::fisheye, Model::opencv5,
                                       Model::opencv8};

const char* toString(Model model);

/// Their names, in the model's order.
std::vector<std::string> parametersOf(Model model);

/// UserError, beginning with the option, when there is no such model.
Model parseModel(const std::string& option, const std::string& name);

}  // namespace slom::app::calib
