/// Rotations with derivatives.
///   state    a rotation R over plain numbers, and d (3 rows)
///            If the unknowns move by e, the rotation is R exp(d * e) to first order.
///   source   Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, section II.G and
///            appendix B; the right Jacobian of SO(3) and its inverse are (143) and (144)
/// Products, inverses, exp and log compute their derivative as a product with a 3x3 matrix, without the chain rule
/// through four coefficients.
#pragma once

#include <array>

#include "mtk/dual.hpp"
#include "mtk/types/so3.hpp"

namespace mtk {

namespace detail {

template <class S, std::uint64_t C>
using RowPartials = std::array<Partials<S, C>, 3>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3, Eigen::DontAlign>;

/// Returns M d.
template <class S, class P>
std::array<P, 3> multiply(const Matrix3<S>& M, const std::array<P, 3>& d) {
  std::array<P, 3> r;
  unrolled<P::count>([&](int k) {
    const auto a = d[0].v[k], b = d[1].v[k], c = d[2].v[k];
    unrolled<3>(
        [&](int i) { r[static_cast<std::size_t>(i)].v[k] = M(i, 0) * a + M(i, 1) * b + M(i, 2) * c; });
  });
  return r;
}
/// Returns d x p.
template <class S, class P>
std::array<P, 3> cross(const std::array<P, 3>& d, const vect<3, S>& p) {
  std::array<P, 3> r;
  unrolled<P::count>([&](int k) {
    const auto a = d[0].v[k], b = d[1].v[k], c = d[2].v[k];
    r[0].v[k] = p[2] * b - p[1] * c;
    r[1].v[k] = p[0] * c - p[2] * a;
    r[2].v[k] = p[1] * a - p[0] * b;
  });
  return r;
}
template <std::uint64_t A, std::uint64_t B, class S>
RowPartials<S, A | B> add(const RowPartials<S, A>& a, const RowPartials<S, B>& b) {
  const auto same = [](const auto& x) { return x; };
  const auto sum = [](const auto& x, const auto& y) { return x + y; };
  return {combine<A, B, S>(a[0], b[0], sum, same, same), combine<A, B, S>(a[1], b[1], sum, same, same),
          combine<A, B, S>(a[2], b[2], sum, same, same)};
}
template <class S, std::uint64_t C>
RowPartials<S, C> partialsOf(const PlainVector<SparseDual<S, C>, 3>& p) {
  return {p[0].partials(), p[1].partials(), p[2].partials()};
}
template <class S, std::uint64_t C>
vect<3, S> valueOf(const PlainVector<SparseDual<S, C>, 3>& p) {
  return vect<3, S>(p[0].value(), p[1].value(), p[2].value());
}
/// Returns the vector with this value and the derivatives M d.
template <class S, std::uint64_t C>
vect<3, SparseDual<S, C>> dualVector(const vect<3, S>& value, const Matrix3<S>& M,
                                     const RowPartials<S, C>& d) {
  vect<3, SparseDual<S, C>> result{Uninitialized()};
  unrolled<3>([&](int i) { result[i].value() = value[i]; });
  unrolled<Partials<S, C>::count>([&](int k) {
    const auto a = d[0].v[k], b = d[1].v[k], c = d[2].v[k];
    unrolled<3>([&](int i) { result[i].partials().v[k] = M(i, 0) * a + M(i, 1) * b + M(i, 2) * c; });
  });
  return result;
}

/// Returns alpha I + beta v v^T + gamma [v]x.
template <class S>
Matrix3<S> axialMatrix(const S& alpha, const S& beta, const S& gamma, const vect<3, S>& v) {
  const S bx = beta * v[0], by = beta * v[1], bz = beta * v[2];
  const S xy = bx * v[1], xz = bx * v[2], yz = by * v[2];
  const S gx = gamma * v[0], gy = gamma * v[1], gz = gamma * v[2];
  Matrix3<S> M;
  M << alpha + bx * v[0], xy - gz, xz + gy,  //
      xy + gz, alpha + by * v[1], yz - gx,   //
      xz - gy, yz + gx, alpha + bz * v[2];
  return M;
}
/// Returns J in exp(v + e) = exp(v) exp(J e), to first order.
template <class S>
Matrix3<S> rightJacobian(const vect<3, S>& v) {
  const S square = v.squaredNorm();
  const auto [a, b] = branch(
      square < S(1e-4),  // series of (1 - cos t) / t^2 and (t - sin t) / t^3
      [&] {
        return std::array<S, 2>{S(0.5) - square * (S(1.0 / 24) - square / S(720)),
                                S(1.0L / 6) - square * (S(1.0L / 120) - square / S(5040))};
      },
      [&] {
        using std::cos;
        using std::sin;
        using std::sqrt;
        const S angle = sqrt(square), half_sine = sin(S(angle / S(2)));
        return std::array<S, 2>{S(2) * half_sine * half_sine / square, (S(1) - sin(angle) / angle) / square};
      });
  return axialMatrix<S>(S(1) - b * square, b, -a, v);
}
/// Returns J in log(exp(v) exp(e)) = v + J e, to first order, for v = factor * (x, y, z) = log(R).
template <class S>
Matrix3<S> inverseRightJacobian(const vect<3, S>& v, const S& factor, const S& w) {
  const S square = v.squaredNorm();
  const S k = factor * w / S(2);  // (t/2) cot(t/2)
  const S c = branch(
      square < S(1e-4), [&] { return S(S(1.0L / 12) + square * (S(1.0L / 720) + square / S(30240))); },
      [&] { return S((S(1) - k) / square); });
  return axialMatrix<S>(k, c, S(0.5), v);
}

}  // namespace detail

template <class S, std::uint64_t C>
class SO3<SparseDual<S, C>> {
 public:
  using scalar = SparseDual<S, C>;
  using Value = SO3<S>;
  using RowPartials = detail::RowPartials<S, C>;
  static constexpr int DOF = 3;
  static constexpr int DIM = 3;
  using Matrix = Eigen::Matrix<scalar, 3, 3, Eigen::DontAlign>;
  using Coefficients = PlainVector<scalar, 4>;
  using Vector = vect<3, scalar>;

