/// Ready states, motions and measurements for filters. They are function objects over any number type, so the same objects
/// are measurement functions of an Estimator, too.
///   attitude.hpp         gyroscope, accelerometer, magnetometer
///   strapdown.hpp        inertial navigation; positions and velocities of GNSS, zero velocity, no sideslip
///   wheel_odometry.hpp   a robot in the plane
#pragma once

#include "slom/filter/models/attitude.hpp"
#include "slom/filter/models/strapdown.hpp"
#include "slom/filter/models/wheel_odometry.hpp"
