/// Motions with an invariant error: a rotation and K vectors as one element of the group SE_K(2) or SE_K(3).
///
///     slom::RightInvariant<mtk::SO3<>, 2> x;   // orient, vectors[0] (velocity), vectors[1] (position)
///
///   state     orient R = world_R_body, vectors v_1 ... v_K in the world
///   tangent   (rho_1, ..., rho_K, phi), DOF = K dim + R::DOF                                  [units of v, rad]
///   right     x [+] d = Exp(d) x:   R := exp(phi) R,  v_i := exp(phi) v_i + V(phi) rho_i
///   left      x [+] d = x Exp(d):   R := R exp(phi),  v_i := v_i + R V(phi) rho_i
///   y [-] x   the d with |phi| <= pi, where V is the left Jacobian of the rotation
/// An update leaves the covariance of such an error as it is: directions that no measurement sees are the same at each
/// mean, and the transport of transport.hpp would turn them (measured in docs/filters.md).
/// The derivative of a group-affine motion by such an error does not depend on the state. So a filter does not take
/// directions as seen that no measurement sees: the world's rotation in SLAM (right), with measurements in the body.
/// Measurements in the world, such as GNSS, go with the left error.
///   source    Barrau and Bonnabel, "The invariant extended Kalman filter as a stable observer", 2017; for SLAM their "An
///             EKF-SLAM algorithm with consistency properties", 2015; V and its inverse: Barfoot, "State estimation for
///             robotics", 2017, equations 7.77
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "mtk/rebind.hpp"

namespace slom {

/// The side on which an error is multiplied.
enum class ErrorSide { left, right };

namespace detail {

template <class S>
mtk::vect<3, S> crossProduct(const mtk::vect<3, S>& a, const mtk::vect<3, S>& b) {
  return mtk::vect<3, S>(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}

/// The left Jacobian V(phi) of a rotation and its inverse, applied to vectors: I + first [phi]x + second [phi]x^2.
template <class S>
class LeftJacobian3 {
 public:
  explicit LeftJacobian3(const mtk::vect<3, S>& phi) : phi_(phi) {
    const S square = phi.squaredNorm();
    const auto factors = mtk::detail::branch(
        square < S(1e-3),
        [&] {  // series to the 6th power of the angle
          return std::array<S, 3>{
              S(0.5) - square / S(24) * (S(1) - square / S(30) * (S(1) - square / S(56))),
              S(1) / S(6) - square / S(120) * (S(1) - square / S(42) * (S(1) - square / S(72))),
              S(1) / S(12) + square / S(720) * (S(1) + square / S(42) * (S(1) + square / S(40)))};
        },
        [&] {
          using std::sqrt;
          const S angle = sqrt(square);
          const auto [sine, cosine] = mtk::sinCos(angle);
          const auto [half_sine, half_cosine] = mtk::sinCos(S(angle / S(2)));
          return std::array<S, 3>{(S(1) - cosine) / square, (angle - sine) / (square * angle),
                                  (S(1) - angle * half_cosine / (S(2) * half_sine)) / square};
        });
    first_ = factors[0];
    second_ = factors[1];
    inverse_ = factors[2];
  }
  mtk::vect<3, S> times(const mtk::vect<3, S>& v) const { return apply(first_, second_, v); }
  mtk::vect<3, S> inverseTimes(const mtk::vect<3, S>& v) const { return apply(S(-0.5), inverse_, v); }

 private:
  mtk::vect<3, S> apply(const S& first, const S& second, const mtk::vect<3, S>& v) const {
    const mtk::vect<3, S> once = crossProduct(phi_, v);
    return mtk::vect<3, S>(v + once * first + crossProduct(phi_, once) * second);
  }
  mtk::vect<3, S> phi_;
  S first_, second_, inverse_;
};

/// The same in the plane: [a, -b; b, a].
template <class S>
class LeftJacobian2 {
 public:
  explicit LeftJacobian2(const mtk::vect<1, S>& phi) {
    const S angle = phi[0], square = angle * angle;
    const auto factors = mtk::detail::branch(
        square < S(1e-3),
        [&] {
          return std::array<S, 2>{S(1) - square / S(6) * (S(1) - square / S(20) * (S(1) - square / S(42))),
                                  angle / S(2) * (S(1) - square / S(12) * (S(1) - square / S(30)))};
        },
        [&] {
          const auto [sine, cosine] = mtk::sinCos(angle);
          return std::array<S, 2>{sine / angle, (S(1) - cosine) / angle};
        });
    a_ = factors[0];
    b_ = factors[1];
  }
  mtk::vect<2, S> times(const mtk::vect<2, S>& v) const {
    return mtk::vect<2, S>(a_ * v[0] - b_ * v[1], b_ * v[0] + a_ * v[1]);
  }
  mtk::vect<2, S> inverseTimes(const mtk::vect<2, S>& v) const {
    const S square = a_ * a_ + b_ * b_;
    return mtk::vect<2, S>((a_ * v[0] + b_ * v[1]) / square, (a_ * v[1] - b_ * v[0]) / square);
  }

 private:
  S a_, b_;
};
template <class S>
LeftJacobian3<S> leftJacobian(const mtk::vect<3, S>& phi) {
  return LeftJacobian3<S>(phi);
}
template <class S>
LeftJacobian2<S> leftJacobian(const mtk::vect<1, S>& phi) {
  return LeftJacobian2<S>(phi);
}

}  // namespace detail

/// R: mtk::SO2<S> or mtk::SO3<S>.
template <class R, int K, ErrorSide Side>
class InvariantMotion {
 public:
  using scalar = typename R::scalar;
  static constexpr int DIM = R::DIM;
  static constexpr int DOF = K * DIM + R::DOF;
  using Vector = mtk::vect<DIM, scalar>;
  static constexpr bool keeps_covariance = true;

