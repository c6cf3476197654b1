/// Measurement kinds that come with the library: functions without state that predict a datum, marked by
/// slom::measured, and are evaluated several at a time wherever their arguments allow it.
///     est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(odometry), slom::Covariance(sigma));
/// Each variable may be a constant instead: pass the value in place of the VarID.
#pragma once

#include "slom/measurements/bearing.hpp"
#include "slom/measurements/gaussian_prior.hpp"
#include "slom/measurements/gravity.hpp"
#include "slom/measurements/intrinsics.hpp"
#include "slom/measurements/landmark.hpp"
#include "slom/measurements/prior.hpp"
#include "slom/measurements/projection.hpp"
#include "slom/measurements/range.hpp"
#include "slom/measurements/relative_pose.hpp"
#include "slom/measurements/surveying.hpp"
