// Noise statements: W^T W is the inverse covariance for every form and shape, and every fault is named.
#include <cstdlib>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;

typedef mtk::vect<3> vec3;
SLOM_BUILD_MEASUREMENT(Position, 3, ((vec3, x)), ((vec3, z)))
SLOM_IMPLEMENT_MEASUREMENT(Position, ret) { ret = *x - z; }

/// Returns W as the library applies it: the whitened residuals of unit residuals.
template <class N>
Matrix3d whiteningOf(const N& noise) {
  Matrix3d W;
  for (int j = 0; j < 3; ++j) {
    slom::Estimator est;
    const auto x = est.insertRV(vec3());
    const auto m = est.insertMeasurement(Position(x, vec3(-Vector3d::Unit(j))), noise);
    W.col(j) = est.whitenedResidual(m);
    EXPECT_EQ(est.residual(m), Vector3d(Vector3d::Unit(j)));
  }
  return W;
}

Matrix3d information(const Matrix3d& W) { return W.transpose() * W; }

TEST(Noise, EveryFormAndShapeGivesTheInverseCovariance) {
  std::mt19937 rng(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    Matrix3d A;
    for (double& a : A.reshaped()) a = normal(rng);
    const Matrix3d covariance = A * A.transpose() + 0.1 * Matrix3d::Identity(),
                   inverse = covariance.inverse();
    const Matrix3d L = covariance.llt().matrixL(), L_inverse = L.inverse();
    const double tolerance = 1e-10 * inverse.norm();
    EXPECT_LT((information(whiteningOf(slom::Covariance(covariance))) - inverse).norm(), tolerance);
    EXPECT_LT((information(whiteningOf(slom::StandardDeviation(L))) - inverse).norm(), tolerance);
    EXPECT_LT((information(whiteningOf(slom::InvCovariance(inverse))) - inverse).norm(), tolerance);
    EXPECT_LT((information(whiteningOf(
                   slom::InvStandardDeviation(Matrix3d(L_inverse.triangularView<Eigen::Lower>())))) -
               inverse)
                  .norm(),
              tolerance);

    const Vector3d variance(0.1 + std::abs(normal(rng)), 2, 3e4);
    const Matrix3d diagonal = variance.cwiseInverse().asDiagonal();
    EXPECT_LT((information(whiteningOf(slom::Covariance(variance))) - diagonal).norm(),
              1e-12 * diagonal.norm());
    EXPECT_LT((information(whiteningOf(slom::StandardDeviation(variance.cwiseSqrt()))) - diagonal).norm(),
              1e-12 * diagonal.norm());
    EXPECT_LT((information(whiteningOf(slom::InvCovariance(variance.cwiseInverse()))) - diagonal).norm(),
              1e-12 * diagonal.norm());
    EXPECT_LT(
        (information(whiteningOf(slom::InvStandardDeviation(variance.cwiseInverse().cwiseSqrt()))) - diagonal)
            .norm(),
        1e-12 * diagonal.norm());
  }
  EXPECT_EQ(whiteningOf(slom::Covariance(4)), Matrix3d(0.5 * Matrix3d::Identity()));
  EXPECT_EQ(whiteningOf(slom::StandardDeviation(0.5f)), Matrix3d(2 * Matrix3d::Identity()));
  EXPECT_EQ(whiteningOf(slom::InvCovariance(4.0)), Matrix3d(2 * Matrix3d::Identity()));
  EXPECT_EQ(whiteningOf(slom::InvStandardDeviation(4.0)), Matrix3d(4 * Matrix3d::Identity()));
  EXPECT_EQ(whiteningOf(slom::UnitCovariance()), Matrix3d(Matrix3d::Identity()));
}

/// With information L L^T, whitening by L instead of L^T gives another cost: r^T L^T L r. Known by hand for
/// L = (2 0; 1 1), r = (1, 1): information (4 2; 2 2), cost 10; the wrong triangle gives 13.
TEST(Noise, UsesTheRightTriangle) {
  slom::Estimator est;
  const auto x = est.insertRV(Vector2d(1, 1));
  const Matrix2d information = (Matrix2d() << 4, 2, 2, 2).finished();
  est.insertMeasurement([](const Vector2d& v) { return v; }, x, slom::InvCovariance(information));
  EXPECT_NEAR(est.getRSS(), 10, 1e-12);
  slom::Estimator other;
  const auto y = other.insertRV(Vector2d(1, 1));
  other.insertMeasurement([](const Vector2d& v) { return v; }, y,
                          slom::Covariance(Matrix2d(information.inverse())));
  EXPECT_NEAR(other.getRSS(), 10, 1e-12);
}

TEST(Noise, AcceptsStronglyScaledCovariances) {
  const Vector3d scale(1e-9, 1, 1e9);
  const Matrix3d correlation = (Matrix3d() << 1, 0.9, 0, 0.9, 1, -0.3, 0, -0.3, 1).finished();
  const Matrix3d covariance = scale.asDiagonal() * correlation * scale.asDiagonal();
  const Matrix3d W = whiteningOf(slom::Covariance(covariance));
  EXPECT_LT((W * covariance * W.transpose() - Matrix3d::Identity()).norm(), 1e-12);
}

