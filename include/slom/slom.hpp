/// Everything a user of SLoM needs: mtk and the estimator.
#pragma once

#include "mtk/mtk.hpp"
#include "slom/estimator.hpp"
#include "slom/model/loss.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/noise.hpp"
#include "slom/solve/block_qr.hpp"
#include "slom/solve/block_solver.hpp"
#include "slom/solve/cholmod.hpp"
#include "slom/solve/dense_qr.hpp"
#include "slom/version.hpp"
