#include "slom/model/noise.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "base/decompositions.hpp"
#include "base/words.hpp"
#include "mtk/error.hpp"

namespace slom {

namespace {

using detail::NoiseComplaint;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const char* nameOf(NoiseForm form) {
  switch (form) {
    case NoiseForm::covariance:
      return "covariance";
    case NoiseForm::standard_deviation:
      return "standard deviation";
    case NoiseForm::inv_covariance:
      return "inverse covariance";
    case NoiseForm::inv_standard_deviation:
      return "inverse standard deviation";
    case NoiseForm::whitening:
      return "whitening matrix";
  }
  return "noise";
}

bool isDeviation(NoiseForm form) {
  return form == NoiseForm::standard_deviation || form == NoiseForm::inv_standard_deviation;
}

/// Returns the factor by which a component is multiplied to whiten it.
double whiteningFactor(NoiseForm form, double x) {
  switch (form) {
    case NoiseForm::covariance:
      return 1 / std::sqrt(x);
    case NoiseForm::standard_deviation:
      return 1 / x;
    case NoiseForm::inv_covariance:
      return std::sqrt(x);
    case NoiseForm::inv_standard_deviation:
    case NoiseForm::whitening:
      return x;
  }
  return 1;
}

std::string entryText(int row, int col, double value) {
  return std::string("(") + std::to_string(row) + ", " + std::to_string(col) + ") = " + number(value, 6);
}

bool checkSize(const NoiseView& noise, int dim, NoiseComplaint& complaint) {
  const bool is_matrix = noise.shape == NoiseView::Shape::matrix;
  if (noise.rows == dim && (!is_matrix || noise.cols == dim)) return true;
  const std::string n = std::to_string(dim);
  complaint.id = "slom.noise-size";
  complaint.value = is_matrix ? "is " + std::to_string(noise.rows) + " x " + std::to_string(noise.cols)
                              : "has " + std::to_string(noise.rows) + " entries";
  complaint.value += " but the residual has " + n;
  complaint.remedy = "pass a number, a vector of " + n + ", or a " + n + " x " + n + " matrix";
  return false;
}

/// Computes W from the scalar or the diagonal entries.
bool fromPositiveNumbers(const NoiseView& noise, std::vector<double>& store, NoiseComplaint& complaint) {
  for (int i = 0; i < noise.rows; ++i) {
    const double x = noise.entries[i];
    const double factor = whiteningFactor(noise.form, x);
    if (x > 0 && std::isfinite(x) && std::isfinite(factor) && factor > 0) continue;
    complaint.id = "slom.not-positive-definite";
    complaint.value = noise.shape == NoiseView::Shape::scalar
                          ? "is " + number(x, 6)
                          : "has entry " + std::to_string(i) + " = " + number(x, 6);
    complaint.remedy = "pass positive finite numbers";
    return false;
  }
  for (int i = 0; i < noise.rows; ++i) store.push_back(whiteningFactor(noise.form, noise.entries[i]));
  return true;
}

bool checkFinite(const MatrixXd& m, NoiseComplaint& complaint) {
  for (int j = 0; j < m.cols(); ++j) {
    for (int i = 0; i < m.rows(); ++i) {
      if (std::isfinite(m(i, j))) continue;
      complaint = {"slom.not-positive-definite", "", "has entry " + entryText(i, j, m(i, j)),
                   "pass finite numbers"};
      return false;
    }
  }
  return true;
}

bool checkSymmetric(const MatrixXd& m, NoiseComplaint& complaint) {
  const double tolerance = 1e-9 * m.cwiseAbs().maxCoeff();
  for (int j = 0; j < m.cols(); ++j) {
    for (int i = j + 1; i < m.rows(); ++i) {
      if (std::abs(m(i, j) - m(j, i)) <= tolerance) continue;
      complaint = {"slom.not-symmetric", "",
                   "has entries " + entryText(j, i, m(j, i)) + " and " + entryText(i, j, m(i, j)),
                   "pass a symmetric positive definite matrix"};
      return false;
    }
  }
  return true;
}

bool checkLowerTriangular(const MatrixXd& m, NoiseComplaint& complaint) {
  for (int j = 0; j < m.cols(); ++j) {
    for (int i = 0; i < j; ++i) {
      if (m(i, j) == 0) continue;
      complaint = {
          "slom.not-lower-triangular", "", "has entry " + entryText(i, j, m(i, j)) + " above the diagonal",
          "pass the lower triangular Cholesky factor L of the covariance L L^T (or its inverse), or the "
          "covariance itself"};
      return false;
    }
    if (!(m(j, j) > 0)) {
      complaint = {"slom.not-positive-definite", "", "has diagonal entry " + entryText(j, j, m(j, j)),
                   "pass a lower triangular matrix with a positive diagonal"};
      return false;
    }
  }
  return true;
}

/// Computes the lower Cholesky factor of a symmetric matrix, at unit diagonal so that units do not matter.
bool factorize(const MatrixXd& m, MatrixXd& L, NoiseComplaint& complaint) {
  const VectorXd diagonal = m.diagonal();
  if ((diagonal.array() > 0).all()) {
    const VectorXd scale = diagonal.cwiseSqrt();
    const VectorXd inverse_scale = scale.cwiseInverse();
    const MatrixXd unit = inverse_scale.asDiagonal() * m * inverse_scale.asDiagonal();
    const Eigen::LLT<MatrixXd> llt(unit.selfadjointView<Eigen::Lower>());
    if (llt.info() == Eigen::Success && llt.matrixLLT().diagonal().minCoeff() > 1e-8) {
      L = scale.asDiagonal() * MatrixXd(llt.matrixL());
      return true;
    }
  }
  const double least = eigenOf(m, Eigen::EigenvaluesOnly).eigenvalues().minCoeff();
  complaint = {"slom.not-positive-definite", "", "has eigenvalue " + number(least, 6),
               "pass a symmetric positive definite matrix, or a standard deviation"};
  return false;
}

/// Checks invertibility with rows scaled to length 1, so that units do not matter.
bool checkInvertible(const MatrixXd& m, NoiseComplaint& complaint) {
  if (m.rowwise().norm().minCoeff() > 0 && m.rowwise().normalized().eval().fullPivLu().isInvertible())
    return true;
  complaint = {"slom.not-positive-definite", "", "is singular", "pass an invertible matrix"};
  return false;
}

bool fromMatrix(const NoiseView& noise, int dim, std::vector<double>& store, WhiteningKind& kind,
                NoiseComplaint& complaint) {
  const MatrixXd m = Eigen::Map<const MatrixXd>(noise.entries, dim, dim);
  if (!checkFinite(m, complaint)) return false;
  MatrixXd W;
  if (noise.form == NoiseForm::whitening) {
    W = m;
    if (!checkInvertible(W, complaint)) return false;
  } else if (isDeviation(noise.form)) {
    if (!checkLowerTriangular(m, complaint)) return false;
    W = m;
  } else if (!checkSymmetric(m, complaint) || !factorize(m, W, complaint)) {
    return false;
  }
  // Sigma = L L^T: W = L^-1, so that W^T W = L^-T L^-1 = Sigma^-1.  Sigma^-1 = L L^T: W = L^T.
  if (noise.form == NoiseForm::covariance || noise.form == NoiseForm::standard_deviation) {
    W = W.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(dim, dim)).eval();
  } else if (noise.form == NoiseForm::inv_covariance) {
    W = W.transpose().eval();
  }
  if (!checkFinite(W, complaint)) return false;
  if (W.isDiagonal(0)) {
    const VectorXd diagonal = W.diagonal();
    kind = WhiteningKind::diagonal;
    store.insert(store.end(), diagonal.data(), diagonal.data() + diagonal.size());
  } else {
    store.insert(store.end(), W.data(), W.data() + W.size());
  }
  return true;
}

}  // namespace

