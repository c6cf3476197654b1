// Bundle adjustments as the library reads them, and their parts.
#pragma once

#include <slom/io/scene.hpp>

namespace slom::app::bundle {

using io::Camera;
using io::Observation;
using io::Scene;

}  // namespace slom::app::bundle
