// What a photograph shows around a corner, for pages that people look at.
#pragma once

#include <string>

#include "calibrate/library.hpp"

namespace slom::app::calib {

/// The pixels within `radius` of `pixel`, each drawn as `scale` x `scale` ones, as a data URI of a PNG image
/// in grey levels: the middle of the picture is the pixel that `pixel` lies in. Where the photograph ends,
/// the patch is black. Empty when the photograph cannot be read, or this program was built without what reads
/// photographs.
std::string photoPatch(const std::string& photo, const vec2& pixel, int radius = 15, int scale = 6);

}  // namespace slom::app::calib
