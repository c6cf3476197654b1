// Exponential and logarithm against long double formulas, to 1e-14 relative (double) at easy and hard angles.
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <mtk/dual.hpp>
#include <mtk/mtk.hpp>
#include <mtk/pack.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using Long = long double;
using LongVector = Eigen::Matrix<Long, 3, 1>;
constexpr Long kLongPi = 3.14159265358979323846264338327950288L;

/// Angles from the smallest number to pi, both sides.
std::vector<Long> angles(Long epsilon, Long least) {
  std::vector<Long> all{
      0, least, least * 1e3L, std::sqrt(least), std::sqrt(least) * 10, epsilon, std::sqrt(epsilon)};
  for (Long a = 1e-20L; a < 3; a *= 3) all.push_back(a);
  for (Long d = 1; d > epsilon; d /= 5) all.push_back(kLongPi - d);
  all.push_back(kLongPi);
  return all;
}

template <class S>
class ExpLog : public ::testing::Test {
 protected:
  static constexpr Long kEpsilon = std::numeric_limits<S>::epsilon();
  static constexpr Long kTolerance = std::is_same_v<S, double> ? 1e-14L : 6e-7L;

  LongVector direction() {
    std::normal_distribution<double> normal;
    LongVector v(normal(rng_), normal(rng_), normal(rng_));
    return v / v.norm();
  }
  std::mt19937 rng_{3};
};
using Scalars = ::testing::Types<double, float>;
TYPED_TEST_SUITE(ExpLog, Scalars);

/// Components relative to the norm; below `floor` absolute errors of one unit are all that the format has.
template <class A, class B>
Long relativeError(const A& got, const B& want, Long floor = 0) {
  const LongVector difference = got.template cast<Long>() - want;
  return difference.norm() / std::max(want.norm(), floor);
}

TYPED_TEST(ExpLog, OfSO3) {
  using S = TypeParam;
  const Long least = std::numeric_limits<S>::min();
  for (const Long angle : angles(this->kEpsilon, least)) {
    for (int i = 0; i < 50; ++i) {
      const mtk::vect<3, S> v = (angle * this->direction()).template cast<S>();
      const LongVector exact = v.template cast<Long>();
      const Long t = std::hypot(exact[0], exact[1], exact[2]);
      const auto R = mtk::SO3<S>::exp(v);
      const LongVector imaginary = exact * (t > 0 ? std::sin(t / 2) / t : Long(0.5));
      EXPECT_LE(relativeError(R.coeffs().template head<3>(), imaginary, 1e3L * least), this->kTolerance) << t;
      EXPECT_LE(std::abs(R.w() - std::cos(t / 2)), this->kTolerance) << t;

      // The logarithm of exactly this quaternion.
      const LongVector q = R.coeffs().template head<3>().template cast<Long>();
      const Long w = R.w(), n = std::hypot(q[0], q[1], q[2]);
      const Long full = n > 0 ? 2 * std::atan2(n, std::abs(w)) / n * (w < 0 ? -1 : 1) : Long(2);
      EXPECT_LE(relativeError(mtk::SO3<S>::log(R), LongVector(full * q), 1e3L * least), this->kTolerance)
          << t;
      if (t < kLongPi * (1 - 2 * this->kEpsilon)) {  // nearer to pi, rounding may lead to the other side
        EXPECT_LE(relativeError(mtk::SO3<S>::log(R), exact, 1e3L * least), 2 * this->kTolerance) << t;
      }
    }
  }
}

TYPED_TEST(ExpLog, OfSO3TurnsPointsAsRodriguesDoes) {
  using S = TypeParam;
  for (const Long angle : angles(this->kEpsilon, std::numeric_limits<S>::min())) {
    const mtk::vect<3, S> v = (angle * this->direction()).template cast<S>();
    const mtk::vect<3, S> p = this->direction().template cast<S>();
    const LongVector k = v.template cast<Long>(), x = p.template cast<Long>();
    const Long t = k.norm();
    LongVector rotated = x;
    if (t > 0) {
      rotated =
          std::cos(t) * x + (std::sin(t) / t) * k.cross(x) + ((1 - std::cos(t)) / (t * t)) * k.dot(x) * k;
    }
    const auto R = mtk::SO3<S>::exp(v);
    EXPECT_LE(relativeError(R * p, rotated), 2 * this->kTolerance);
    EXPECT_LE(relativeError(R.toRotationMatrix() * p, rotated), 2 * this->kTolerance);
    EXPECT_LE(relativeError(R.inverse() * (R * p), x), 2 * this->kTolerance);
  }
}

