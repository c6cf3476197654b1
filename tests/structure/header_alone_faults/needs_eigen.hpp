#pragma once

inline Eigen::Vector2d origin() { return Eigen::Vector2d::Zero(); }