  /// No rotation.
  SO3() { d_.fill(detail::Partials<S, C>::zero()); }
  /// A constant.
  template <class T>
    requires(std::is_same_v<T, S> || std::is_arithmetic_v<T>)
  SO3(const SO3<T>& R) : R_(R) {  // NOLINT(google-explicit-constructor): nothing is lost
    d_.fill(detail::Partials<S, C>::zero());
  }
  SO3(const Value& R, const RowPartials& d) : R_(R), d_(d) {}
  /// Converts the rotation to one with more unknowns.
  template <std::uint64_t A>
    requires((A & ~C) == 0 && A != C)
  SO3(const SO3<SparseDual<S, A>>& R)  // NOLINT(google-explicit-constructor): nothing is lost
      : R_(R.value()), d_(detail::add<A, C, S>(R.partials(), SO3().d_)) {}
  /// Creates a rotation from quaternion coefficients, which are normalised; note the order.
  SO3(const scalar& w, const scalar& x, const scalar& y, const scalar& z)
      : R_(w.value(), x.value(), y.value(), z.value()) {
    // d = 2 vec(q^-1 dq) / |q|
    using std::sqrt;
    const S norm = sqrt(
        S(w.value() * w.value() + x.value() * x.value() + y.value() * y.value() + z.value() * z.value()));
    const S f = S(2) / norm, qw = f * R_.w(), qx = f * R_.x(), qy = f * R_.y(), qz = f * R_.z();
    for (int k = 0; k < detail::Partials<S, C>::count; ++k) {
      const auto dw = w.partials().v[k], dx = x.partials().v[k], dy = y.partials().v[k],
                 dz = z.partials().v[k];
      d_[0].v[k] = qw * dx - qx * dw - qy * dz + qz * dy;
      d_[1].v[k] = qw * dy - qy * dw - qz * dx + qx * dz;
      d_[2].v[k] = qw * dz - qz * dw - qx * dy + qy * dx;
    }
  }
  /// Creates a rotation from a rotation matrix.
  template <class D>
    requires(D::RowsAtCompileTime == 3 && D::ColsAtCompileTime == 3 &&
             std::is_same_v<typename D::Scalar, scalar>)
  explicit SO3(const Eigen::MatrixBase<D>& M) {
    Eigen::Matrix<S, 3, 3> value;
    for (int i = 0; i < 9; ++i) value(i % 3, i / 3) = M(i % 3, i / 3).value();
    R_ = Value(value);
    const detail::Matrix3<S> back = R_.inverse().toRotationMatrix();
    const auto rotated = [&](int column) {
      return detail::multiply<S>(back, detail::partialsOf<S, C>(M.col(column)));
    };
    // columns of R^-1 dR; [d]x is its antisymmetric part
    const auto x = rotated(0), y = rotated(1), z = rotated(2);
    for (int k = 0; k < detail::Partials<S, C>::count; ++k) {
      d_[0].v[k] = S(0.5) * (y[2].v[k] - z[1].v[k]);
      d_[1].v[k] = S(0.5) * (z[0].v[k] - x[2].v[k]);
      d_[2].v[k] = S(0.5) * (x[1].v[k] - y[0].v[k]);
    }
  }