TYPED_TEST(ExpLog, OfSO2) {
  using S = TypeParam;
  for (const Long angle : angles(this->kEpsilon, std::numeric_limits<S>::min())) {
    for (const Long sign : {-1, 1}) {
      for (int turns = -3; turns <= 3; ++turns) {
        const S a = S(sign * angle + 2 * kLongPi * turns);
        const Long expected = std::remainder(Long(a), 2 * kLongPi);
        const Long got = mtk::SO2<S>::log(mtk::SO2<S>::exp(mtk::vect<1, S>(a)))[0];
        const Long error = std::abs(std::remainder(got - expected, 2 * kLongPi));
        EXPECT_LE(error, this->kTolerance * std::max(std::abs(expected), turns == 0 ? Long(0) : Long(1)))
            << Long(a);
        EXPECT_GE(got, -kLongPi - this->kEpsilon);
        EXPECT_LE(got, kLongPi + this->kEpsilon);
      }
    }
  }
}

TYPED_TEST(ExpLog, OfS2WalksTheGreatCircle) {
  using S = TypeParam;
  for (const Long angle : angles(this->kEpsilon, std::numeric_limits<S>::min())) {
    for (int i = 0; i < 50; ++i) {
      const mtk::S2<S> x(this->direction().template cast<S>());
      const LongVector from = x.vector().template cast<Long>();
      const Long phi = 2 * kLongPi * i / 50;
      mtk::S2<S> y = x;
      const mtk::vect<2, S> d(S(angle * std::cos(phi)), S(angle * std::sin(phi)));
      y.boxplus(d);
      const LongVector to = y.vector().template cast<Long>();
      const Long walked = std::atan2(from.cross(to).norm(), from.dot(to));
      EXPECT_NEAR(double(walked), double(angle), double(4 * this->kTolerance));
      EXPECT_NEAR(double(to.norm()), 1.0, double(this->kTolerance));
      mtk::vect<2, S> back;
      y.boxminus(back, x);
      EXPECT_NEAR(double(back.norm()), double(walked), double(4 * this->kTolerance));
    }
  }
}

TEST(S2, OppositeDirectionsArePiApartAlongTheFirstAxis) {
  const mtk::S2<> x(0.0, 0.0, 1.0), y(0.0, 0.0, -1.0);
  EXPECT_EQ(mtk::difference(y, x), (mtk::PlainVector<double, 2>(M_PI, 0)));
}

TEST(S2, RefusesAVectorWithoutDirection) {
  const auto text = [](const std::string& vector) {
    return "[mtk.no-direction] a direction (S2) cannot be made of the vector " + vector +
           ", which is zero or not finite; pass a finite vector of any positive length";
  };
  EXPECT_EQ(messageOf([] { mtk::S2<>(mtk::vect<3>(0, 0, 0)); }), text("(0, 0, 0)"));
  EXPECT_EQ(messageOf([] { mtk::S2<>(mtk::vect<3>(NAN, 0, 1)); }), text("(nan, 0, 1)"));
  EXPECT_EQ(messageOf([] { mtk::S2<>(mtk::vect<3>(INFINITY, 0, 0)); }), text("(inf, 0, 0)"));
  EXPECT_EQ(mtk::S2<>(0.0, 1e-300, 0.0).y(), 1);
  EXPECT_NEAR(mtk::S2<>(3e300, 4e300, 0.0).x(), 0.6, 1e-15);
}

TEST(SO3, RefusesWhatIsNoRotation) {
  const auto text = [](const std::string& q) {
    return "[mtk.no-rotation] a rotation (SO3) cannot be made of the quaternion (w, x, y, z) = " + q +
           ", whose length is zero, not finite or far from 1; pass finite coefficients of a length near 1, which are then normalised";
  };
  EXPECT_EQ(messageOf([] { mtk::SO3<>(0, 0, 0, 0); }), text("(0, 0, 0, 0)"));
  EXPECT_EQ(messageOf([] { mtk::SO3<>(1e-200, 0, 1e-200, 0); }), text("(1e-200, 0, 1e-200, 0)"));
  EXPECT_EQ(messageOf([] { mtk::SO3<>(1e200, 0, 0, 1); }), text("(1e+200, 0, 0, 1)"));
  EXPECT_EQ(messageOf([] { mtk::SO3<>(1, NAN, 0, 0); }), text("(1, nan, 0, 0)"));
  EXPECT_EQ(messageOf([] { mtk::SO3<>(1, 0, 0, -INFINITY); }), text("(1, 0, 0, -inf)"));
  for (const double size : {1e-100, 0.5, 3.0, 1e100})
    EXPECT_NEAR(mtk::SO3<>(size, 0, 0, -size).w(), std::sqrt(0.5), 1e-15) << size;
  EXPECT_THROW((mtk::SO3<float>(1e-30f, 0, 0, 0)), mtk::Error);
  using P = mtk::Pack<4>;
  P w(1.0);
  w.set(2, 0);
  EXPECT_EQ(messageOf([&] { mtk::SO3<P>(w, P(0.0), P(0.0), P(0.0)); }), text("(0, 0, 0, 0)"));
  using D = mtk::Dual<double, 1>;
  EXPECT_EQ(messageOf([&] { mtk::SO3<D>(D(0), D(0), D(0), D(0)); }), text("(0, 0, 0, 0)"));
}

