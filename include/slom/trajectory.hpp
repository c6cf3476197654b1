/// Trajectories in continuous time: B-splines whose control points are variables, Gaussian processes whose states are,
/// and functions of time for measurements.
///
///     slom::trajectory::PoseSpline<4> pose(slom::trajectory::Knots(0, 0.1), "pose");
///     pose.extend(est, 0, 60);
///     slom::trajectory::insertMeasurement(est, gyro, pose.around(stamp, offset), offset, stamp, ...);
///     slom::trajectory::optimize(est, {pose});
#pragma once

#include "slom/trajectory/blending.hpp"
#include "slom/trajectory/gaussian_process.hpp"
#include "slom/trajectory/knots.hpp"
#include "slom/trajectory/measurement.hpp"
#include "slom/trajectory/motion_prior.hpp"
#include "slom/trajectory/pose_segment.hpp"
#include "slom/trajectory/rotation_segment.hpp"
#include "slom/trajectory/screw_segment.hpp"
#include "slom/trajectory/spline.hpp"
#include "slom/trajectory/vector_segment.hpp"
