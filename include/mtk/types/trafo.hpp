/// A rigid motion: SE(2) as trafo<SO2<>>, SE(3) as trafo<SO3<>>.
///   state    pos, orient: a point p is moved to orient * p + pos
///   tangent  (translation, rotation), DOF = 3 or 6                        [length unit, rad]
///   x [+] d  componentwise: pos + d_pos (in the outer frame), orient [+] d_orient (on the right)
///   y [-] x  componentwise likewise
/// To rotate a direction, such as a gravity vector, use `.orient` and not the transform.
#pragma once

#include <tuple>

#include "mtk/types/so2.hpp"
#include "mtk/types/so3.hpp"

namespace mtk {

template <class R>
class trafo {
 public:
  using scalar = typename R::scalar;
  using Rotation = R;
  static constexpr int DIM = R::DIM;
  static constexpr int DOF = DIM + R::DOF;
  using Vector = vect<DIM, scalar>;
  using Matrix = Eigen::Matrix<scalar, DIM + 1, DIM + 1, Eigen::DontAlign>;

  Vector pos;
  R orient;

  /// The identity.
  trafo() = default;
  trafo(const R& rotation, const Vector& translation) : pos(translation), orient(rotation) {}
  trafo(const Vector& translation, const R& rotation) : pos(translation), orient(rotation) {}
  explicit trafo(const R& rotation) : orient(rotation) {}
  explicit trafo(const Vector& translation) : pos(translation) {}
  /// Converts the motion to another number type without loss, such as a constant to dual numbers.
  template <class Q>
    requires(!std::is_same_v<Q, R> && std::is_convertible_v<Q, R>)
  trafo(const trafo<Q>& T) : pos(T.pos), orient(T.orient) {}  // NOLINT(google-explicit-constructor)

  /// Returns b_T_a for a_T_b: (R^T, -R^T t).
  trafo inverse() const {
    const R back = orient.inverse();
    return trafo(back, -(back * pos));
  }
  trafo operator*(const trafo& b) const { return trafo(orient * b.orient, orient * b.pos + pos); }
  trafo operator*(const R& b) const { return trafo(orient * b, pos); }
  friend trafo operator*(const R& a, const trafo& b) { return trafo(a * b.orient, a * b.pos); }
  /// Moves a point.
  template <class D>
    requires(bool(D::IsVectorAtCompileTime))
  auto operator*(const Eigen::MatrixBase<D>& p) const {
    return orient * p + pos;
  }
  /// Returns the homogeneous matrix.
  Matrix matrix() const {
    Matrix T = Matrix::Identity();
    T.template topLeftCorner<DIM, DIM>() = orient.toRotationMatrix();
    T.template topRightCorner<DIM, 1>() = pos;
    return T;
  }

  void boxplus(vectview<const scalar, DOF> d, scalar scale = scalar(1)) {
    pos.boxplus(vectview<const scalar, DIM>(d.data()), scale);
    orient.boxplus(vectview<const scalar, R::DOF>(d.data() + DIM), scale);
  }
  void boxminus(vectview<scalar, DOF> out, const trafo& y) const {
    pos.boxminus(vectview<scalar, DIM>(out.data()), y.pos);
    orient.boxminus(vectview<scalar, R::DOF>(out.data() + DIM), y.orient);
  }

  template <class T>
  static auto mtkMembers(T& x) {
    return std::tie(x.pos, x.orient);
  }
  static std::array<std::string_view, 2> mtkMemberNames() { return {"pos", "orient"}; }
};

namespace detail {

/// A rigid motion whose two parts depend on different unknowns.
template <class R, class V>
struct SparseTrafo {
  V pos;
  R orient;

  auto inverse() const {
    const auto back = orient.inverse();
    const auto moved = -(back * pos);
    return SparseTrafo<std::remove_const_t<decltype(back)>, std::remove_const_t<decltype(moved)>>{moved,
                                                                                                  back};
  }
  template <class D>
    requires(bool(D::IsVectorAtCompileTime))
  auto operator*(const Eigen::MatrixBase<D>& p) const {
    return orient * p + pos;
  }
};

template <class T>
inline constexpr bool is_trafo = false;
template <class R>
inline constexpr bool is_trafo<trafo<R>> = true;
template <class R, class V>
inline constexpr bool is_trafo<SparseTrafo<R, V>> = true;
template <class T>
inline constexpr bool is_rotation = false;
template <class S>
inline constexpr bool is_rotation<SO2<S>> = true;
template <class S>
void acceptRotation(const SO3<S>& R);
template <class T>
  requires requires(const T& x) { acceptRotation(x); }
inline constexpr bool is_rotation<T> = true;

/// Returns a trafo if rotation and translation have the same scalar, else a SparseTrafo.
template <class R, class V>
auto joined(const R& rotation, const V& translation) {
  if constexpr (std::is_same_v<V, vect<R::DIM, typename R::scalar>>) {
    return trafo<R>(rotation, translation);
  } else {
    return SparseTrafo<R, V>{translation, rotation};
  }
}
}  // namespace detail

// Products of motions over different number types, such as constants and dual numbers.
template <class A, class B>
  requires(detail::is_trafo<A> && detail::is_trafo<B> && !std::is_same_v<A, B>)
auto operator*(const A& a, const B& b) {
  return detail::joined(a.orient * b.orient, a.orient * b.pos + a.pos);
}
template <class R, class V>
auto operator*(const detail::SparseTrafo<R, V>& a, const detail::SparseTrafo<R, V>& b) {
  return detail::joined(a.orient * b.orient, a.orient * b.pos + a.pos);
}
template <class A, class B>
  requires(detail::is_trafo<A> && detail::is_rotation<B> && !std::is_same_v<A, trafo<B>>)
auto operator*(const A& a, const B& b) {
  return detail::joined(a.orient * b, a.pos);
}
template <class A, class B>
  requires(detail::is_rotation<A> && detail::is_trafo<B> && !std::is_same_v<B, trafo<A>>)
auto operator*(const A& a, const B& b) {
  return detail::joined(a * b.orient, a * b.pos);
}

}  // namespace mtk
