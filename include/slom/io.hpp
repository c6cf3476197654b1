/// Files of other programs, and what they hold in an estimator. An include and a library of its own: link slom::io.
#pragma once

#include "slom/io/bal.hpp"
#include "slom/io/g2o.hpp"
#include "slom/io/pose_graph_model.hpp"
#include "slom/io/scene_model.hpp"
