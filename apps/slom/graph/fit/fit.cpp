#include "graph/fit/fit.hpp"

#include <slom/measurements/landmark.hpp>
#include <slom/measurements/relative_pose.hpp>

#include "graph/fit/quaternion_error.hpp"

namespace slom::app::graph {

namespace {

/// slom::RelativePoseInFrameOfA has t_ab - t_z, seen from a, for the translation R_z^T (t_ab - t_z) of z^-1 (a^-1 b),
/// seen from where z puts b. So its information must be that of the file, turned to a's frame: B^T I B with B
/// = diag(R_z^T, 1).
template <class Pose>
Symmetric<dof<Pose>> informationFromA(const Edge<Pose>& edge) {
  constexpr int n = dim<Pose>, m = dof<Pose> - n;
  const auto& I = edge.information;
  const double first = I(0, 0);
  const bool is_round = I.template topLeftCorner<n, n>().isApprox(first * Symmetric<n>::Identity(), 0) &&
                        I.template topRightCorner<n, m>().isZero(0);
  if (is_round) return I;  // and stays as cheap as it is
  const Symmetric<n> R = edge.measured.orient.toRotationMatrix();
  Symmetric<dof<Pose>> turned = I;
  turned.template topLeftCorner<n, n>() = R * I.template topLeftCorner<n, n>() * R.transpose();
  turned.template topRightCorner<n, m>() = R * I.template topRightCorner<n, m>();
  turned.template bottomLeftCorner<m, n>() = turned.template topRightCorner<n, m>().transpose();
  return turned;
}

/// Calls f with a diagonal information as a vector, with any other one as a matrix.
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
    ids.push_back(est.insertRV(node.value, !node.held, kind + std::to_string(node.id)));
  return ids;
}

}  // namespace

template <class Pose>
GraphFit<Pose>::GraphFit(const PoseGraph<Pose>& graph, const Settings& settings)
    : poses_(insertNodes(est_, graph.poses, "pose ")),
      landmarks_(insertNodes(est_, graph.landmarks, "landmark ")) {
  apply(settings.fit, est_);
  for (const auto& edge : graph.edges) insertEdge(edge, settings);
  for (const auto& sighting : graph.sightings) insertSighting(sighting, settings.fit.loss);
}

template <class Pose>
void GraphFit<Pose>::insertEdge(const Edge<Pose>& edge, const Settings& settings) {
  const auto a = poses_[std::size_t(edge.from)], b = poses_[std::size_t(edge.to)];
  withInformation(informationFromA(edge), [&](const auto& noise) {
    if constexpr (dim<Pose> == 3) {
      if (settings.rotation_error == RotationError::quaternion) {
        est_.insertMeasurement(QuaternionError(), a, b, edge.measured, noise, settings.fit.loss,
                               named("edge"));
        return;
      }
    }
    est_.insertMeasurement(RelativePoseInFrameOfA(), a, b, measured(edge.measured), noise, settings.fit.loss,
                           named("edge"));
  });
}

template <class Pose>
void GraphFit<Pose>::insertSighting(const Edge<Point<Pose>>& sighting, const Loss& loss) {
  withInformation(sighting.information, [&](const auto& noise) {
    est_.insertMeasurement(Landmark(), poses_[std::size_t(sighting.from)],
                           landmarks_[std::size_t(sighting.to)], measured(sighting.measured), noise, loss,
                           named("sighting"));
  });
}

template <class Pose>
void GraphFit<Pose>::writeTo(PoseGraph<Pose>& graph) const {
  for (std::size_t i = 0; i < poses_.size(); ++i) graph.poses[i].value = *poses_[i];
  for (std::size_t i = 0; i < landmarks_.size(); ++i) graph.landmarks[i].value = *landmarks_[i];
}

template class GraphFit<Pose2>;
template class GraphFit<Pose3>;

}  // namespace slom::app::graph
