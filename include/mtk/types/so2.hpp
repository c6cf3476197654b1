/// A rotation in the plane: the group SO(2).
///   state    angle in [-pi, pi)                                           [rad]
///   tangent  the angle, DOF = 1; x [+] d turns by d, y [-] x is the shortest turn, in [-pi, pi)
#pragma once

#include <cmath>

#include "mtk/types/vect.hpp"

namespace mtk {

namespace detail {
/// Twice pi in two parts: the nearest number and what is missing to it.
template <class S>
inline constexpr S two_pi = S(6.283185307179586476925286766559005768L);
template <class S>
inline constexpr S two_pi_rest = S(6.283185307179586476925286766559005768L - (long double)(two_pi<S>));

/// The angle in [-pi, pi) that differs from `a` by whole turns.
template <class S>
S wrapAngle(const S& a) {
  using std::floor;
  constexpr S half = two_pi<S> / S(2);
  if (a >= -half && a < half) return a;
  const S turns = floor(a / two_pi<S> + S(0.5));
  S wrapped = (a - turns * two_pi<S>) - turns * two_pi_rest<S>;
  if (wrapped >= half) wrapped -= two_pi<S>;
  if (wrapped < -half) wrapped = -half;
  return wrapped;
}
}  // namespace detail

template <class S = double>
class SO2 {
 public:
  using scalar = S;
  static constexpr int DOF = 1;
  static constexpr int DIM = 2;  ///< of the space it acts on
  static constexpr std::array<std::string_view, 1> component_names{"angle"};
  using Matrix = Eigen::Matrix<S, 2, 2, Eigen::DontAlign>;

  /// No rotation.
  SO2() = default;
  /// Rotation by `angle` [rad], counter-clockwise.
  explicit SO2(const S& angle) : angle_(detail::wrapAngle(angle)) {}
  /// From a rotation matrix.
  template <class D>
    requires(D::RowsAtCompileTime == 2 && D::ColsAtCompileTime == 2)
  explicit SO2(const Eigen::MatrixBase<D>& R) {
    using std::atan2;
    angle_ = detail::wrapAngle(S(atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))));
  }

  static SO2 exp(vectview<const S, 1> d, S scale = S(1)) { return SO2(scale * d[0]); }
  static vect<1, S> log(const SO2& R) { return vect<1, S>(R.angle_); }

  const S& angle() const { return angle_; }
  Matrix toRotationMatrix() const {
    using std::cos;
    using std::sin;
    const S c = cos(angle_), s = sin(angle_);
    Matrix R;
    R << c, -s, s, c;
    return R;
  }
  SO2 inverse() const { return SO2(-angle_); }
  SO2 operator*(const SO2& other) const { return SO2(angle_ + other.angle_); }
  /// Rotates a point or a direction.
  template <class D>
    requires(bool(D::IsVectorAtCompileTime))
  vect<2, S> operator*(const Eigen::MatrixBase<D>& p) const {
    static_assert(D::SizeAtCompileTime == 2 || D::SizeAtCompileTime == Dynamic, "mtk: SO2 rotates 2-vectors");
    using std::cos;
    using std::sin;
    const S c = cos(angle_), s = sin(angle_);
    const PlainVector<typename D::Scalar, 2> point = p;
    const S x(point[0]), y(point[1]);
    return vect<2, S>(c * x - s * y, s * x + c * y);
  }

  void boxplus(vectview<const S, 1> d, S scale = S(1)) { angle_ = detail::wrapAngle(S(angle_ + scale * d[0])); }
  void boxminus(vectview<S, 1> out, const SO2& y) const { out[0] = detail::wrapAngle(S(angle_ - y.angle_)); }

 private:
  S angle_ = S(0);
};

}  // namespace mtk
