/// Files of other programs, and their content in an estimator. Include this header and link slom::io.
#pragma once

#include "slom/io/bal.hpp"
#include "slom/io/bal_part.hpp"
#include "slom/io/checkpoint.hpp"
#include "slom/io/container.hpp"
#include "slom/io/convert.hpp"
#include "slom/io/data_hash.hpp"
#include "slom/io/g2o.hpp"
#include "slom/io/pose_graph_model.hpp"
#include "slom/io/scene_model.hpp"
