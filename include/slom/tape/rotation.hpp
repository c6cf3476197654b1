/// Rotations of recorded numbers.
///   state    a unit quaternion, its matrix, and perturbations l and r of 3 unknowns each: exp(l) R exp(r)
/// A product, logarithm or rotated point states its derivatives by these perturbations. The chain rule then does not
/// pass through the coefficients of quaternions. As |q| = 1 holds, products are not normalised again.
///   source   Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, appendix B
#pragma once

#include <array>

#include "mtk/rebind.hpp"
#include "slom/tape/number.hpp"
#include "slom/tape/recording.hpp"

namespace mtk {

template <>
class SO3<slom::tape::Number> {
  using Number = slom::tape::Number;

 public:
  using scalar = Number;
  static constexpr int DOF = 3;
  static constexpr int DIM = 3;  ///< dimension of the space it acts on
  static constexpr std::array<std::string_view, 3> component_names = detail::xyz_names;
  using Matrix = Eigen::Matrix<Number, 3, 3, Eigen::DontAlign>;
  using Coefficients = PlainVector<Number, 4>;
  using Vector = vect<3, Number>;
  /// A perturbation; constants 0 if there is none.
  using Tangent = std::array<Number, 3>;

  /// No rotation.
  SO3() : SO3(Coefficients(Number(0), Number(0), Number(0), Number(1)), {}, {}) {}
  /// Creates a rotation from quaternion coefficients, which are normalised; note the order.
  SO3(const Number& w, const Number& x, const Number& y, const Number& z);
  // Eigen/Core declares the names of Eigen's rotations. A program that has such a rotation includes Eigen/Geometry.
  template <class Q>
    requires std::is_same_v<Q, Eigen::Quaternion<slom::tape::Number>>
  SO3(const Q& q) : SO3(q.w(), q.x(), q.y(), q.z()) {}  // NOLINT(google-explicit-constructor): the same thing
  /// Converts a constant.
  SO3(const SO3<double>& R)  // NOLINT(google-explicit-constructor): nothing is lost
      : SO3(Coefficients(Number(R.x()), Number(R.y()), Number(R.z()), Number(R.w())), {}, {}) {}
  /// Creates the rotation with these coefficients (x, y, z, w) of length 1, which is moved by these unknowns on the
  /// right.
  SO3(const Coefficients& q, const Tangent& right) : SO3(q, {}, right) {}

  /// Returns the rotation by the angle |scale * d| about the axis d.
  static SO3 exp(vectview<const Number, 3> d, Number scale = Number(1));
  template <class D>
    requires(std::is_same_v<promote_t<Number, typename D::Scalar>, Number> &&
             !std::is_convertible_v<const D&, vectview<const Number, 3>>)
  static SO3 exp(const Eigen::MatrixBase<D>& d) {
    return exp(Vector(d));
  }
  /// Returns the rotation vector with |.| <= pi whose exponential is R.
  static Vector log(const SO3& R);

  const Number& w() const { return q_[3]; }
  const Number& x() const { return q_[0]; }
  const Number& y() const { return q_[1]; }
  const Number& z() const { return q_[2]; }
  /// Returns (x, y, z, w).
  const Coefficients& coeffs() const { return q_; }
  template <class N = slom::tape::Number>
  Eigen::Quaternion<N> quaternion() const {
    return Eigen::Quaternion<N>(w(), x(), y(), z());
  }
  /// Returns the 3 x 3 matrix; its columns are the images of the axes.
  const Matrix& toRotationMatrix() const { return R_; }
  /// Returns the opposite rotation, R^T.
  SO3 inverse() const;
  SO3 operator*(const SO3& b) const;
  /// Rotates a point or a direction.
  template <class D>
    requires(bool(D::IsVectorAtCompileTime) &&
             std::is_same_v<promote_t<slom::tape::Number, typename D::Scalar>, slom::tape::Number>)
  Vector operator*(const Eigen::MatrixBase<D>& p) const {
    const PlainVector<typename D::Scalar, 3> point = p;
    return rotated(Vector(Number(point[0]), Number(point[1]), Number(point[2])));
  }

  void boxplus(vectview<const Number, 3> d, Number scale = Number(1)) { *this = *this * exp(d, scale); }
  void boxminus(vectview<Number, 3> out, const SO3& y) const { out = log(y.inverse() * *this); }

  struct MtkState {
    static constexpr bool adds = false;
    static const Coefficients& of(const SO3& x) { return x.q_; }
    static Vector difference(const SO3& x, const SO3& z) { return log(z.inverse() * x); }
  };

 private:
  SO3(const Coefficients& q, const Tangent& left, const Tangent& right);
  Vector rotated(const Vector& p) const;
  static bool isNone(const Tangent& t) { return t[0].isConstant() && t[1].isConstant() && t[2].isConstant(); }

  Coefficients q_;
  Matrix R_;
  Tangent left_, right_;
};

}  // namespace mtk