  R orient;                                    ///< world_R_body
  std::array<Vector, std::size_t{K}> vectors;  ///< in the world

  /// The identity.
  InvariantMotion() = default;
  InvariantMotion(const R& rotation, const std::array<Vector, std::size_t{K}>& world_vectors)
      : orient(rotation), vectors(world_vectors) {}
  /// Converts to another number type without loss.
  template <class Q>
    requires(std::is_arithmetic_v<typename Q::scalar> && !std::is_same_v<Q, R> &&
             std::is_same_v<mtk::rebind_t<Q, scalar>, R>)
  InvariantMotion(
      const InvariantMotion<Q, K, Side>& x) {  // NOLINT(google-explicit-constructor): nothing is lost
    mtk::detail::liftPart(orient, x.orient);
    for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = Vector(x.vectors[i]);
  }

  void boxplus(mtk::vectview<const scalar, DOF> d, scalar scale = scalar(1)) {
    mtk::vect<R::DOF, scalar> phi;
    for (int i = 0; i < R::DOF; ++i) phi[i] = scale * d[K * DIM + i];
    const R turn = R::exp(phi);
    const auto V = detail::leftJacobian(phi);
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      Vector rho;
      for (int i = 0; i < DIM; ++i) rho[i] = scale * d[static_cast<int>(k) * DIM + i];
      const Vector moved = V.times(rho);
      vectors[k] =
          Side == ErrorSide::right ? Vector(turn * vectors[k] + moved) : Vector(vectors[k] + orient * moved);
    }
    orient = Side == ErrorSide::right ? R(turn * orient) : R(orient * turn);
  }
  void boxminus(mtk::vectview<scalar, DOF> out, const InvariantMotion& y) const {
    const R turn = Side == ErrorSide::right ? R(orient * y.orient.inverse()) : R(y.orient.inverse() * orient);
    const mtk::vect<R::DOF, scalar> phi = R::log(turn);
    const auto V = detail::leftJacobian(phi);
    for (std::size_t k = 0; k < vectors.size(); ++k) {
      const Vector moved = Side == ErrorSide::right
                               ? Vector(vectors[k] - turn * y.vectors[k])
                               : Vector(y.orient.inverse() * Vector(vectors[k] - y.vectors[k]));
      const Vector rho = V.inverseTimes(moved);
      for (int i = 0; i < DIM; ++i) out[static_cast<int>(k) * DIM + i] = rho[i];
    }
    for (int i = 0; i < R::DOF; ++i) out[K * DIM + i] = phi[i];
  }
};

/// Error on the left of the state, in the world: for measurements in the body.
template <class R, int K>
using RightInvariant = InvariantMotion<R, K, ErrorSide::right>;
/// Error on the right of the state, in the body: for measurements in the world.
template <class R, int K>
using LeftInvariant = InvariantMotion<R, K, ErrorSide::left>;

}  // namespace slom

template <class R, int K, slom::ErrorSide Side, class S>
struct mtk::detail::Rebind<slom::InvariantMotion<R, K, Side>, S> {
  using type = slom::InvariantMotion<rebound_t<R, S>, K, Side>;
};
