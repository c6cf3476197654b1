/// Gauge generators: how a variable moves if the world around it is shifted, rotated or scaled. They distinguish a free
/// gauge from missing measurements.
#pragma once

#include <array>
#include <cstddef>

#include "mtk/rebind.hpp"
#include "mtk/types/s2.hpp"
#include "mtk/types/trafo.hpp"

namespace slom {

/// Relation of poses, rotations and vectors to the world.
enum class WorldRole {
  in_world,    ///< poses map their own coordinates to the world's; vectors are points of the world
  sees_world,  ///< poses map the world's coordinates to their own; vectors are differences of points
};

/// Number of generators: translation along x, y, z, rotation about x, y, z (all about the origin), scale. In the plane:
/// translation along x, y, rotation about z, scale.
inline constexpr int kGaugeGenerators = 7;

namespace detail {

/// Writes the tangent vectors of one part to the rows from `at` of a matrix with `dof` rows and kGaugeGenerators
/// columns of zeros.
class GaugeGeneratorWriter {
 public:
  GaugeGeneratorWriter(double* out, int dof, WorldRole role) : out_(out), dof_(dof), role_(role) {}

  template <class P>
  void add(const P& part, int at) const {
    if constexpr (requires { requires P::has_separate_entries; }) {
      return;  // separate numbers, such as focal length and distortion, are not a vector in space
    } else if constexpr (mtk::detail::is_trafo<P>) {
      addPose(part, at);
    } else if constexpr (mtk::detail::is_rotation<P>) {
      addRotation(part, at);
    } else if constexpr (requires { [](const mtk::S2<double>&) {}(part); }) {
      addDirection({part.x(), part.y(), part.z()}, at);
    } else if constexpr (requires { [](const Eigen::Matrix<double, 3, 1>&) {}(part); } &&
                         mtk::DOF_v<P> == 3) {
      addVector({part[0], part[1], part[2]}, 3, at);
    } else if constexpr (requires { [](const Eigen::Matrix<double, 2, 1>&) {}(part); } &&
                         mtk::DOF_v<P> == 2) {
      addVector({part[0], part[1], 0}, 2, at);
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
  using Vector = std::array<double, 3>;
  using Matrix = std::array<Vector, 3>;  // rows

  // Arithmetic compiled once, in the library.
  void addVector(const Vector& p, int dim, int at) const;
  void addRotation2(int at) const;
  void addRotation3(const Matrix& rotation, int at) const;
  void addSeeingPosition(const Vector& p, const Matrix& rotation, int dim, int at) const;
  void addDirection(const Vector& v, int at) const;

  template <class R>
  static Matrix matrixOf(const R& rotation) {
    const auto matrix = rotation.toRotationMatrix();
    Matrix result{};
    for (int i = 0; i < R::DIM; ++i) {
      for (int k = 0; k < R::DIM; ++k)
        result[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = double(matrix(i, k));
    }
    return result;
  }
  template <class R>
  void addRotation(const R& rotation, int at) const {
    if constexpr (R::DIM == 2) {
      addRotation2(at);
    } else {
      addRotation3(matrixOf(rotation), at);
    }
  }
  template <class T>
  void addPose(const T& pose, int at) const {
    Vector p{};
    for (int i = 0; i < T::DIM; ++i) p[static_cast<std::size_t>(i)] = pose.pos[i];
    addRotation(pose.orient, at + T::DIM);
    if (role_ == WorldRole::sees_world) {
      addSeeingPosition(p, matrixOf(pose.orient), T::DIM, at);
    } else {
      addVector(p, T::DIM, at);
    }
  }

  double* out_;
  int dof_;
  WorldRole role_;
};

}  // namespace detail

/// Writes how x moves with each gauge generator: dof(x) x kGaugeGenerators, column-major, 0 for parts of no known
/// geometric kind.
template <class X>
void gaugeGenerators(const X& x, WorldRole role, double* out) {
  const int n = mtk::dof(x);
  for (int i = 0; i < n * kGaugeGenerators; ++i) out[i] = 0;
  detail::GaugeGeneratorWriter(out, n, role).add(x, 0);
}

}  // namespace slom
