// The two worlds of a pose graph: the plane and space.
#pragma once

#include <mtk/mtk.hpp>

namespace slom::app::graph {

using Pose2 = mtk::trafo<mtk::SO2<>>;  ///< world_T_pose in the plane
using Pose3 = mtk::trafo<mtk::SO3<>>;  ///< world_T_pose in space

template <class Pose>
inline constexpr int dof = Pose::DOF;  ///< 3 or 6: translation, then rotation
template <class Pose>
inline constexpr int dim = Pose::DIM;  ///< 2 or 3
template <class Pose>
using Point = mtk::vect<Pose::DIM>;

template <int N>
using Symmetric = Eigen::Matrix<double, N, N, Eigen::DontAlign>;

}  // namespace slom::app::graph