TEST(SO3, RefusesAMatrixThatIsNoRotation) {
  const auto text = [](const std::string& rows) {
    return "[mtk.no-rotation] a rotation (SO3) cannot be made of the matrix with the rows " + rows +
           ", whose columns are not orthonormal, or left-handed; pass a rotation matrix, or the one nearest to yours, U V^T of its "
           "singular value decomposition with determinant 1";
  };
  EXPECT_EQ(messageOf([] { mtk::SO3<>(Eigen::Matrix3d(Eigen::Matrix3d::Zero())); }),
            text("(0, 0, 0, 0, 0, 0, 0, 0, 0)"));
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M(2, 2) = -1;
  EXPECT_EQ(messageOf([&] { mtk::SO3<> R(M); }), text("(1, 0, 0, 0, 1, 0, 0, 0, -1)"));
  EXPECT_EQ(messageOf([&] { mtk::SO3<> R(Eigen::Matrix3d(2 * Eigen::Matrix3d::Identity())); }),
            text("(2, 0, 0, 0, 2, 0, 0, 0, 2)"));
  M(2, 2) = NAN;
  EXPECT_EQ(messageOf([&] { mtk::SO3<> R(M); }), text("(1, 0, 0, 0, 1, 0, 0, 0, nan)"));
}

TEST(SO2, RefusesAMatrixThatIsNoRotation) {
  const auto text = [](const std::string& rows) {
    return "[mtk.no-rotation] a rotation (SO2) cannot be made of the matrix with the rows " + rows +
           ", which is a reflection, zero or not finite; pass a rotation matrix";
  };
  Eigen::Matrix2d M = Eigen::Matrix2d::Zero();
  EXPECT_EQ(messageOf([&] { mtk::SO2<> R(M); }), text("(0, 0, 0, 0)"));
  M << 0, 1, 1, 0;
  EXPECT_EQ(messageOf([&] { mtk::SO2<> R(M); }), text("(0, 1, 1, 0)"));
  M(0, 0) = INFINITY;
  EXPECT_EQ(messageOf([&] { mtk::SO2<> R(M); }), text("(inf, 1, 1, 0)"));
  M << 0, -3, 3, 0.1;
  EXPECT_NEAR(mtk::SO2<>(M).angle(), M_PI / 2, 0.02);
}

/// Against the C library, which reduces arguments of any size exactly.
TEST(SO2, WrapsAnglesOfAnySize) {
  using P = mtk::Pack<4>;
  using D = mtk::Dual<double, 1>;
  for (double a : {4.0, 100.0, 1234.5, 1e5, 1e8 + 0.1, 1e12, 1e15, 1e16, 3e17, 1e22, 1e100, 1e308}) {
    for (const double sign : {1.0, -1.0}) {
      a *= sign;
      const double wrapped = mtk::SO2<>(a).angle();
      EXPECT_GE(wrapped, -M_PI);
      EXPECT_LT(wrapped, M_PI);
      EXPECT_NEAR(std::sin(wrapped), std::sin(a), 1e-12) << a;
      EXPECT_NEAR(std::cos(wrapped), std::cos(a), 1e-12) << a;
      EXPECT_EQ(mtk::SO2<P>(P(a)).angle()[1], wrapped) << a;
      D x;
      x.seed(a, 0);
      EXPECT_EQ(mtk::SO2<D>(x).angle().value(), wrapped);
      EXPECT_EQ(mtk::SO2<D>(x).angle().partial(0), 1);
    }
  }
  EXPECT_TRUE(std::isnan(mtk::SO2<>(INFINITY).angle()));
}

TEST(SO3, StaysAUnitQuaternionOverAMillionProducts) {
  const auto step = mtk::SO3<>::exp(mtk::vect<3>(0.1, 0.2, -0.3));
  mtk::SO3<> R;
  for (int i = 0; i < 1'000'000; ++i) R = R * step;
  EXPECT_NEAR(R.coeffs().norm(), 1, 1e-14);
}

TEST(SO3, FromARoughRotationMatrixIsARotationNearIt) {
  Eigen::Matrix3d M = mtk::SO3<>::exp(mtk::vect<3>(1, 2, -0.5)).toRotationMatrix();
  M(0, 1) += 4e-5;
  const mtk::SO3<> R(M);
  EXPECT_NEAR(R.coeffs().norm(), 1, 1e-15);
  EXPECT_LT((Eigen::Matrix3d(R.toRotationMatrix()) - M).norm(), 1e-4);
}

}  // namespace
