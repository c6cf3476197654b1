/// The Manifold ToolKit: all of namespace mtk except mtk::testing (mtk/testing/axioms.hpp, mtk/testing/random.hpp).
#pragma once

#include "mtk/build_manifold.hpp"
#include "mtk/error.hpp"
#include "mtk/manifold.hpp"
#include "mtk/statistics.hpp"
#include "mtk/stream.hpp"
#include "mtk/types/s2.hpp"
#include "mtk/types/scalar.hpp"
#include "mtk/types/so2.hpp"
#include "mtk/types/so3.hpp"
#include "mtk/types/trafo.hpp"
#include "mtk/types/vect.hpp"
#include "mtk/vectview.hpp"
