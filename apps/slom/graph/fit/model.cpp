#include "graph/fit/model.hpp"

#include <slom/measurements/landmark.hpp>
#include <slom/measurements/relative_pose.hpp>

#include "graph/fit/quaternion_error.hpp"

namespace slom::app::graph {

namespace {

/// slom::RelativePoseInFrameOfA has t_ab - t_z, seen from a, for the translation R_z^T (t_ab - t_z) of z^-1
/// (a^-1 b), seen from where z puts b. So its information must be that of the file, turned to a's frame: B^T
/// I B with B = diag(R_z^T, 1).
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

}  // namespace

template <class Pose>
void GraphModel::insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b,
                            const Edge<Pose>& edge) const {
  withInformation(informationFromA(edge), [&](const auto& noise) {
    if constexpr (dim<Pose> == 3) {
      if (rotation_error == RotationError::quaternion) {
        est.insertMeasurement(QuaternionError(), a, b, edge.measured, noise, options.loss, named("edge"));
        return;
      }
    }
    est.insertMeasurement(RelativePoseInFrameOfA(), a, b, measured(edge.measured), noise, options.loss,
                          named("edge"));
  });
}

template <class Pose>
void GraphModel::insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point<Pose>>& p,
                                const Edge<Point<Pose>>& sighting) const {
  withInformation(sighting.information, [&](const auto& noise) {
    est.insertMeasurement(Landmark(), a, p, measured(sighting.measured), noise, options.loss,
                          named("sighting"));
  });
}

template void GraphModel::insertEdge(Estimator&, const VarID<Pose2>&, const VarID<Pose2>&,
                                     const Edge<Pose2>&) const;
template void GraphModel::insertEdge(Estimator&, const VarID<Pose3>&, const VarID<Pose3>&,
                                     const Edge<Pose3>&) const;
template void GraphModel::insertSighting(Estimator&, const VarID<Pose2>&, const VarID<Point<Pose2>>&,
                                         const Edge<Point<Pose2>>&) const;
template void GraphModel::insertSighting(Estimator&, const VarID<Pose3>&, const VarID<Point<Pose3>>&,
                                         const Edge<Point<Pose3>>&) const;

}  // namespace slom::app::graph
