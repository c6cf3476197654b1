#pragma once
// Random vectors, poses and matrices for the tests of priors.

#include <mtk/testing/random.hpp>
#include <slom/slom.hpp>

namespace slom::testing {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using SO3 = mtk::SO3<>;
using SE3 = mtk::trafo<SO3>;
using Vec3 = mtk::vect<3>;

class RandomValues {
 public:
  explicit RandomValues(unsigned seed) : numbers_(seed) {}
  double operator()() { return numbers_.normal(); }
  Vec3 vector(double size) { return Vec3(size * (*this)(), size * (*this)(), size * (*this)()); }
  SE3 pose(double size) { return SE3(SO3::exp(vector(size)), vector(5 * size)); }
  MatrixXd matrix(int rows, int columns) {
    return MatrixXd::NullaryExpr(rows, columns, [this] { return (*this)(); });
  }

 private:
  mtk::testing::Random numbers_;
};

}  // namespace slom::testing
