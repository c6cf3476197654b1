/// ComponentPrior: prior knowledge of components of a variable; see Estimator::prior.
///   variable  x    of any type
///   path      c    components that are coordinates, to which [+] adds: numbers and entries of vectors, at any depth
///   data      z    a number for each component
///   residual  x_c - z, in the units of the components
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/model/component.hpp"
#include "slom/model/function.hpp"
#include "slom/model/measurement.hpp"

namespace slom {

/// The measurement. Its derivatives are exact: 1 for the component itself, 0 for all others.
template <class T>
class ComponentPrior {
 public:
  static constexpr int residual_dim = Dynamic;
  static constexpr DerivativeSource derivatives = DerivativeSource::exact;
  /// Returns the name in messages.
  static std::string groupName() { return "ComponentPrior"; }

  /// Creates a prior on the components of x with these numbers, one for each of `values`.
  ComponentPrior(const VarID<T>& x, std::vector<int> components, std::vector<double> values)
      : x_(x), components_(std::move(components)), values_(std::move(values)) {}

  auto variableArgs() { return detail::listVariables(x_); }  ///< returns x alone
  /// Writes the residual; resizes `ret`.
  void evaluate(Residual<Dynamic>& ret) const {
    ret.resize(static_cast<Eigen::Index>(values_.size()));
    evaluate(static_cast<int>(values_.size()), ret.data());
  }
  /// Writes the residual to r. Returns its length; if that is not `rows`, writes nothing.
  int evaluate(int rows, double* r) const {
    const int size = static_cast<int>(values_.size());
    if (rows != size) return size;
    std::vector<double> x(static_cast<std::size_t>(mtk::dof(*x_)));
    coordinates(*x_, x.data());
    for (std::size_t i = 0; i < values_.size(); ++i)
      r[i] = x[static_cast<std::size_t>(components_[i])] - values_[i];
    return size;
  }
  /// Writes residual and Jacobian, rows x dof, column-major.
  int linearize(int rows, double* r, double* J) const {
    const int size = evaluate(rows, r);
    if (size != rows) return size;
    for (int k = 0; k < rows * mtk::dof(*x_); ++k) J[k] = 0;
    for (int i = 0; i < rows; ++i) J[components_[static_cast<std::size_t>(i)] * rows + i] = 1;
    return size;
  }

 private:
  VarArg<T> x_;
  std::vector<int> components_;
  std::vector<double> values_;
};

}  // namespace slom
