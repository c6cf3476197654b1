/// PoseGraphModel: conversion of a pose graph of a file to variables and measurements of an estimator.
#pragma once

#include <string>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/io/absolute_errors.hpp"
#include "slom/io/pose_graph.hpp"
#include "slom/io/quaternion_error.hpp"
#include "slom/measurements/bearing.hpp"
#include "slom/measurements/landmark.hpp"
#include "slom/measurements/relative_pose.hpp"

namespace slom::io {

/// Meaning of the three rotational components of an edge's error in space.
enum class RotationError {
  vector,     ///< the rotation vector, axis times angle [rad]
  quaternion  ///< the vector part of the unit quaternion with w >= 0, as in g2o
};

namespace detail {

/// Returns the information of an edge in the frame of a. The file's translation error is R_z^T (t_ab - t_z) of z^-1
/// (a^-1 b), in the frame where z puts b. slom::RelativePoseInFrameOfA has the error t_ab - t_z, in the frame of a. So
/// its information is that of the file, rotated to a's frame: B^T I B with B = diag(R_z^T, 1).
template <class Pose>
Symmetric<dof<Pose>> informationFromA(const Edge<Pose>& edge) {
  constexpr int n = dim<Pose>, m = dof<Pose> - n;
  const auto& I = edge.information;
  const double first = I(0, 0);
  const bool is_round = I.template topLeftCorner<n, n>().isApprox(first * Symmetric<n>::Identity(), 0) &&
                        I.template topRightCorner<n, m>().isZero(0);
  if (is_round) return I;  // and has the cheapest form
  const Symmetric<n> R = edge.measured.orient.toRotationMatrix();
  Symmetric<dof<Pose>> turned = I;
  turned.template topLeftCorner<n, n>() = R * I.template topLeftCorner<n, n>() * R.transpose();
  turned.template topRightCorner<n, m>() = R * I.template topRightCorner<n, m>();
  turned.template bottomLeftCorner<m, n>() = turned.template topRightCorner<n, m>().transpose();
  return turned;
}

/// Calls f with a vector for a diagonal information, and with a matrix for any other one.
template <int N, class F>
void withInformation(const Symmetric<N>& information, F f) {
  if (information.isDiagonal(0)) {
    f(InvCovariance(Eigen::Matrix<double, N, 1>(information.diagonal())));
  } else {
    f(InvCovariance(information));
  }
}

template <class Value>
std::vector<VarID<Value>> insertNodes(Estimator& est, const std::vector<Node<Value>>& nodes,
                                      const char* kind) {
  std::vector<VarID<Value>> ids;
  ids.reserve(nodes.size());
  for (const Node<Value>& node : nodes)
    ids.push_back(est.insertRV(node.value, !node.fixed, kind + std::to_string(node.id)));
  return ids;
}

}  // namespace detail

/// Inserts the measurements of a graph, named `edge`, `sighting`, `bearing` and `prior`. The functions of
/// slom/initialize.hpp accept it as their model.
///   residual of an edge      z^-1 (a^-1 b): its translation, then its rotation as RotationError says
///   residual of a sighting   a^-1 p - z
///   residual of a bearing    angle of a^-1 p - z, from -pi to pi
///   residual of a prior      of a pose: z^-1 (x o) with the sensor's place o on the robot, in the form of an edge's
///                            of a position: position - z
/// Residuals are whitened by W with W^T W = information, so the RSS is the sum of e^T information e.
struct PoseGraphModel {
  Loss loss = {};  ///< loss of all measurements
  RotationError rotation_error = RotationError::vector;

