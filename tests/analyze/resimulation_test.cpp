// Covariances are right: in 1000 problems with the same truth and new noise, the errors e of the estimates have e^T
// C^-1 e distributed as chi-square.
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/chi_square.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace {

using SE2 = mtk::trafo<mtk::SO2<>>;
using SE3 = mtk::trafo<mtk::SO3<>>;
using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;

constexpr int kFits = 1000;

/// Standard normal numbers that continue from fit to fit.
class Noise {
 public:
  explicit Noise(unsigned seed) : engine_(seed) {}
  double operator()() { return normal_(engine_); }
  template <int N>
  Eigen::Matrix<double, N, 1> vector() {
    Eigen::Matrix<double, N, 1> v;
    for (double& x : v) x = normal_(engine_);
    return v;
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

/// `fit` makes one problem and returns the error of an estimate and its covariance.
template <int N>
void expectChiSquare(const std::function<std::pair<Eigen::Matrix<double, N, 1>, Eigen::MatrixXd>()>& fit) {
  double sum = 0;
  int beyond = 0;  // the median
  const double median = slom::chiSquareCritical(0.5, N);
  Eigen::Matrix<double, N, 1> mean = Eigen::Matrix<double, N, 1>::Zero();
  for (int i = 0; i < kFits; ++i) {
    const auto [error, C] = fit();
    const Eigen::LLT<Eigen::MatrixXd> factor(C);
    const Eigen::Matrix<double, N, 1> whitened = factor.matrixL().solve(error);
    mean += whitened / kFits;
    sum += whitened.squaredNorm();
    beyond += whitened.squaredNorm() > median ? 1 : 0;
  }
  EXPECT_NEAR(sum / kFits, N, 4 * std::sqrt(2.0 * N / kFits));
  EXPECT_NEAR(beyond, kFits / 2, 4 * std::sqrt(kFits / 4.0));
  EXPECT_LT(mean.norm(), 4 * std::sqrt(double(N) / kFits));
}

TEST(Resimulation, OfACurve) {
  Noise noise(1);
  const vec2 truth(240, 0.5);
  expectChiSquare<2>([&] {
    slom::Estimator est;
    const auto c = est.insertRV(truth, "c");
    for (int i = 0; i < 14; ++i) {
      const double x = 0.3 * (i + 1), sigma = 0.5;
      const double y = truth[0] * (1 - std::exp(-truth[1] * x)) + sigma * noise();
      est.insertMeasurement(
          [x, y](const auto& b) {
            using std::exp;
            return b[0] * (1.0 - exp(-b[1] * x)) - y;
          },
          c, slom::StandardDeviation(sigma));
    }
    EXPECT_TRUE(est.optimize().converged);
    return std::pair(Eigen::Vector2d(*c - truth), est.covariance(c));
  });
}

TEST(Resimulation, OfAPoseGraph) {
  Noise noise(2);
  std::vector<SE2> truth;
  for (int i = 0; i < 12; ++i)
    truth.push_back(SE2(mtk::SO2<>(0.5 * i), vec2(4 * std::cos(0.5 * i), 4 * std::sin(0.5 * i))));
  const auto sigma = Eigen::Vector3d(0.02, 0.01, 0.005);
  expectChiSquare<3>([&] {
    slom::Estimator est;
    std::vector<slom::VarID<SE2>> poses;
    for (const SE2& pose : truth) poses.push_back(est.insertRV(pose, !poses.empty()));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      for (const std::size_t step : {1, 5}) {
        const std::size_t j = (i + step) % poses.size();
        const mtk::tangent_t<SE2> error = sigma.cwiseProduct(noise.vector<3>());
        const SE2 z = mtk::moved<SE2>(truth[i].inverse() * truth[j], error);
        est.insertMeasurement(slom::RelativePose(), poses[i], poses[j], slom::measured(z),
                              slom::StandardDeviation(sigma));
      }
    }
    EXPECT_TRUE(est.optimize().converged);
    return std::pair(Eigen::Vector3d(mtk::difference(truth[6], *poses[6])),
                     est.marginals().covariance(poses[6]));
  });
}

/// Focal length, centre and the pose of one of the views.
TEST(Resimulation, OfACalibration) {
  Noise noise(3);
  std::vector<SE3> views;
  for (int i = 0; i < 6; ++i) {
    views.push_back(SE3(mtk::SO3<>::exp(0.4 * vec3(std::sin(i), std::cos(2 * i), 0.3 * i)),
                        vec3(0.02 * i, -0.01 * i, 0.7 + 0.05 * i)));
  }
  const vec3 truth(500, 320, 240);
  const auto pixel = [](const auto& lens, const auto& T, const vec3& corner) {
    const auto p = (T * corner).eval();
    return (lens[0] * p.template head<2>() / p[2] + lens.template tail<2>()).eval();
  };
  expectChiSquare<9>([&] {
    slom::Estimator est;
    const auto lens = est.insertRV(truth, "lens");
    std::vector<slom::VarID<SE3>> ids;
    for (const SE3& view : views) {
      ids.push_back(est.insertRV(view));
      for (int c = 0; c < 12; ++c) {
        const vec3 corner(0.06 * (c % 4 - 1.5), 0.06 * (c / 4 - 1), 0);
        const vec2 z = pixel(truth, view, corner) + 0.2 * noise.vector<2>();
        est.insertMeasurement([pixel, corner](const auto& l, const auto& T) { return pixel(l, T, corner); },
                              lens, ids.back(), slom::measured(z), slom::StandardDeviation(0.2));
      }
    }
    EXPECT_TRUE(est.optimize().converged);
    Eigen::Matrix<double, 9, 1> error;
    error << *lens - truth, -mtk::difference(views[2], *ids[2]);
    Eigen::MatrixXd C(9, 9);
    C << est.covariance(lens), est.covariance(lens, ids[2]), est.covariance(ids[2], lens),
        est.covariance(ids[2]);
    return std::pair(error, C);
  });
}

}  // namespace
