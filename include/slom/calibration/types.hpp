/// The manifolds of the calibration.
#pragma once

#include <mtk/mtk.hpp>

#include "mtk/detail/cpp20.hpp"

namespace slom::calibration {

using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;
using SO3 = mtk::SO3<>;
using SE3 = mtk::trafo<SO3>;

}  // namespace slom::calibration
