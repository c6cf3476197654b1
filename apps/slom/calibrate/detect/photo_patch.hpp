// The part of a photograph around a corner, for the report page.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// Returns the pixels within `radius` of `pixel` in grey levels, each drawn as `scale` x `scale` pixels, as a data
/// URI of a PNG image. The middle of the picture is the pixel that contains `pixel`. Beyond the border of the
/// photograph, the patch is black. Returns an empty text if the photograph cannot be read, or if this program was
/// built without a reader of photographs.
std::string photoPatch(const std::string& photo, const vec2& pixel, int radius = 15, int scale = 6);

}  // namespace slom::app::calib
