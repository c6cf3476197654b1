// Uses everything that passes between a program and the compiled library: values of dynamic and of vectorisable size,
// noise, residuals, covariances, solvers. The program is built for this machine's processor, the library for any. Both
// use the same parts of Eigen, so a linker could mix their code.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <Eigen/Dense>

#include <slom/measurements/relative_pose.hpp>
#include <slom/slom.hpp>

namespace {

using Pose = mtk::trafo<mtk::SO3<>>;

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "wrong: %s\n", what);
  std::exit(1);
}

/// Every decomposition that the library computes.
void useEigen() {
  Eigen::MatrixXd A = Eigen::MatrixXd::Random(9, 7);
  A.resize(12, 7);
  A.setRandom();
  const Eigen::VectorXd b = Eigen::VectorXd::Random(12);
  const Eigen::MatrixXd H = A.transpose() * A;
  const Eigen::VectorXd x = A.colPivHouseholderQr().solve(b);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::MatrixXd Q = qr.householderQ() * Eigen::MatrixXd::Identity(12, 7);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::JacobiSVD<Eigen::MatrixXd> full(A, Eigen::ComputeFullV);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H);
  require((svd.solve(b) - x).norm() < 1e-9 && (H.llt().solve(A.transpose() * b) - x).norm() < 1e-9,
          "solutions");
  require((Q * (Q.transpose() * A) - A).norm() < 1e-9 && H.fullPivLu().isInvertible(), "factors");
  require(std::abs(full.singularValues()[6] - std::sqrt(eigen.eigenvalues()[0])) < 1e-9, "singular values");
}

/// Calls the library's decompositions, which find undetermined directions.
void askForMotions() {
  slom::Estimator est;
  const auto a = est.insertRV(Pose(), "a"), b = est.insertRV(Pose(), "b"), c = est.insertRV(Pose(), "c");
  est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(Pose()), slom::StandardDeviation(0.1));
  est.insertMeasurement(slom::RelativePose(), b, c, slom::measured(Pose()), slom::StandardDeviation(0.1));
  require(slom::diagnose(est).findings.at(0).kind == slom::Finding::Kind::gauge, "gauge");
  est.setFreeGauge(slom::FreeGauge::inner_constraints);
  est.optimize();
  require(est.covariance(b).allFinite() && slom::outliers(est).suspects() == 0, "free network");
  try {
    const Eigen::MatrixXd covariance = -Eigen::MatrixXd::Identity(6, 6);
    est.insertMeasurement(slom::RelativePose(), a, c, slom::measured(Pose()), slom::Covariance(covariance));
    require(false, "refusal");
  } catch (const mtk::Error&) {
  }
}

void fitVectors(bool dense) {
  slom::Estimator est;
  const slom::DogLeg dog_leg;
  const slom::LevenbergMarquardt levenberg_marquardt;
  if (dense) est.changeSolver(std::make_unique<slom::DenseQR>());
  const Eigen::VectorXd long_value = Eigen::VectorXd::LinSpaced(11, 0, 1);
  const auto dynamic = est.insertRV(Eigen::VectorXd(Eigen::VectorXd::Zero(11)), "dynamic");
  const auto four = est.insertRV(Eigen::Vector4d(Eigen::Vector4d::Zero()), "four");
  const auto plane = est.insertRV(Eigen::Vector2d(1, 1), "plane");
  const auto pose = est.insertRV(Pose(), "pose");
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(11, 11, 0.5);
  covariance.diagonal().setConstant(2);
  const auto id = est.insertMeasurement(
      [](const Eigen::VectorXd& x, const Eigen::VectorXd& z) { return Eigen::VectorXd(x - z); }, dynamic,
      long_value, slom::Covariance(covariance));
  est.insertMeasurement([](const Eigen::Vector4d& x) { return Eigen::Vector4d(x.array() - 3); }, four,
                        slom::StandardDeviation(0.1), slom::Huber(2));
  est.insertMeasurement([](const Eigen::Vector2d& x) { return Eigen::Vector2d(2 * x); }, plane);
  est.insertMeasurement([](const auto& x) { return x; }, pose, slom::measured(Pose()));
  const auto dual =
      est.insertRV(Eigen::VectorXd(Eigen::VectorXd::Zero(3)), "dynamic, with exact derivatives");
  for (int i = 0; i < 3; ++i)
    est.insertMeasurement([](const auto& x, int component) { return x[component] - component; }, dual, i);
  for (const int threads : {1, 2}) {
    est.setThreads(threads);
    require(est.optimize().converged, "convergence");
    est.changeAlgorithm(dog_leg);
    require(est.optimize().converged, "dog leg");
    est.changeAlgorithm(levenberg_marquardt);
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
  useEigen();
  askForMotions();
  fitVectors(false);
  fitVectors(true);
  std::puts("all values passed");
}
