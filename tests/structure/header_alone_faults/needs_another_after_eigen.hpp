#pragma once

#include <Eigen/Core>

inline std::deque<Eigen::Vector2d> corners() { return {Eigen::Vector2d::Zero()}; }
