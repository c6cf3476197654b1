// Uses whatever passes between a program and the compiled library, built for this machine's processor while the library
// was built for any: values of dynamic and of vectorisable size, noise, residuals, covariances, solvers.
#include <slom/slom.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <Eigen/Dense>

namespace {

using Pose = mtk::trafo<mtk::SO3<>>;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "wrong: %s\n", what);
  std::exit(1);
}

void fitVectors(bool dense) {
  slom::Estimator est;
  if (dense) est.changeSolver(std::make_unique<slom::DenseQR>());
  const Eigen::VectorXd long_value = Eigen::VectorXd::LinSpaced(11, 0, 1);
  const auto dynamic = est.insertRV(Eigen::VectorXd(Eigen::VectorXd::Zero(11)), "dynamic");
  const auto four = est.insertRV(Eigen::Vector4d(Eigen::Vector4d::Zero()), "four");
  const auto plane = est.insertRV(Eigen::Vector2d(1, 1), "plane");
  const auto pose = est.insertRV(Pose(), "pose");
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(11, 11, 0.5);
  covariance.diagonal().setConstant(2);
  const auto id = est.insertMeasurement([](const Eigen::VectorXd& x, const Eigen::VectorXd& z) { return Eigen::VectorXd(x - z); },
                                        dynamic, long_value, slom::Covariance(covariance));
  est.insertMeasurement([](const Eigen::Vector4d& x) { return Eigen::Vector4d(x.array() - 3); }, four,
                        slom::StandardDeviation(0.1), slom::Huber(2));
  est.insertMeasurement([](const Eigen::Vector2d& x) { return Eigen::Vector2d(2 * x); }, plane);
  est.insertMeasurement([](const auto& x) { return x; }, pose, slom::measured(Pose()));
  const auto dual = est.insertRV(Eigen::VectorXd(Eigen::VectorXd::Zero(3)), "dynamic, with exact derivatives");
  for (int i = 0; i < 3; ++i) est.insertMeasurement([](const auto& x, int component) { return x[component] - component; }, dual, i);
  for (const int threads : {1, 2}) {
    est.setThreads(threads);
    require(est.optimize().converged, "convergence");
  }
  require((*dynamic - long_value).norm() < 1e-9, "dynamic");
  require((*dual - Eigen::Vector3d(0, 1, 2)).norm() < 1e-9, "dual");
  require((four->array() - 3).matrix().norm() < 1e-9, "four");
  require(plane->norm() < 1e-9, "plane");
  require((est.covariance(dynamic) - covariance).norm() < 1e-9, "covariance");
  require(std::abs(est.standardDeviation(four)[3] - 0.1) < 1e-9, "standard deviation");
  require(est.residual(id).norm() < 1e-9 && est.residuals().size() == 11 + 4 + 2 + 6 + 3, "residuals");
  est.reinitRV(dynamic, Eigen::VectorXd(2 * long_value));
  require(std::abs(est.whitenedResidual(id).squaredNorm() - est.getRSS()) < 1e-9, "RSS");
}

}  // namespace

int main() {
  fitVectors(false);
  fitVectors(true);
  std::puts("all values passed");
}
