/// A rotation in the plane: the group SO(2).
///   state    angle in [-pi, pi)                                           [rad]
///   tangent  the angle, DOF = 1; x [+] d turns by d, y [-] x is the shortest turn, in [-pi, pi)
#pragma once

#include <cmath>
#include <limits>

#include "mtk/types/vect.hpp"

namespace mtk {

namespace detail {
/// 2 pi as a sum of two numbers: the nearest number and the remainder.
template <class S>
inline constexpr built_in_t<S> two_pi = built_in_t<S>(6.283185307179586476925286766559005768L);
template <class S>
inline constexpr built_in_t<S> two_pi_rest =
    built_in_t<S>(6.283185307179586476925286766559005768L - static_cast<long double>(two_pi<S>));

/// Limit beyond which the C library's sine and cosine reduce an angle, because products of whole turns lose digits.
inline constexpr double kFarAngle = 1e3;

/// Returns the angle in [-pi, pi) that differs by whole turns from `a`, which lies outside. Not inlined, to keep the
/// code out of every product of rotations.
template <class S>
[[gnu::noinline]] S wrapOutsideAngle(const S& a) {
  using std::floor;
  constexpr auto half = two_pi<S> / 2;
  if (!allOf(a >= S(-kFarAngle) && a <= S(kFarAngle))) return S(reducedAngle(a));
  const S turns = floor(S(a / two_pi<S> + S(0.5)));
  S wrapped = (a - turns * two_pi<S>)-turns * two_pi_rest<S>;
  wrapped = select(wrapped >= S(half), S(wrapped - two_pi<S>), wrapped);
  return select(wrapped < S(-half), S(-half), wrapped);
}
/// Returns the angle in [-pi, pi) that differs from `a` by whole turns. The turns have no derivatives.
template <class S>
S wrapAngle(const S& a) {
  if constexpr (is_dual<S>) {
    return S(wrapAngle(a.value()), a.partials());
  } else {
    constexpr auto half = two_pi<S> / 2;
    return branch(
        a >= S(-half) && a < S(half), [&] { return a; }, [&] { return wrapOutsideAngle(a); });
  }
}
}  // namespace detail

template <class S = double>
class SO2 {
 public:
  using scalar = S;
  static constexpr int DOF = 1;
  static constexpr int DIM = 2;  ///< dimension of the space it acts on
  static constexpr std::array<std::string_view, 1> component_names{"angle"};
  using Matrix = Eigen::Matrix<S, 2, 2, Eigen::DontAlign>;

  /// No rotation.
  SO2() = default;
  /// Rotation by `angle` [rad], counter-clockwise.
  explicit SO2(const S& angle) : angle_(detail::wrapAngle(angle)) {}
  /// Creates a rotation from a rotation matrix, or the rotation nearest to another matrix. Throws [mtk.no-rotation] if
  /// there is none, as for reflections and the zero matrix.
  template <class D>
    requires(D::RowsAtCompileTime == 2 && D::ColsAtCompileTime == 2)
  explicit SO2(const Eigen::MatrixBase<D>& R) {
    using std::abs;
    using std::atan2;
    const S c = R(0, 0) + R(1, 1), s = R(1, 0) - R(0, 1);
    const S size = abs(S(R(0, 0))) + abs(S(R(0, 1))) + abs(S(R(1, 0))) + abs(S(R(1, 1)));
    const auto good =
        abs(c) + abs(s) > S(1e-6) * size && size <= S(std::numeric_limits<detail::built_in_t<S>>::max());
    if (!detail::allOf(good)) {
      const auto number = [&](const S& x) {
        if constexpr (detail::is_dual<S>) {
          return detail::firstWithout(good, x.value());
        } else {
          return detail::firstWithout(good, x);
        }
      };
      detail::raiseBadNumbers("mtk.no-rotation",
                              "a rotation (SO2) cannot be made of the matrix with the rows ",
                              {number(R(0, 0)), number(R(0, 1)), number(R(1, 0)), number(R(1, 1))},
                              ", which is a reflection, zero or not finite; pass a rotation matrix");
    }
    angle_ = detail::wrapAngle(S(atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1))));
  }

  /// Returns the rotation by the angle scale * d [rad], counterclockwise.
  static SO2 exp(vectview<const S, 1> d, S scale = S(1)) { return SO2(scale * d[0]); }
  /// Returns the angle in [-pi, pi) [rad] whose exponential is R.
  static vect<1, S> log(const SO2& R) { return vect<1, S>(R.angle_); }

  /// Returns the angle in [-pi, pi) [rad].
  const S& angle() const { return angle_; }
  /// Returns the 2 x 2 matrix: cos, -sin; sin, cos.
  Matrix toRotationMatrix() const {
    const auto [s, c] = sinCos(angle_);
    Matrix R;
    R << c, -s, s, c;
    return R;
  }
  /// Returns the rotation by the opposite angle.
  SO2 inverse() const { return SO2(-angle_); }
  SO2 operator*(const SO2& other) const { return SO2(angle_ + other.angle_); }
  /// Rotates a point or a direction.
  template <class D>
    requires(bool(D::IsVectorAtCompileTime))
  auto operator*(const Eigen::MatrixBase<D>& p) const {
    static_assert(D::SizeAtCompileTime == 2 || D::SizeAtCompileTime == Dynamic, "mtk: SO2 rotates 2-vectors");
    const auto [s, c] = sinCos(angle_);
    const PlainVector<typename D::Scalar, 2> q = p;
    const auto &x = q.coeffRef(0), &y = q.coeffRef(1);
    return vect<2, promote_t<S, typename D::Scalar>>(c * x - s * y, s * x + c * y);
  }

  void boxplus(vectview<const S, 1> d, S scale = S(1)) {
    angle_ = detail::wrapAngle(S(angle_ + scale * d[0]));
  }
  void boxminus(vectview<S, 1> out, const SO2& y) const { out[0] = detail::wrapAngle(S(angle_ - y.angle_)); }

  struct MtkState {
    static constexpr bool adds = true;
    static S& of(SO2& x) { return x.angle_; }
    static auto difference(const auto& x, const SO2& z) { return detail::wrapAngle(x.angle() - z.angle()); }
  };

 private:
  S angle_ = S(0);
};

/// Returns the product of rotations over different number types, one of which holds the other, such as constants and
/// dual numbers.
template <class A, class B>
  requires(!std::is_same_v<A, B>)
SO2<promote_t<A, B>> operator*(const SO2<A>& a, const SO2<B>& b) {
  return SO2<promote_t<A, B>>(promote_t<A, B>(a.angle() + b.angle()));
}

}  // namespace mtk
