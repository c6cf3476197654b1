#pragma once
#include <string>
#include <vector>

#include <slom/slom.hpp>

/// The distance that an anchor has measured [m].
struct Reading {
  std::string anchor_name;
  Eigen::Vector2d anchor;
  double distance;
};

/// An SVG: anchors with circles of the measured distances, dashed where they contradict the others, the tag as fitted with and without a loss, and the ellipse that holds it with a
/// probability of 95 %, by the covariance of the former, 20 times as large.
std::string picture(const std::vector<Reading>& readings, const Eigen::Vector2d& plain,
                    const Eigen::Vector2d& robust, const Eigen::Matrix2d& covariance);
