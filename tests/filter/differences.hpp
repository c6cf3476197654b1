#pragma once
// An oracle for derivatives.

#include <Eigen/Core>

#include <mtk/operations.hpp>

namespace slom::testing {

/// Returns the derivatives of f(x), a vector, by central differences with steps h and 2 h. Errors of order h^4 and of
/// rounding are below 1e-11 for values and derivatives of the order of 10, also where a component of x is tiny.
template <int rows, class State, class F>
Eigen::Matrix<double, rows, mtk::DOF_v<State>> byDifferences(const State& x, const F& f) {
  constexpr double h = 1e-3;
  Eigen::Matrix<double, rows, mtk::DOF_v<State>> J;
  for (int i = 0; i < J.cols(); ++i) {
    const auto at = [&](double step) {
      mtk::tangent_t<State> d = mtk::tangent_t<State>::Zero();
      d[i] = step;
      State moved = x;
      mtk::boxplus<State>(moved, d);
      return Eigen::Matrix<double, rows, 1>(f(moved));
    };
    J.col(i) = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
  }
  return J;
}

}  // namespace slom::testing
