// A dense fit of a pose graph, written out without the project's code.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "graph/oracle.hpp"

namespace slom::app::graph::testing {

/// Returns the smallest RSS that damped Gauss-Newton steps with numeric derivatives find from the values of `graph`.
/// Fixed nodes stay.
template <class Pose>
double leastRss(PoseGraph<Pose> graph, bool quaternion = false) {
  constexpr double h = 1e-6;
  const auto residuals = [&] {
    std::vector<double> all;
    const auto append = [&](const auto& error, const auto& information) {
      const Eigen::VectorXd white = Eigen::MatrixXd(information).llt().matrixU() * Eigen::VectorXd(error);
      all.insert(all.end(), white.begin(), white.end());
    };
    const auto pose = [&](int i) { return transform(graph.poses[std::size_t(i)].value); };
    for (const auto& edge : graph.edges) {
      append(errorOf(transform(edge.measured).inverse() * (pose(edge.from).inverse() * pose(edge.to)),
                     quaternion),
             edge.information);
    }
    for (std::size_t i = 0; i < graph.sightings.size(); ++i) {
      const auto& sighting = graph.sightings[i];
      const Eigen::Matrix<double, dim<Pose>, 1> point = graph.landmarks[std::size_t(sighting.to)].value;
      const auto sensed = graph.as_sensed.find(i);
      if (sensed == graph.as_sensed.end()) {
        append(Eigen::Matrix<double, dim<Pose>, 1>(pose(sighting.from).inverse() * point - sighting.measured),
               sighting.information);
        continue;
      }
      const auto sensor =
          pose(sighting.from) * transform(graph.sensors[std::size_t(sensed->second.from)].offset);
      append(Eigen::Matrix<double, dim<Pose>, 1>(sensor.inverse() * point - sensed->second.measured),
             sensed->second.information);
    }
    for (const auto& bearing : graph.bearings) {
      if constexpr (dim<Pose> == 2) {
        const Eigen::Vector2d seen =
            pose(bearing.from).inverse() * Eigen::Vector2d(graph.landmarks[std::size_t(bearing.to)].value);
        const double angle = std::atan2(seen[1], seen[0]) - bearing.measured.angle();
        append(Eigen::Matrix<double, 1, 1>(std::remainder(angle, 2 * M_PI)), bearing.information);
      }
    }
    for (const auto& prior : graph.pose_priors) {
      auto offset = transform(Pose());
      if (prior.sensor >= 0) offset = transform(graph.sensors[std::size_t(prior.sensor)].offset);
      append(errorOf(transform(prior.measured).inverse() * (pose(prior.pose) * offset), quaternion),
             prior.information);
    }
    for (const auto& prior : graph.position_priors)
      append(Eigen::Matrix<double, dim<Pose>, 1>(pose(prior.pose).translation() - prior.measured),
             prior.information);
    return Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(all.data(), Eigen::Index(all.size())));
  };
  std::vector<std::function<void(double)>> moves;  // of one unknown each
  const auto collect = [&](auto& nodes) {
    for (auto& node : nodes) {
      if (node.fixed) continue;
      using Value = decltype(node.value);
      for (int i = 0; i < mtk::DOF_v<Value>; ++i) {
        moves.push_back([&node, i](double d) {
          Eigen::Matrix<double, mtk::DOF_v<Value>, 1> delta;
          delta.setZero();
          delta[i] = d;
          mtk::boxplus(node.value, delta);
        });
      }
    }
  };
  collect(graph.poses);
  collect(graph.landmarks);
  const auto n = Eigen::Index(moves.size());
  double damping = 1e-3;
  for (int iteration = 0; iteration < 200 && damping < 1e12; ++iteration) {
    const Eigen::VectorXd r = residuals();
    Eigen::MatrixXd J(r.size(), n);
    for (Eigen::Index k = 0; k < n; ++k) {
      auto& move = moves[std::size_t(k)];
      move(h);
      const Eigen::VectorXd after = residuals();
      move(-2 * h);
      J.col(k) = (after - residuals()) / (2 * h);
      move(h);
    }
    Eigen::MatrixXd H = J.transpose() * J;
    H.diagonal() *= 1 + damping;
    H.diagonal().array() += 1e-12;
    const Eigen::VectorXd d = -H.ldlt().solve(J.transpose() * r);
    const PoseGraph<Pose> before = graph;
    for (Eigen::Index k = 0; k < n; ++k) moves[std::size_t(k)](d[k]);
    const double decrease = 1 - residuals().squaredNorm() / r.squaredNorm();
    if (std::abs(decrease) < 1e-11) break;
    if (decrease > 0) {
      damping /= 10;
      continue;
    }
    for (std::size_t i = 0; i < graph.poses.size(); ++i) graph.poses[i].value = before.poses[i].value;
    for (std::size_t i = 0; i < graph.landmarks.size(); ++i)
      graph.landmarks[i].value = before.landmarks[i].value;
    damping *= 10;
  }
  return residuals().squaredNorm();
}

}  // namespace slom::app::graph::testing
