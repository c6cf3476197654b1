#pragma once
// Random vectors and covariances for the tests of filters.

#include <mtk/testing/random.hpp>
#include <mtk/types/vect.hpp>

namespace slom::testing {

class RandomMatrices {
 public:
  explicit RandomMatrices(unsigned seed) : numbers_(seed) {}
  double normal() { return numbers_.normal(); }
  double uniform(double low, double high) { return numbers_.uniform(low, high); }
  template <int R, int C>
  Eigen::Matrix<double, R, C> matrix() {
    return Eigen::Matrix<double, R, C>::NullaryExpr([this] { return normal(); });
  }
  template <int N>
  mtk::vect<N> vector(double size = 1) {
    return mtk::vect<N>(size * matrix<N, 1>());
  }
  /// Returns a covariance of full rank whose standard deviations are near `size`.
  template <int N>
  Eigen::Matrix<double, N, N> covariance(double size = 1) {
    const Eigen::Matrix<double, N, N> A = matrix<N, N>();
    return size * size * (A * A.transpose() / N + 0.1 * Eigen::Matrix<double, N, N>::Identity());
  }
  /// Returns a sample of N(0, P).
  template <int N>
  mtk::vect<N> sample(const Eigen::Matrix<double, N, N>& P) {
    return mtk::vect<N>(Eigen::Matrix<double, N, N>(P.llt().matrixL()) * matrix<N, 1>());
  }

 private:
  mtk::testing::Random numbers_;
};

}  // namespace slom::testing