  /// Does nothing, because the model's measurements share no variables.
  void prepare(Estimator&) const {}
  /// Inserts the measurement of an edge between two poses.
  template <class Pose>
  void insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b, const Edge<Pose>& edge) const {
    detail::withInformation(detail::informationFromA(edge), [&](const auto& noise) {
      if constexpr (dim<Pose> == 3) {
        if (rotation_error == RotationError::quaternion) {
          est.insertMeasurement(QuaternionError(), a, b, edge.measured, noise, loss, named("edge"));
          return;
        }
      }
      est.insertMeasurement(RelativePoseInFrameOfA(), a, b, measured(edge.measured), noise, loss,
                            named("edge"));
    });
  }
  /// Inserts the measurement of a landmark from a pose.
  template <class Pose>
  void insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point<Pose>>& p,
                      const Edge<Point<Pose>>& sighting) const {
    detail::withInformation(sighting.information, [&](const auto& noise) {
      est.insertMeasurement(Landmark(), a, p, measured(sighting.measured), noise, loss, named("sighting"));
    });
  }
  /// Inserts the priors and bearings of a graph whose variables exist.
  template <class Pose>
  void insertOthers(Estimator& est, const PoseGraph<Pose>& graph, const std::vector<VarID<Pose>>& poses,
                    const std::vector<VarID<Point<Pose>>>& landmarks) const {
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    for (const PosePrior<Pose>& prior : graph.pose_priors) {
      if (poses[at(prior.pose)].isValid())
        insertPrior(est, poses[at(prior.pose)], graph.offsetOf(prior), prior);
    }
    for (const PositionPrior<Pose>& prior : graph.position_priors) {
      detail::withInformation(prior.information, [&](const auto& noise) {
        if (poses[at(prior.pose)].isValid())
          est.insertMeasurement(PositionPriorError(), poses[at(prior.pose)], measured(prior.measured), noise,
                                loss, named("position prior"));
      });
    }
    if constexpr (dim<Pose> == 2) {
      for (const Edge<mtk::SO2<>>& bearing : graph.bearings) {
        const auto& a = poses[at(bearing.from)];
        const auto& p = landmarks[at(bearing.to)];
        if (!a.isValid() || !p.isValid()) continue;
        detail::withInformation(bearing.information, [&](const auto& noise) {
          est.insertMeasurement(Bearing(), a, p, measured(bearing.measured), noise, loss, named("bearing"));
        });
      }
    }
  }

 private:
  template <class Pose>
  void insertPrior(Estimator& est, const VarID<Pose>& x, const Pose& offset,
                   const PosePrior<Pose>& prior) const {
    detail::withInformation(prior.information, [&](const auto& noise) {
      if constexpr (dim<Pose> == 3) {
        if (rotation_error == RotationError::quaternion) {
          est.insertMeasurement(PosePriorQuaternionError(), x, offset, prior.measured, noise, loss,
                                named("prior"));
          return;
        }
      }
      est.insertMeasurement(PosePriorError(), x, offset, measured(prior.measured), noise, loss,
                            named("prior"));
    });
  }
};

/// The variables of a graph, in the order of its nodes.
template <class Pose>
struct PoseGraphVariables {
  std::vector<VarID<Pose>> poses;
  std::vector<VarID<Point<Pose>>> landmarks;

  /// Writes the values of the variables into the nodes of the graph.
  void writeTo(PoseGraph<Pose>& graph) const {
    for (std::size_t i = 0; i < poses.size(); ++i) graph.poses[i].value = *poses[i];
    for (std::size_t i = 0; i < landmarks.size(); ++i) graph.landmarks[i].value = *landmarks[i];
  }
};

/// Inserts all poses and landmarks with their values, and all edges, sightings, bearings and priors. Variables are
/// named by their ids (`pose 17`, `landmark 3`), and fixed if `fixed` says so. If a model has no insertOthers, that of
/// PoseGraphModel inserts bearings and priors. Throws the errors of Estimator::insertMeasurement, for example for an
/// information that is not positive definite. If nothing is fixed, the map can float. To fix a pose, set
/// `graph.poses[0].fixed = true`.
template <class Pose, class Model = PoseGraphModel>
PoseGraphVariables<Pose> insert(Estimator& est, const PoseGraph<Pose>& graph, const Model& model = {}) {
  PoseGraphVariables<Pose> ids{detail::insertNodes(est, graph.poses, "pose "),
                               detail::insertNodes(est, graph.landmarks, "landmark ")};
  const auto pose = [&](int i) -> const VarID<Pose>& { return ids.poses[static_cast<std::size_t>(i)]; };
  for (const auto& edge : graph.edges) model.insertEdge(est, pose(edge.from), pose(edge.to), edge);
  for (const auto& sighting : graph.sightings) {
    model.insertSighting(est, pose(sighting.from), ids.landmarks[static_cast<std::size_t>(sighting.to)],
                         sighting);
  }
  if constexpr (requires { model.insertOthers(est, graph, ids.poses, ids.landmarks); }) {
    model.insertOthers(est, graph, ids.poses, ids.landmarks);
  } else {
    PoseGraphModel{}.insertOthers(est, graph, ids.poses, ids.landmarks);
  }
  return ids;
}

}  // namespace slom::io
