/// Ready measurement functions. They have no state and predict a datum, marked by slom::measured. If the arguments
/// allow it, several measurements are evaluated at a time.
///     est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(odometry), slom::Covariance(sigma));
/// To make a variable a constant, pass the value in place of the VarID.
#pragma once

#include "slom/measurements/bearing.hpp"
#include "slom/measurements/gaussian_prior.hpp"
#include "slom/measurements/gravity.hpp"
#include "slom/measurements/imu_model.hpp"
#include "slom/measurements/imu_samples.hpp"
#include "slom/measurements/intrinsics.hpp"
#include "slom/measurements/landmark.hpp"
#include "slom/measurements/preintegration.hpp"
#include "slom/measurements/prior.hpp"
#include "slom/measurements/projection.hpp"
#include "slom/measurements/range.hpp"
#include "slom/measurements/relative_pose.hpp"
#include "slom/measurements/surveying.hpp"
