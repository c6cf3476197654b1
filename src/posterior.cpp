#include "slom/posterior.hpp"

#include <cmath>
#include <string>

#include <Eigen/Cholesky>

#include "base/words.hpp"

namespace slom::detail {

using Eigen::MatrixXd;
using Matrix = Eigen::Map<const MatrixXd>;

namespace {

/// Fraction of the diagonal entry below which a pivot is rounding error.
constexpr double kLeastPivot = 1e-13;

/// The uncertain components of a covariance: their standard deviations, and the Cholesky factor L of their
/// correlations.
struct Factor {
  std::vector<int> components;
  Eigen::VectorXd deviations;
  MatrixXd L;

  explicit Factor(const Matrix& C) {
    for (int i = 0; i < C.rows(); ++i) {
      if (!(C(i, i) >= 0) || !std::isfinite(C(i, i)))
        throw Error("slom.singular-covariance", "entry " + std::to_string(i) +
                                                    " of the diagonal of a covariance is " + number(C(i, i)) +
                                                    "; variances are finite and not negative");
      if (C(i, i) > 0) components.push_back(i);
    }
    const auto n = static_cast<Eigen::Index>(components.size());
    deviations.resize(n);
    for (Eigen::Index i = 0; i < n; ++i)
      deviations[i] =
          std::sqrt(C(components[static_cast<std::size_t>(i)], components[static_cast<std::size_t>(i)]));
    const Eigen::VectorXd scale = deviations.cwiseInverse();
    const MatrixXd correlations =
        scale.asDiagonal() * MatrixXd(C(components, components)) * scale.asDiagonal();
    const Eigen::LLT<MatrixXd> llt(correlations);
    L = llt.matrixL();
    if (n > 0 && (llt.info() != Eigen::Success || !(L.diagonal().cwiseAbs2().minCoeff() > kLeastPivot))) {
      throw Error(
          "slom.singular-covariance",
          "a covariance of " + std::to_string(n) +
              " components is singular, so a combination of them is certain; leave out variables that follow "
              "from the others, such as a variable given twice");
    }
  }
};

}  // namespace

void writeSquareRootInformation(const double* C, int n, double* R) {
  const Factor factor(Matrix(C, n, n));
  const auto m = factor.L.rows();
  const MatrixXd inverse = factor.L.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(m, m)) *
                           factor.deviations.cwiseInverse().asDiagonal();
  Eigen::Map<MatrixXd> root(R, n, n);
  root.setZero();
  root(factor.components, factor.components) = inverse;
}

double halfLogOfDeterminants(const double* before, const double* after, int n) {
  const Factor a(Matrix(before, n, n)), b(Matrix(after, n, n));
  const auto half_log = [](const Factor& f) {
    return (f.L.diagonal().array() * f.deviations.array()).log().sum();
  };
  if (a.components != b.components)
    throw Error(
        "slom.singular-covariance",
        "a component is certain before the measurements or after them, but not both: its gain is infinite");
  return half_log(a) - half_log(b);
}

void raiseOtherSizes(Eigen::Index before, Eigen::Index after) {
  throw Error("slom.other-sizes", "the covariances before and after have " + std::to_string(before) +
                                      " and " + std::to_string(after) +
                                      " rows; pass two square matrices of the same components");
}

}  // namespace slom::detail
