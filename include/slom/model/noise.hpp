/// Uncertainty of a measurement, in the form that the user chooses.
///
/// For a residual r of length n with covariance Sigma:
///   Covariance(x)            Sigma                      scalar: x * I, vector: diag(x), matrix: symmetric
///   StandardDeviation(x)     L with Sigma = L L^T       scalar, vector, lower triangular matrix
///   InvCovariance(x)         Sigma^-1 (information)     scalar, vector, symmetric matrix
///   InvStandardDeviation(x)  L^-1                       scalar, vector, lower triangular matrix
/// A measurement without any of these has unit covariance. The estimator minimises |W r|^2 with W^T W = Sigma^-1.
/// Insertion checks everything: size, finiteness, symmetry, positive definiteness.
#pragma once

#include <string>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "mtk/detail/cpp20.hpp"

namespace slom {

enum class NoiseForm {
  covariance,
  standard_deviation,
  inv_covariance,
  inv_standard_deviation,
  /// W itself, of any shape. Only as a NoiseView, for problems that are loaded.
  whitening
};

/// Value and form. T is double or a dense Eigen type of doubles.
template <NoiseForm Form, class T>
struct Noise {
  static constexpr NoiseForm form = Form;
  T value;
};

namespace detail {
template <class T>
auto plainNoise(const T& value) {
  if constexpr (std::is_arithmetic_v<T>) {
    return static_cast<double>(value);
  } else if constexpr (std::is_convertible_v<T, double>) {
    return static_cast<double>(value);
  } else {
    static_assert(
        requires { typename T::PlainObject; }, "slom: noise must be a number, a vector or a matrix");
    return typename T::PlainObject(value);
  }
}
template <class T>
using PlainNoise = decltype(plainNoise(std::declval<const T&>()));
}  // namespace detail

/// Sigma: a number (times the identity), a vector (the diagonal), or a symmetric matrix.
template <class T = double>
struct Covariance : Noise<NoiseForm::covariance, T> {
  /// Sets the covariance x in squared units of the residual.
  template <class X>
  explicit Covariance(const X& x) : Noise<NoiseForm::covariance, T>{detail::plainNoise(x)} {}
};
template <class X>
Covariance(const X&) -> Covariance<detail::PlainNoise<X>>;

/// L with Sigma = L L^T: a number (times the identity), a vector (the diagonal), or a lower triangular matrix.
template <class T = double>
struct StandardDeviation : Noise<NoiseForm::standard_deviation, T> {
  /// Sets the standard deviation x in units of the residual.
  template <class X>
  explicit StandardDeviation(const X& x) : Noise<NoiseForm::standard_deviation, T>{detail::plainNoise(x)} {}
};
template <class X>
StandardDeviation(const X&) -> StandardDeviation<detail::PlainNoise<X>>;

/// Sigma^-1, the information: a number (times the identity), a vector (the diagonal), or a symmetric matrix.
template <class T = double>
struct InvCovariance : Noise<NoiseForm::inv_covariance, T> {
  /// Sets the information x in inverse squared units of the residual.
  template <class X>
  explicit InvCovariance(const X& x) : Noise<NoiseForm::inv_covariance, T>{detail::plainNoise(x)} {}
};
template <class X>
InvCovariance(const X&) -> InvCovariance<detail::PlainNoise<X>>;

/// L^-1: a number (times the identity), a vector (the diagonal), or a lower triangular matrix.
template <class T = double>
struct InvStandardDeviation : Noise<NoiseForm::inv_standard_deviation, T> {
  /// Sets x in inverse units of the residual.
  template <class X>
  explicit InvStandardDeviation(const X& x)
      : Noise<NoiseForm::inv_standard_deviation, T>{detail::plainNoise(x)} {}
};
template <class X>
InvStandardDeviation(const X&) -> InvStandardDeviation<detail::PlainNoise<X>>;

/// No stated noise: unit covariance.
struct UnitCovariance {};

/// A type that insertMeasurement accepts as noise.
template <class T>
concept IsNoise = std::is_same_v<T, UnitCovariance> ||
                  requires(const T& n) { []<NoiseForm F, class V>(const Noise<F, V>&) {}(n); };

/// The numbers of stated noise without its type; entries column by column.
struct NoiseView {
  enum class Shape { unit, scalar, vector, matrix };
  Shape shape = Shape::unit;
  NoiseForm form = NoiseForm::covariance;
  const double* entries = nullptr;
  int rows = 0;
  int cols = 0;
};

/// Returns a view of the numbers of stated noise, which must outlive the view.
inline NoiseView viewNoise(const UnitCovariance&) { return {}; }

template <NoiseForm F, class T>
NoiseView viewNoise(const Noise<F, T>& noise) {
  if constexpr (std::is_same_v<T, double>) {
    return {NoiseView::Shape::scalar, F, &noise.value, 1, 1};
  } else {
    static_assert(std::is_same_v<typename T::Scalar, double>, "slom: noise must have double precision");
    static_assert(!T::IsRowMajor || T::IsVectorAtCompileTime, "slom: noise matrices must be column-major");
    const bool vector = T::IsVectorAtCompileTime;
    return {vector ? NoiseView::Shape::vector : NoiseView::Shape::matrix, F, noise.value.data(),
            static_cast<int>(vector ? noise.value.size() : noise.value.rows()),
            static_cast<int>(vector ? 1 : noise.value.cols())};
  }
}

/// W with W^T W = Sigma^-1, in its most compact form: no numbers, one number, `dim` numbers (diagonal), or dim x dim
/// numbers column by column.
enum class WhiteningKind : unsigned char { unit, scalar, diagonal, full };

namespace detail {
struct NoiseComplaint {
  std::string id, name, value, remedy;
};
/// Appends the numbers of W to `store`. If there is a fault, leaves `store` unchanged, fills `complaint` and returns
/// false.
bool appendWhitening(const NoiseView& noise, int dim, std::vector<double>& store, WhiteningKind& kind,
                     NoiseComplaint& complaint);
[[noreturn]] void raiseNoiseError(const NoiseComplaint& complaint, const std::string& measurement);
}  // namespace detail

/// Appends the numbers of W for residuals of length `dim` to `store`. If there is a fault, throws mtk::Error with the
/// name `subject()`, which is called only then, and leaves `store` unchanged.
template <class Subject>
WhiteningKind appendWhitening(const NoiseView& noise, int dim, std::vector<double>& store,
                              Subject&& subject) {
  detail::NoiseComplaint complaint;
  WhiteningKind kind = WhiteningKind::unit;
  if (!detail::appendWhitening(noise, dim, store, kind, complaint))
    detail::raiseNoiseError(complaint, subject());
  return kind;
}

/// Returns the number of entries of W of this kind in the store.
constexpr int whiteningSize(WhiteningKind kind, int dim) {
  switch (kind) {
    case WhiteningKind::unit:
      return 0;
    case WhiteningKind::scalar:
      return 1;
    case WhiteningKind::diagonal:
      return dim;
    case WhiteningKind::full:
      return dim * dim;
  }
  return 0;
}

/// Computes m := W m for the `dim` x `cols` matrix m, column-major.
void whiten(WhiteningKind kind, const double* W, double* m, int dim, int cols);

}  // namespace slom