  static SO3 exp(vectview<const scalar, 3> d) {
    const PlainVector<scalar, 3> v = d;
    const vect<3, S> value = detail::valueOf<S, C>(v);
    return {Value::exp(value),
            detail::multiply<S>(detail::rightJacobian<S>(value), detail::partialsOf<S, C>(v))};
  }
  static SO3 exp(vectview<const scalar, 3> d, const scalar& scale) { return exp(Vector(scale * d)); }
  static Vector log(const SO3& R) {
    const S factor = Value::logFactor(R.R_);
    const vect<3, S> v(factor * R.R_.x(), factor * R.R_.y(), factor * R.R_.z());
    return detail::dualVector<S, C>(v, detail::inverseRightJacobian<S>(v, factor, R.R_.w()), R.d_);
  }

  /// Returns the rotation without its derivatives.
  const Value& value() const { return R_; }
  const RowPartials& partials() const { return d_; }
  Value& value() { return R_; }
  RowPartials& partials() { return d_; }

  scalar w() const { return coefficient(R_.w(), -R_.x(), -R_.y(), -R_.z()); }
  scalar x() const { return coefficient(R_.x(), R_.w(), -R_.z(), R_.y()); }
  scalar y() const { return coefficient(R_.y(), R_.z(), R_.w(), -R_.x()); }
  scalar z() const { return coefficient(R_.z(), -R_.y(), R_.x(), R_.w()); }
  /// Returns (x, y, z, w).
  Coefficients coeffs() const { return Coefficients(x(), y(), z(), w()); }
  Eigen::Quaternion<scalar> quaternion() const { return Eigen::Quaternion<scalar>(w(), x(), y(), z()); }

  Matrix toRotationMatrix() const {
    const detail::Matrix3<S> R = R_.toRotationMatrix();
    Matrix M;  // d(R e_j) = R (d x e_j)
    for (int j = 0; j < 3; ++j) {
      vect<3, S> e;
      e[j] = S(1);
      M.col(j) = detail::dualVector<S, C>(vect<3, S>(R.col(j)), R, detail::cross<S>(d_, e));
    }
    return M;
  }
  SO3 inverse() const {
    detail::Matrix3<S> negative = -R_.toRotationMatrix();
    return {R_.inverse(), detail::multiply<S>(negative, d_)};
  }

  void boxplus(vectview<const scalar, 3> d, const scalar& scale = scalar(1)) {
    *this = *this * exp(d, scale);
  }
  void boxminus(vectview<scalar, 3> out, const SO3& y) const { out = log(y.inverse() * *this); }

  struct MtkState {
    static void seed(SO3& y, const Value& x, const auto& column) {
      y.R_ = x;
      for (int i = 0; i < 3; ++i) {
        scalar row;
        row.seed(0.0, column(i));
        y.d_[static_cast<std::size_t>(i)] = row.partials();
      }
    }
  };

