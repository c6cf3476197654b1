// --lenses: lenses that are known, from files of other programs.
#pragma once

#include <string>
#include <vector>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Holds the lenses of cameras at those of files: `FILE`, Kalibr's camchain, for the cameras in their order; or
/// `NAME=FILE`, the lens of one camera. Sets the model, unless --intrinsics names it, and the sizes of images that are not
/// given. Throws UserError.
void holdLenses(const std::vector<std::string>& texts, const std::string& intrinsics,
                CommandSettings& settings);

}  // namespace slom::app::calib
