/// How a variable follows when the world that it is part of is moved, turned or scaled: what tells a free gauge from missing
/// measurements.
#pragma once

#include <Eigen/Core>

#include "mtk/rebind.hpp"
#include "mtk/types/s2.hpp"
#include "mtk/types/trafo.hpp"

namespace slom {

/// What poses, rotations and vectors are to the world.
enum class WorldRole {
  in_world,    ///< they lead from their own coordinates to the world's; vectors are points of it
  sees_world,  ///< they lead from the world's coordinates to their own; vectors are differences of its points
};

/// Translation along x, y, z, rotation about x, y, z (all about the origin), scale. In the plane: x, y, about z, scale.
inline constexpr int kWorldMotions = 7;

namespace detail {

/// The tangent vectors of one part, in the rows from `at` of a matrix with `dof` rows and kWorldMotions columns of zeros.
class WorldMotionWriter {
 public:
  WorldMotionWriter(double* out, int dof, WorldRole role) : out_(out), dof_(dof), role_(role) {}

  template <class P>
  void add(const P& part, int at) const {
    if constexpr (mtk::detail::is_trafo<P>) {
      addPose(part, at);
    } else if constexpr (mtk::detail::is_rotation<P>) {
      addRotation(part, at);
    } else if constexpr (requires { [](const mtk::S2<double>&) {}(part); }) {
      addDirection(part, at);
    } else if constexpr (requires { [](const Eigen::Matrix<double, 3, 1>&) {}(part); } && mtk::DOF_v<P> == 3) {
      addVector(Eigen::Vector3d(part[0], part[1], part[2]), 3, at);
    } else if constexpr (requires { [](const Eigen::Matrix<double, 2, 1>&) {}(part); } && mtk::DOF_v<P> == 2) {
      addVector(Eigen::Vector3d(part[0], part[1], 0), 2, at);
    } else if constexpr (mtk::detail::Compound<P>) {
      auto members = mtk::detail::membersOf(part);
      std::apply([&](const auto&... member) { ((add(member, at), at += mtk::dof(member)), ...); }, members);
    } else if constexpr (mtk::detail::StdArray<P>) {
      for (const auto& member : part) {
        add(member, at);
        at += mtk::dof(member);
      }
    }
  }

 private:
  double& entry(int row, int motion) const { return out_[motion * dof_ + row]; }
  bool sees() const { return role_ == WorldRole::sees_world; }

  void addVector(const Eigen::Vector3d& p, int dim, int at) const {
    for (int k = 0; k < dim && !sees(); ++k) entry(at + k, k) = 1;
    addTurned(p, dim, at);
    for (int i = 0; i < dim; ++i) entry(at + i, 6) = p[i];
  }
  /// e_k x p
  void addTurned(const Eigen::Vector3d& p, int dim, int at) const {
    for (int k = dim == 2 ? 2 : 0; k < 3; ++k) {
      const Eigen::Vector3d turned = Eigen::Vector3d::Unit(k).cross(p);
      for (int i = 0; i < dim; ++i) entry(at + i, 3 + k) = turned[i];
    }
  }
  template <class R>
  void addRotation(const R& rotation, int at) const {
    if constexpr (R::DIM == 2) {
      entry(at, 5) = sees() ? -1 : 1;
    } else {
      const auto matrix = rotation.toRotationMatrix();
      for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) entry(at + i, 3 + k) = sees() ? (i == k ? -1.0 : 0.0) : double(matrix(k, i));
      }
    }
  }
  template <class T>
  void addPose(const T& pose, int at) const {
    constexpr int dim = T::DIM;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int i = 0; i < dim; ++i) p[i] = pose.pos[i];
    addRotation(pose.orient, at + dim);
    if (!sees()) return addVector(p, dim, at);
    const auto matrix = pose.orient.toRotationMatrix();
    for (int i = 0; i < dim; ++i) {
      for (int k = 0; k < dim; ++k) entry(at + i, k) = -matrix(i, k);
      entry(at + i, 6) = p[i];
    }
  }
  void addDirection(const mtk::S2<double>& direction, int at) const {
    if (sees()) return;
    constexpr double small = 1e-6;
    const Eigen::Vector3d v(direction.x(), direction.y(), direction.z());
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d turned = v + small * Eigen::Vector3d::Unit(k).cross(v);
      const auto d = mtk::difference(mtk::S2<double>(turned), direction);
      for (int i = 0; i < 2; ++i) entry(at + i, 3 + k) = d[i] / small;
    }
  }

  double* out_;
  int dof_;
  WorldRole role_;
};

}  // namespace detail

/// Writes how x moves with each motion of the world, dof(x) x kWorldMotions, column-major, 0 for parts that are of no known
/// geometric kind.
template <class X>
void worldMotions(const X& x, WorldRole role, double* out) {
  const int n = mtk::dof(x);
  for (int i = 0; i < n * kWorldMotions; ++i) out[i] = 0;
  detail::WorldMotionWriter(out, n, role).add(x, 0);
}

}  // namespace slom
