/// A direction in space: a point of the unit sphere S2.
///   state    v in R^3, |v| = 1 (kept to a few rounding errors)            [1]
///   tangent  (a, b): arc along two axes orthogonal to v, DOF = 2          [rad]
///   x [+] d  walks |d| along the great circle; injective for |d| < pi
///   y [-] x  the shortest such d; for y = -x, where all are shortest, (pi, 0)
///            Derivatives there are along that great circle, so a fit that starts there leaves the point.
///   source   Hertzberg et al. 2013, appendix A.4; axes: Duff et al., "Building an orthonormal basis,
///            revisited", 2017, listing 3
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "mtk/detail/long_turn.hpp"
#include "mtk/types/so2.hpp"
#include "mtk/types/so3.hpp"

namespace mtk {

template <class S = double>
class S2 {
 public:
  using scalar = S;
  static constexpr int DOF = 2;
  using Vector = vect<3, S>;

  /// The direction (1, 0, 0).
  S2() : v_(S(1), S(0), S(0)) {}
  /// Creates the direction of v, which may have any positive length.
  template <class D>
  explicit S2(const Eigen::MatrixBase<D>& v) : v_(v) {
    using std::abs;
    const S a = abs(v_[0]), b = abs(v_[1]), c = abs(v_[2]);
    S largest = select(a > b, a, b);
    largest = select(largest > c, largest, c);
    const S limit(std::numeric_limits<detail::built_in_t<S>>::max());
    if (const auto good = largest > S(0) && a <= limit && b <= limit && c <= limit; !detail::allOf(good)) {
      const auto number = [&](const S& x) {
        if constexpr (detail::is_dual<S>) {
          return detail::firstWithout(good, x.value());
        } else {
          return detail::firstWithout(good, x);
        }
      };
      detail::raiseBadNumbers("mtk.no-direction", "a direction (S2) cannot be made of the vector ",
                              {number(v_[0]), number(v_[1]), number(v_[2])},
                              ", which is zero or not finite; pass a finite vector of any positive length");
    }
    v_ /= largest;
    v_ /= v_.norm();
  }
  S2(const S& x, const S& y, const S& z) : S2(Vector(x, y, z)) {}

  /// Returns the unit vector.
  const Vector& vector() const { return v_; }
  operator const Vector&() const { return v_; }  // NOLINT(google-explicit-constructor): it is a unit vector
  /// Returns the coordinate x.
  const S& x() const { return v_[0]; }
  /// Returns the coordinate y.
  const S& y() const { return v_[1]; }
  /// Returns the coordinate z.
  const S& z() const { return v_[2]; }

  void boxplus(vectview<const S, 2> d, S scale = S(1)) {
    S a = scale * d[0], b = scale * d[1];
    S square = a * a + b * b;
    if (!detail::allOf(square <= S(detail::kLongestTurn<S> * detail::kLongestTurn<S>))) {
      a = detail::shortenedTurn(a);
      b = detail::shortenedTurn(b);
      square = a * a + b * b;
    }
    const auto [along, across] = detail::branch(
        square < S(detail::epsilon<S>),
        [&] {
          return std::array<S, 2>{S(1) - square / S(2), S(1) - square / S(6)};
        },  // series of cos(t) and sin(t)/t
        [&] {
          using std::sqrt;
          const S angle = sqrt(square);
          const auto [sine, cosine] = sinCos(angle);
          return std::array<S, 2>{cosine, sine / angle};
        });
    const Axes axes(v_);
    v_ = along * v_ + (across * a) * axes.a + (across * b) * axes.b;
    v_ *= (S(3) - v_.squaredNorm()) / S(2);
  }
  void boxminus(vectview<S, 2> out, const S2& y) const {
    const Axes axes(y.v_);
    const S a = axes.a.dot(v_), b = axes.b.dot(v_), along = y.v_.dot(v_);
    const S square = a * a + b * b;
    const S factor = detail::branch(
        along > S(0) && square < S(4 * detail::epsilon<S>) * along * along,  // atan(t)/t = 1 - t^2/3 + ...
        [&] { return S((S(1) - square / (S(3) * along * along)) / along); },
        [&] {
          using std::atan2;
          using std::sqrt;
          const S across = sqrt(select(square > S(0), square, S(1)));
          return S(atan2(across, along) / across);
        });
    const auto opposite = !(square > S(0)) && along <= S(0);
    out << select(opposite, S(S(detail::two_pi<S> / 2) - a), S(factor * a)),
        select(opposite, b, S(factor * b));
  }

  struct MtkState {
    static constexpr bool adds = false;
    static auto& of(S2& x) { return x.v_; }
  };

 private:
  /// Two unit vectors that complete v to a right-handed orthonormal frame.
  struct Axes {
    Vector a, b;
    explicit Axes(const Vector& v) {
      const S sign = select(v[2] < S(0), S(-1), S(1));
      const S f = S(-1) / (sign + v[2]);
      const S xy = v[0] * v[1] * f;
      a = Vector(S(1) + sign * v[0] * v[0] * f, sign * xy, -sign * v[0]);
      b = Vector(xy, sign + v[1] * v[1] * f, -v[1]);
    }
  };

  Vector v_;
};

/// Rotates a direction.
template <class A, class B>
S2<promote_t<A, B>> operator*(const SO3<A>& R, const S2<B>& v) {
  return S2<promote_t<A, B>>(R * v.vector());
}

}  // namespace mtk
