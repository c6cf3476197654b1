/// A rotation in space: the group SO(3).
///   state    unit quaternion, stored as (x, y, z, w), |q| = 1 (kept to a few rounding errors)
///   tangent  rotation vector (axis times angle), DOF = 3                  [rad]
///   x [+] d  x * exp(d): the perturbation acts on the right, d is seen in the rotated frame
///   y [-] x  log(x^-1 * y), the shortest rotation, |.| <= pi
///   source   Hertzberg et al. 2013, appendix A.3; logarithm by atan2, exact near 0 and pi
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "mtk/detail/long_turn.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

template <class S = double>
class SO3 {
 public:
  using scalar = S;
  static constexpr int DOF = 3;
  static constexpr int DIM = 3;  ///< dimension of the space it acts on
  static constexpr std::array<std::string_view, 3> component_names = detail::xyz_names;
  using Matrix = Eigen::Matrix<S, 3, 3, Eigen::DontAlign>;
  using Coefficients = PlainVector<S, 4>;
  using Vector = vect<3, S>;

  /// No rotation.
  SO3() : q_(S(0), S(0), S(0), S(1)) {}
  /// Creates a rotation from quaternion coefficients, which are normalised; note the order. Throws [mtk.no-rotation] if
  /// the length of the coefficients is zero or not finite, or so far from 1 that its square is.
  SO3(const S& w, const S& x, const S& y, const S& z) : q_(x, y, z, w) {
    using Limits = std::numeric_limits<detail::built_in_t<S>>;
    const S square = q_.squaredNorm();
    if (const auto good = square >= S(Limits::min()) && square <= S(Limits::max()); !detail::allOf(good)) {
      const auto number = [&](const S& c) { return detail::firstWithout(good, c); };
      detail::raiseBadNumbers(
          "mtk.no-rotation", "a rotation (SO3) cannot be made of the quaternion (w, x, y, z) = ",
          {number(w), number(x), number(y), number(z)},
          ", whose length is zero, not finite or far from 1; pass finite coefficients of a length near 1, which "
          "are then normalised");
    }
    using std::sqrt;
    q_ /= sqrt(square);
  }
  // Eigen/Core declares the names of Eigen's rotations. A program that has such a rotation includes Eigen/Geometry.
  SO3(const Eigen::Quaternion<S>& q)  // NOLINT(google-explicit-constructor): the same thing
      : SO3(q.w(), q.x(), q.y(), q.z()) {}
  SO3(const Eigen::AngleAxis<S>& a)  // NOLINT(google-explicit-constructor): the same thing
      : SO3(exp(Vector(a.angle() * a.axis()))) {}
  /// Converts the rotation to a number type without loss, such as a constant to packs.
  template <class T>
    requires(!std::is_same_v<T, S> && std::is_arithmetic_v<T> && std::is_same_v<promote_t<T, S>, S>)
  SO3(const SO3<T>& R)  // NOLINT(google-explicit-constructor): nothing is lost
      : q_(S(R.x()), S(R.y()), S(R.z()), S(R.w())) {}
  /// Creates a rotation from a rotation matrix. A matrix that is only roughly orthonormal gives a rotation near it.
  /// Throws [mtk.no-rotation] for reflections, the zero matrix, columns whose length is far from 1, and numbers that
  /// are not finite.
  ///   source   Shepperd, "Quaternion from rotation matrix", 1978: the largest coefficient is not a difference of large
  ///            numbers
  template <class D>
    requires(D::RowsAtCompileTime == 3 && D::ColsAtCompileTime == 3)
  explicit SO3(const Eigen::MatrixBase<D>& matrix) {
    const Matrix R = matrix;
    requireRotation(R);
    const S trace = R(0, 0) + R(1, 1) + R(2, 2);
    int i = R(1, 1) > R(0, 0) ? 1 : 0;
    if (R(2, 2) > R(i, i)) i = 2;
    if (trace > R(i, i)) {
      q_ << R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1), S(1) + trace;
    } else {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      q_[i] = S(1) + R(i, i) - R(j, j) - R(k, k);
      q_[j] = R(j, i) + R(i, j);
      q_[k] = R(k, i) + R(i, k);
      q_[3] = R(k, j) - R(j, k);
    }
    q_ /= q_.norm();
  }

  /// Returns the rotation by the angle |scale * d| about the axis d.
  static SO3 exp(vectview<const S, 3> d, S scale = S(1)) {
    S x = scale * d[0], y = scale * d[1], z = scale * d[2];
    S square = x * x + y * y + z * z;
    if (!detail::allOf(square <= S(detail::kLongestTurn<S> * detail::kLongestTurn<S>))) {
      x = detail::shortenedTurn(x);
      y = detail::shortenedTurn(y);
      z = detail::shortenedTurn(z);
      square = x * x + y * y + z * z;
    }
    const auto [factor, w] = detail::branch(
        square < S(detail::epsilon<S>),
        [&] {
          return std::array<S, 2>{(S(1) - square / S(24)) / S(2), S(1) - square / S(8)};
        },  // series of sin(t/2)/t and cos(t/2)
        [&] {
          using std::sqrt;
          const S angle = sqrt(square);
          const auto [sine, cosine] = sinCos(S(angle / S(2)));
          return std::array<S, 2>{sine / angle, cosine};
        });
    SO3 result;
    result.q_ << factor * x, factor * y, factor * z, w;
    return result;
  }
  /// Returns the exponential of any Eigen expression, also of numbers that carry derivatives or are packs. So
  /// SO3<>::exp(angle * axis.vector()) compiles in a measurement function for every number type that it is called with.
  template <class D>
    requires(std::is_same_v<promote_t<S, typename D::Scalar>, typename D::Scalar> &&
             !std::is_convertible_v<const D&, vectview<const S, 3>>)
  static SO3<typename D::Scalar> exp(const Eigen::MatrixBase<D>& d) {
    EIGEN_STATIC_ASSERT_VECTOR_SPECIFIC_SIZE(D, 3)
    return SO3<typename D::Scalar>::exp(vect<3, typename D::Scalar>(d));
  }
  /// Returns the rotation vector with |.| <= pi whose exponential is R.
  static Vector log(const SO3& R) { return logFactor(R) * Vector(R.q_.template head<3>()); }
  /// Returns the logarithm of a rotation over numbers that carry derivatives or are packs.
  template <class T>
    requires(!std::is_same_v<T, S> && std::is_same_v<promote_t<S, T>, T>)
  static typename SO3<T>::Vector log(const SO3<T>& R) {
    return SO3<T>::log(R);
  }
  /// Returns the factor f in log(R) = f * (x, y, z).
  static S logFactor(const SO3& R) {
    const S sign = select(R.w() < S(0), S(-1), S(1));
    const S w = sign * R.w();
    const S square = R.q_.template head<3>().squaredNorm();
    return detail::branch(
        square < kSeriesLimit * w * w,  // 2 atan(n/w)/n = 2/w (1 - (n/w)^2/3 + ...)
        [&] { return S((sign * S(2) / w) * (S(1) - square / (S(3) * w * w))); },
        [&] {
          using std::atan2;
          using std::sqrt;
          const S norm = sqrt(square);
          return S(sign * S(2) * atan2(norm, w) / norm);
        });
  }

  /// Returns the real part of the unit quaternion: the cosine of half the angle, up to the sign of the quaternion.
  const S& w() const { return q_[3]; }
  /// Returns the imaginary part of the unit quaternion along x.
  const S& x() const { return q_[0]; }
  /// Returns the imaginary part of the unit quaternion along y.
  const S& y() const { return q_[1]; }
  /// Returns the imaginary part of the unit quaternion along z.
  const S& z() const { return q_[2]; }
  /// Returns (x, y, z, w).
  const Coefficients& coeffs() const { return q_; }
  /// Returns the quaternion. Include Eigen/Geometry to use it.
  Eigen::Quaternion<S> quaternion() const { return Eigen::Quaternion<S>(w(), x(), y(), z()); }

  /// Returns the 3 x 3 matrix; its columns are the images of the axes.
  Matrix toRotationMatrix() const {
    const S x2 = x() + x(), y2 = y() + y(), z2 = z() + z();
    const S xx = x() * x2, xy = x() * y2, xz = x() * z2, yy = y() * y2, yz = y() * z2, zz = z() * z2;
    const S wx = w() * x2, wy = w() * y2, wz = w() * z2;
    Matrix R;
    R << S(1) - (yy + zz), xy - wz, xz + wy,  //
        xy + wz, S(1) - (xx + zz), yz - wx,   //
        xz - wy, yz + wx, S(1) - (xx + yy);
    return R;
  }
  /// Returns the opposite rotation, R^T.
  SO3 inverse() const {
    SO3 result;
    result.q_ << -x(), -y(), -z(), w();
    return result;
  }
  SO3 operator*(const SO3& b) const {
    SO3 result;
    result.q_ << w() * b.x() + x() * b.w() + y() * b.z() - z() * b.y(),
        w() * b.y() - x() * b.z() + y() * b.w() + z() * b.x(),
        w() * b.z() + x() * b.y() - y() * b.x() + z() * b.w(),
        w() * b.w() - x() * b.x() - y() * b.y() - z() * b.z();
    result.renormalize();
    return result;
  }
  /// Rotates a point or a direction.
  template <class D>
    requires(bool(D::IsVectorAtCompileTime) && std::is_same_v<promote_t<S, typename D::Scalar>, S>)
  Vector operator*(const Eigen::MatrixBase<D>& p) const {
    static_assert(D::SizeAtCompileTime == 3 || D::SizeAtCompileTime == Dynamic, "mtk: SO3 rotates 3-vectors");
    const PlainVector<typename D::Scalar, 3> point = p;
    const S px(point[0]), py(point[1]), pz(point[2]);
    const S tx = S(2) * (y() * pz - z() * py);
    const S ty = S(2) * (z() * px - x() * pz);
    const S tz = S(2) * (x() * py - y() * px);
    return Vector(px + w() * tx + (y() * tz - z() * ty),  //
                  py + w() * ty + (z() * tx - x() * tz),  //
                  pz + w() * tz + (x() * ty - y() * tx));
  }

  void boxplus(vectview<const S, 3> d, S scale = S(1)) { *this = *this * exp(d, scale); }
  void boxminus(vectview<S, 3> out, const SO3& y) const { out = log(y.inverse() * *this); }

  struct MtkState {
    static constexpr bool adds = false;
    static auto& of(SO3& x) { return x.q_; }
    template <class X>
    static auto difference(const X& x, const SO3& z) {
      const auto from_z = z.inverse() * x;
      return decltype(z.inverse() * x)::log(from_z);
    }
  };

 private:
  /// Limit for how much entries of R^T R may differ from those of the identity.
  static constexpr double kRough = 0.5;
  static void requireRotation(const Matrix& R) {
    const Vector a = R.col(0), b = R.col(1), c = R.col(2);
    const S aa = a.dot(a), bb = b.dot(b), cc = c.dot(c), ab = a.dot(b), ac = a.dot(c), bc = b.dot(c);
    const S volume = (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] +
                     (a[0] * b[1] - a[1] * b[0]) * c[2];
    const auto near = [](const S& x, double y) { return x >= S(y - kRough) && x <= S(y + kRough); };
    const auto good = near(aa, 1) && near(bb, 1) && near(cc, 1) && near(ab, 0) && near(ac, 0) &&
                      near(bc, 0) && volume > S(0);
    if (detail::allOf(good)) return;
    const auto number = [&](int i, int j) { return detail::firstWithout(good, R(i, j)); };
    detail::raiseBadNumbers(
        "mtk.no-rotation", "a rotation (SO3) cannot be made of the matrix with the rows ",
        {number(0, 0), number(0, 1), number(0, 2), number(1, 0), number(1, 1), number(1, 2), number(2, 0),
         number(2, 1), number(2, 2)},
        ", whose columns are not orthonormal, or left-handed; pass a rotation matrix, or the one nearest to yours, "
        "U V^T of its singular value decomposition with determinant 1");
  }

  /// Squared tangent of the half angle below which two terms of the series are exact.
  static constexpr auto kSeriesLimit = 4 * detail::epsilon<S>;

  /// Takes one Newton step towards |q| = 1. The result is exact to rounding, because |q| deviates from 1 only by a few
  /// rounding errors.
  void renormalize() { q_ *= (S(3) - q_.squaredNorm()) / S(2); }

  Coefficients q_;
};

}  // namespace mtk

#include "mtk/types/so3_dual.hpp"
