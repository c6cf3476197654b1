#include "slom/tape/rotation.hpp"

#include <cmath>

namespace mtk {

namespace {

using slom::tape::Number;
using slom::tape::detail::newTangent;
using slom::tape::detail::setDerivative;
using slom::tape::detail::Term;
using Rotation = SO3<Number>;
using Tangent = Rotation::Tangent;
using Matrix = Rotation::Matrix;

/// Returns new unknowns t = A a + B b.
Tangent combined(const Matrix& A, const Tangent& a, const Matrix& B, const Tangent& b) {
  Tangent t;
  for (int i = 0; i < 3; ++i) {
    std::vector<Term> terms;
    for (int k = 0; k < 3; ++k) {
      terms.push_back({a[static_cast<std::size_t>(k)], A(i, k)});
      terms.push_back({b[static_cast<std::size_t>(k)], B(i, k)});
    }
    Number& own = t[static_cast<std::size_t>(i)];
    own = newTangent();
    setDerivative(own, terms);
  }
  return t;
}
Matrix identity() {
  Matrix I;
  for (int i = 0; i < 9; ++i) I(i % 3, i / 3) = Number(i % 4 == 0 ? 1 : 0);
  return I;
}
Tangent negated(const Tangent& a) {
  const bool is_none = a[0].isConstant() && a[1].isConstant() && a[2].isConstant();
  return is_none ? a : combined(-identity(), a, identity(), {});
}

}  // namespace

Rotation::SO3(const Coefficients& q, const Tangent& left, const Tangent& right)
    : q_(q), left_(left), right_(right) {
  const Number x2 = x() + x(), y2 = y() + y(), z2 = z() + z();
  const Number xx = x() * x2, xy = x() * y2, xz = x() * z2, yy = y() * y2, yz = y() * z2, zz = z() * z2;
  const Number wx = w() * x2, wy = w() * y2, wz = w() * z2, one(1);
  R_ << one - (yy + zz), xy - wz, xz + wy,  //
      xy + wz, one - (xx + zz), yz - wx,    //
      xz - wy, yz + wx, one - (xx + yy);
  if (isNone(left_) && isNone(right_)) return;
  const auto& [lx, ly, lz] = left_;
  const auto& [rx, ry, rz] = right_;
  const Number half(0.5), qw = half * w(), qx = half * x(), qy = half * y(), qz = half * z();
  // q (0, r) / 2 + (0, l) q / 2
  setDerivative(w(), {{rx, -qx}, {ry, -qy}, {rz, -qz}, {lx, -qx}, {ly, -qy}, {lz, -qz}});
  setDerivative(x(), {{rx, qw}, {ry, -qz}, {rz, qy}, {lx, qw}, {ly, qz}, {lz, -qy}});
  setDerivative(y(), {{rx, qz}, {ry, qw}, {rz, -qx}, {lx, -qz}, {ly, qw}, {lz, qx}});
  setDerivative(z(), {{rx, -qy}, {ry, qx}, {rz, qw}, {lx, qy}, {ly, -qx}, {lz, qw}});
  for (int i = 0; i < 3; ++i) {  // R [r]x + [l]x R
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Number &li = left_[static_cast<std::size_t>(j)], &lj = left_[static_cast<std::size_t>(k)];
    setDerivative(R_(i, 0), {{rz, R_(i, 1)}, {ry, -R_(i, 2)}, {li, R_(k, 0)}, {lj, -R_(j, 0)}});
    setDerivative(R_(i, 1), {{rx, R_(i, 2)}, {rz, -R_(i, 0)}, {li, R_(k, 1)}, {lj, -R_(j, 1)}});
    setDerivative(R_(i, 2), {{ry, R_(i, 0)}, {rx, -R_(i, 1)}, {li, R_(k, 2)}, {lj, -R_(j, 2)}});
  }
}

Rotation::SO3(const Number& w, const Number& x, const Number& y, const Number& z) {
  const Number norm = sqrt(w * w + x * x + y * y + z * z), inverse = Number(1) / norm;
  const Number qw = w * inverse, qx = x * inverse, qy = y * inverse, qz = z * inverse,
               f = Number(2) * inverse;
  Tangent right;  // 2 vec(q^-1 dq) / |q|
  if (!norm.isConstant()) {
    for (Number& own : right) own = newTangent();
    setDerivative(right[0], {{x, f * qw}, {w, -f * qx}, {z, -f * qy}, {y, f * qz}});
    setDerivative(right[1], {{y, f * qw}, {w, -f * qy}, {x, -f * qz}, {z, f * qx}});
    setDerivative(right[2], {{z, f * qw}, {w, -f * qz}, {y, -f * qx}, {x, f * qy}});
  }
  *this = SO3(Coefficients(qx, qy, qz, qw), right);
}

Rotation Rotation::exp(vectview<const Number, 3> d, Number scale) {
  const Vector v(scale * d[0], scale * d[1], scale * d[2]);
  const Number square = v.squaredNorm();
  const auto [factor, w] = detail::branch(
      square < Number(detail::epsilon<double>),
      [&] {
        return std::array<Number, 2>{(Number(1) - square / Number(24)) / Number(2),
                                     Number(1) - square / Number(8)};
      },
      [&] {
        const Number angle = sqrt(square);
        const auto [sine, cosine] = sinCos(Number(angle / Number(2)));
        return std::array<Number, 2>{sine / angle, cosine};
      });
  Tangent right;
  if (!square.isConstant()) {
    const auto J = detail::rightJacobian<Number>(v);
    for (int i = 0; i < 3; ++i) {
      Number& own = right[static_cast<std::size_t>(i)];
      own = newTangent();
      setDerivative(own, {{v[0], J(i, 0)}, {v[1], J(i, 1)}, {v[2], J(i, 2)}});
    }
  }
  return SO3(Coefficients(factor * v[0], factor * v[1], factor * v[2], w), right);
}

Rotation::Vector Rotation::log(const SO3& R) {
  const Number sign = select(R.w() < Number(0), Number(-1), Number(1)), w = sign * R.w();
  const Number square = R.x() * R.x() + R.y() * R.y() + R.z() * R.z();
  const Number factor = detail::branch(
      square < Number(4 * detail::epsilon<double>) * w * w,
      [&] { return (sign * Number(2) / w) * (Number(1) - square / (Number(3) * w * w)); },
      [&] {
        const Number norm = sqrt(square);
        return sign * Number(2) * atan2(norm, w) / norm;
      });
  const Vector v(factor * R.x(), factor * R.y(), factor * R.z());
  if (!isNone(R.left_) || !isNone(R.right_)) {
    const auto J = detail::inverseRightJacobian<Number>(v, factor, R.w());
    const auto &l = R.left_, &r = R.right_;
    for (int i = 0; i < 3; ++i) {
      setDerivative(v[i], {{r[0], J(i, 0)},
                           {r[1], J(i, 1)},
                           {r[2], J(i, 2)},
                           {l[0], J(0, i)},
                           {l[1], J(1, i)},
                           {l[2], J(2, i)}});
    }
  }
  return v;
}

Rotation Rotation::inverse() const {
  return SO3(Coefficients(-x(), -y(), -z(), w()), negated(right_), negated(left_));
}

Rotation Rotation::operator*(const SO3& b) const {
  const Coefficients q(w() * b.x() + x() * b.w() + y() * b.z() - z() * b.y(),
                       w() * b.y() - x() * b.z() + y() * b.w() + z() * b.x(),
                       w() * b.z() + x() * b.y() - y() * b.x() + z() * b.w(),
                       w() * b.w() - x() * b.x() - y() * b.y() - z() * b.z());
  // exp(left) A exp(right) exp(b.left) B exp(b.right): what is in the middle passes to one side.
  const bool has_middle = !isNone(right_) || !isNone(b.left_);
  if (!has_middle) return SO3(q, left_, b.right_);
  if (isNone(left_) && isNone(right_)) return SO3(q, combined(R_, b.left_, identity(), {}), b.right_);
  const Tangent middle = isNone(right_)    ? b.left_
                         : isNone(b.left_) ? right_
                                           : combined(identity(), right_, identity(), b.left_);
  return SO3(q, left_, combined(b.R_.transpose(), middle, identity(), b.right_));
}

Rotation::Vector Rotation::rotated(const Vector& p) const {
  return Vector(R_(0, 0) * p[0] + R_(0, 1) * p[1] + R_(0, 2) * p[2],
                R_(1, 0) * p[0] + R_(1, 1) * p[1] + R_(1, 2) * p[2],
                R_(2, 0) * p[0] + R_(2, 1) * p[1] + R_(2, 2) * p[2]);
}

}  // namespace mtk