template <class N>
std::string refusal(const N& noise) {
  slom::Estimator est;
  const auto x = est.insertRV(vec3());
  est.insertMeasurement(Position(x, vec3()));
  try {
    est.insertMeasurement(Position(x, vec3()), noise);
  } catch (const mtk::Error& e) {
    EXPECT_EQ(est.getM(), 3) << "a refused measurement must not stay";
    est.insertMeasurement(Position(x, vec3(1, 1, 1)), slom::Covariance(1.0));
    EXPECT_EQ(est.getRSS(), 3);
    return e.what();
  }
  return "accepted";
}

/// Matrices of all sizes with any number of columns. Neighbouring numbers in memory stay unchanged.
TEST(Noise, WhitenMultipliesByW) {
  std::srand(7);
  for (int n = 1; n <= 9; ++n) {
    for (int columns = 0; columns <= 13; ++columns) {
      const MatrixXd W = MatrixXd::Random(n, n), before = MatrixXd::Random(n, columns);
      MatrixXd m(n, columns + 2);
      m << MatrixXd::Constant(n, 1, 5), before, MatrixXd::Constant(n, 1, 7);
      slom::whiten(slom::WhiteningKind::full, W.data(), m.data() + n, n, columns);
      EXPECT_LT((m.middleCols(1, columns) - W * before).norm(), 1e-14 * (1 + before.norm())) << n;
      EXPECT_EQ(m.col(0), MatrixXd::Constant(n, 1, 5));
      EXPECT_EQ(m.col(columns + 1), MatrixXd::Constant(n, 1, 7));
    }
  }
}

TEST(Noise, FaultsAreNamed) {
  EXPECT_EQ(
      refusal(slom::Covariance(0.0)),
      "[slom.not-positive-definite] covariance of measurement Position #2 is 0; pass positive finite numbers");
  EXPECT_EQ(
      refusal(slom::StandardDeviation(-0.1)),
      "[slom.not-positive-definite] standard deviation of measurement Position #2 is -0.1; pass positive finite numbers");
  EXPECT_EQ(
      refusal(slom::InvCovariance(NAN)),
      "[slom.not-positive-definite] inverse covariance of measurement Position #2 is nan; pass positive finite numbers");
  EXPECT_EQ(
      refusal(slom::InvStandardDeviation(Vector3d(1, INFINITY, 1))),
      "[slom.not-positive-definite] inverse standard deviation of measurement Position #2 has entry 1 = inf; pass "
      "positive finite numbers");
  EXPECT_EQ(
      refusal(slom::Covariance(Vector2d(1, 1))),
      "[slom.noise-size] covariance of measurement Position #2 has 2 entries but the residual has 3; pass a number, a "
      "vector of 3, or a 3 x 3 matrix");
  EXPECT_EQ(
      refusal(slom::Covariance(MatrixXd(MatrixXd::Identity(2, 3)))),
      "[slom.noise-size] covariance of measurement Position #2 is 2 x 3 but the residual has 3; pass a number, a vector "
      "of 3, or a 3 x 3 matrix");
  Matrix3d m = Matrix3d::Identity();
  m(0, 1) = 0.5;
  EXPECT_EQ(
      refusal(slom::Covariance(m)),
      "[slom.not-symmetric] covariance of measurement Position #2 has entries (0, 1) = 0.5 and (1, 0) = 0; pass a "
      "symmetric positive definite matrix");
  EXPECT_EQ(
      refusal(slom::StandardDeviation(m)),
      "[slom.not-lower-triangular] standard deviation of measurement Position #2 has entry (0, 1) = 0.5 above the "
      "diagonal; pass the lower triangular Cholesky factor L of the covariance L L^T (or its inverse), or the "
      "covariance itself");
  m = Matrix3d::Identity();
  m(2, 2) = 0;
  EXPECT_EQ(
      refusal(slom::StandardDeviation(m)),
      "[slom.not-positive-definite] standard deviation of measurement Position #2 has diagonal entry (2, 2) = 0; pass a "
      "lower triangular matrix with a positive diagonal");
  m(2, 2) = NAN;
  EXPECT_EQ(
      refusal(slom::InvCovariance(m)),
      "[slom.not-positive-definite] inverse covariance of measurement Position #2 has entry (2, 2) = nan; pass finite "
      "numbers");
  const Matrix3d indefinite = Vector3d(1, 2, -0.25).asDiagonal();
  EXPECT_EQ(
      refusal(slom::Covariance(indefinite)),
      "[slom.not-positive-definite] covariance of measurement Position #2 has eigenvalue -0.25; pass a symmetric "
      "positive definite matrix, or a standard deviation");
}

}  // namespace