bool detail::appendWhitening(const NoiseView& noise, int dim, std::vector<double>& store, WhiteningKind& kind,
                             NoiseComplaint& complaint) {
  bool good = true;
  switch (noise.shape) {
    case NoiseView::Shape::unit:
      kind = WhiteningKind::unit;
      break;
    case NoiseView::Shape::scalar:
      kind = WhiteningKind::scalar;
      good = fromPositiveNumbers(noise, store, complaint);
      break;
    case NoiseView::Shape::vector:
      kind = WhiteningKind::diagonal;
      good = checkSize(noise, dim, complaint) && fromPositiveNumbers(noise, store, complaint);
      break;
    case NoiseView::Shape::matrix:
      kind = WhiteningKind::full;
      good = checkSize(noise, dim, complaint) && fromMatrix(noise, dim, store, kind, complaint);
      break;
  }
  if (!good) complaint.name = nameOf(noise.form);
  return good;
}

void detail::raiseNoiseError(const NoiseComplaint& complaint, const std::string& measurement) {
  throw mtk::Error(
      complaint.id,
      complaint.name + " of measurement " + measurement + " " + complaint.value + "; " + complaint.remedy,
      measurement);
}

namespace {
/// Computes m := W m.
void multiplyAny(const double* W, double* m, int dim, int cols) {
  const Eigen::Map<const MatrixXd> left(W, dim, dim);
  for (int j = 0; j < cols; ++j, m += dim) {
    Eigen::Map<VectorXd> column(m, dim);
    column = left.lazyProduct(column).eval();
  }
}

typedef double TwoNumbers __attribute__((vector_size(16)));
typedef double FourNumbers __attribute__((vector_size(32)));
typedef double EightNumbers __attribute__((vector_size(64)));
/// The same vectors at any place in memory.
typedef TwoNumbers TwoInMemory __attribute__((aligned(alignof(double)), may_alias));
typedef FourNumbers FourInMemory __attribute__((aligned(alignof(double)), may_alias));
typedef EightNumbers EightInMemory __attribute__((aligned(alignof(double)), may_alias));

/// A column of 3 numbers in one vector; the other lanes are undefined.
struct ColumnOfThree {
  using Numbers = FourNumbers;
  static void read(const double* W, Numbers (&column)[3]) {
    column[0] = *reinterpret_cast<const FourInMemory*>(W);
    column[1] = *reinterpret_cast<const FourInMemory*>(W + 3);
    const Numbers last = *reinterpret_cast<const FourInMemory*>(W + 5);  // ends where W ends
    column[2] = __builtin_shufflevector(last, last, 1, 2, 3, 3);
  }
  static void write(const Numbers& x, double* m) {
    *reinterpret_cast<TwoInMemory*>(m) = __builtin_shufflevector(x, x, 0, 1);
    m[2] = x[2];
  }
};
/// A column of 6 numbers in one vector; the other lanes are undefined.
struct ColumnOfSix {
  using Numbers = EightNumbers;
  static void read(const double* W, Numbers (&column)[6]) {
    for (int k = 0; k < 5; ++k) column[k] = *reinterpret_cast<const EightInMemory*>(W + 6 * k);
    const Numbers last = *reinterpret_cast<const EightInMemory*>(W + 28);
    column[5] = __builtin_shufflevector(last, last, 2, 3, 4, 5, 6, 7, 7, 7);
  }
  static void write(const Numbers& x, double* m) {
    *reinterpret_cast<FourInMemory*>(m) = __builtin_shufflevector(x, x, 0, 1, 2, 3);
    *reinterpret_cast<TwoInMemory*>(m + 4) = __builtin_shufflevector(x, x, 4, 5);
  }
};

/// Computes m := W m for N x N as sums of the columns of W. Vectors are read directly from memory. Vectors assembled
/// from parts would have to wait for the parts.
template <class Column, int N>
void multiply(const double* W, double* m, int cols) {
  typename Column::Numbers column[N];
  Column::read(W, column);
  for (int j = 0; j < cols; ++j, m += N) {
    typename Column::Numbers sum = column[0] * m[0];
    for (int k = 1; k < N; ++k) sum += column[k] * m[k];
    Column::write(sum, m);
  }
}

/// Computes m := diag(w) m.
template <int N>
void scale(const double* w, double* m, int dim, int cols) {
  const Eigen::Vector<double, N> factors = Eigen::Map<const Eigen::Vector<double, N>>(w, dim);
  for (int j = 0; j < cols; ++j, m += dim)
    Eigen::Map<Eigen::Vector<double, N>>(m, dim).array() *= factors.array();
}

/// Calls f with a constant that is the dimension if it is a usual one, otherwise Dynamic.
template <class F>
void withDimension(int dim, const F& f) {
  switch (dim) {
    case 1:
      f(std::integral_constant<int, 1>{});
      break;
    case 2:
      f(std::integral_constant<int, 2>{});
      break;
    case 3:
      f(std::integral_constant<int, 3>{});
      break;
    case 6:
      f(std::integral_constant<int, 6>{});
      break;
    default:
      f(std::integral_constant<int, Eigen::Dynamic>{});
      break;
  }
}
}  // namespace

void whiten(WhiteningKind kind, const double* W, double* m, int dim, int cols) {
  switch (kind) {
    case WhiteningKind::unit:
      break;
    case WhiteningKind::scalar:
      Eigen::Map<VectorXd>(m, static_cast<Eigen::Index>(dim) * cols) *= W[0];
      break;
    case WhiteningKind::diagonal:
      withDimension(dim, [&](auto n) { scale<n>(W, m, dim, cols); });
      break;
    case WhiteningKind::full:
      if (dim == 3) {
        multiply<ColumnOfThree, 3>(W, m, cols);
      } else if (dim == 6) {
        multiply<ColumnOfSix, 6>(W, m, cols);
      } else {
        multiplyAny(W, m, dim, cols);
      }
      break;
  }
}

}  // namespace slom
