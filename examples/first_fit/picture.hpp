#pragma once
#include <string>
#include <vector>

#include <slom/slom.hpp>

/// The distance that an anchor measured [m].
struct Reading {
  std::string anchor_name;
  Eigen::Vector2d anchor;
  double distance;
};

/// Returns an SVG with
///   anchors  with circles of the measured distances, dashed if they contradict the others
///   tag      as fitted with and without a loss
///   ellipse  that contains the tag with a probability of 95 %, by `covariance`, that of the fit with a loss; 20 times
///            enlarged
std::string picture(const std::vector<Reading>& readings, const Eigen::Vector2d& plain,
                    const Eigen::Vector2d& robust, const Eigen::Matrix2d& covariance);
