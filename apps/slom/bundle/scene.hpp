// Bundle adjustments in the library's types, with cameras and observations.
#pragma once

#include <slom/io/scene.hpp>

namespace slom::app::bundle {

using io::Camera;
using io::Observation;
using io::Scene;

}  // namespace slom::app::bundle
