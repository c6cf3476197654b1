// How far the hand turns, and what follows from that, in words.
#pragma once

#include <string>

#include <Eigen/Core>

#include "calibration/hand_eye/fit.hpp"

namespace slom::calibration {

/// Root mean square turns about principal axes, in the frame of the hand.
struct Turns {
  Eigen::Vector3d deg;
  Eigen::Matrix3d axes;
};

Turns turnsOf(const Streams& streams, const HandEyeSettings& settings, const Items& items, double shift);

/// Says what is free, why, and which motion is missing. `same_kind` is the number of free directions of its kind.
std::string textOf(const FreeDirection& free, int same_kind, const Turns& turns);

}  // namespace slom::calibration