 private:
  /// Returns the coefficient with value `value` and derivative (a, b, c) / 2 with respect to d: dq = q (0, d) / 2.
  scalar coefficient(const S& value, const S& a, const S& b, const S& c) const {
    detail::Partials<S, C> d;
    for (int k = 0; k < d.count; ++k) d.v[k] = S(0.5) * (a * d_[0].v[k] + b * d_[1].v[k] + c * d_[2].v[k]);
    return {value, d};
  }

  Value R_;
  RowPartials d_;
};

// Products in which at least one factor carries derivatives. The other may be a constant.

namespace detail {
template <class A, class B>
concept OneIsDual = requires { typename promote_t<A, B>; } && (is_dual<A> || is_dual<B>);
template <class A, class B>
concept PackAndBuiltIn =
    !is_dual<A> && !is_dual<B> && !std::is_same_v<A, B> && requires { typename promote_t<A, B>; };

/// The number type without the derivatives.
template <class D>
using ValueType = typename D::Value;

template <class S, class X>
SO3<S> rotationValue(const SO3<X>& R) {
  if constexpr (is_dual<X>) {
    return R.value();
  } else {
    return SO3<S>(R);
  }
}
}  // namespace detail

template <class A, class B>
  requires detail::OneIsDual<A, B>
SO3<promote_t<A, B>> operator*(const SO3<A>& a, const SO3<B>& b) {
  using D = promote_t<A, B>;
  using S = detail::ValueType<D>;
  const SO3<S> left = detail::rotationValue<S>(a), right = detail::rotationValue<S>(b);
  if constexpr (!detail::is_dual<A>) {
    return {left * right, b.partials()};
  } else {
    const auto moved =
        detail::multiply<S>(detail::Matrix3<S>(right.inverse().toRotationMatrix()), a.partials());
    if constexpr (detail::is_dual<B>) {
      return {left * right, detail::add<A::columns, B::columns, S>(moved, b.partials())};
    } else {
      return {left * right, moved};
    }
  }
}
template <class A, class B>
  requires detail::PackAndBuiltIn<A, B>
SO3<promote_t<A, B>> operator*(const SO3<A>& a, const SO3<B>& b) {
  using S = promote_t<A, B>;
  return SO3<S>(a) * SO3<S>(b);
}

namespace detail {
/// True if E is a vector of unknowns, see mtk/types/seed.hpp.
template <class E>
inline constexpr bool is_seed_vector = false;
}  // namespace detail

/// Rotates a point or a direction.
template <class A, class E>
  requires(detail::OneIsDual<A, typename E::Scalar> && bool(E::IsVectorAtCompileTime) &&
           !detail::is_seed_vector<E>)
auto operator*(const SO3<A>& R, const Eigen::MatrixBase<E>& point) {
  static_assert(E::SizeAtCompileTime == 3 || E::SizeAtCompileTime == Dynamic, "mtk: SO3 rotates 3-vectors");
  using B = typename E::Scalar;
  using D = promote_t<A, B>;
  using S = detail::ValueType<D>;
  const PlainVector<B, 3> p = point;
  const detail::Matrix3<S> M = detail::rotationValue<S>(R).toRotationMatrix();
  if constexpr (!detail::is_dual<B>) {
    const vect<3, S> value(p);
    return detail::dualVector<S, D::columns>(vect<3, S>(M * value), M, detail::cross<S>(R.partials(), value));
  } else {
    const vect<3, S> value = detail::valueOf<S, B::columns>(p);
    const auto dp = detail::partialsOf<S, B::columns>(p);
    if constexpr (detail::is_dual<A>) {  // d(R p) = R (dp + d x p)
      return detail::dualVector<S, D::columns>(
          vect<3, S>(M * value), M,
          detail::add<A::columns, B::columns, S>(detail::cross<S>(R.partials(), value), dp));
    } else {
      return detail::dualVector<S, D::columns>(vect<3, S>(M * value), M, dp);
    }
  }
}
template <class A, class E>
  requires(detail::PackAndBuiltIn<A, typename E::Scalar> &&
           !std::is_same_v<promote_t<A, typename E::Scalar>, A> && bool(E::IsVectorAtCompileTime))
auto operator*(const SO3<A>& R, const Eigen::MatrixBase<E>& point) {
  return SO3<typename E::Scalar>(R) * point;
}

}  // namespace mtk
