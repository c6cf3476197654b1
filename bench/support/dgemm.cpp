#include "support/dgemm.hpp"

#include <algorithm>
#include <chrono>

#include <Eigen/Core>

namespace slom::bench {

double dgemmRate(int n) {
  using Clock = std::chrono::steady_clock;
  constexpr int repetitions = 5;
  constexpr double shortest_seconds = 0.1;
  const Eigen::MatrixXd A = Eigen::MatrixXd::Constant(n, n, 0.5), B = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  const double flops = 2.0 * n * n * n;
  double best = 0;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const auto start = Clock::now();
    double seconds = 0;
    int products = 0;
    for (; seconds < shortest_seconds; ++products) {
      C.noalias() += A * B;
      seconds = std::chrono::duration<double>(Clock::now() - start).count();
    }
    best = std::max(best, products * flops / seconds);
  }
  return C(0, 0) > 0 ? best : 0;
}

}  // namespace slom::bench
