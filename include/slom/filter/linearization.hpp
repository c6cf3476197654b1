/// Values and exact derivatives of the functions of a filter.
///
/// A function that accepts dual numbers in place of numbers runs on them, with one column for each degree of freedom
/// of its variables. So derivatives are those of the formula itself, in the tangent space. A function that takes only
/// doubles (a parameter `const State&`, or a State that is no template) is differentiated by extrapolated central
/// differences, which are good to about 10 digits.
#pragma once

#include <cmath>
#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/rebind.hpp"
#include "slom/filter/square_root.hpp"
#include "slom/model/carries_derivatives.hpp"
#include "slom/model/flatten.hpp"
#include "slom/model/prediction.hpp"

namespace slom::detail {

/// Most columns of dual numbers in one pass.
inline constexpr int kMostFilterColumns = 32;

/// Whether F accepts the variables X over dual numbers and returns a result with derivatives. F gets the variables first.
template <class F, class D, class Variables, class Data>
inline constexpr bool accepts_duals = false;
template <class F, class D, class... X, class... A>
  requires(mtk::is_rebindable_v<X> && ...)
inline constexpr bool accepts_duals<F, D, std::tuple<X...>, std::tuple<A...>> = [] {
  if constexpr (std::is_invocable_v<const F&, const mtk::rebind_t<X, D>&..., const A&...>) {
    return carriesDerivatives<
        std::remove_cvref_t<std::invoke_result_t<const F&, const mtk::rebind_t<X, D>&..., const A&...>>>();
  } else {
    return false;
  }
}();

/// Writes d number / d column to J(row, first ...).
template <int Width, class J, class N>
void writePartials(J& jacobian, int row, int first, const N& number) {
  constexpr int columns = J::ColsAtCompileTime;
  constexpr int most = columns < Width ? columns : Width;
  const int count = most < columns - first ? most : columns - first;
  for (int c = 0; c < count; ++c) {
    if constexpr (mtk::detail::is_dual<N>) {
      if constexpr (N::columns == mtk::detail::lowColumns(Width)) {
        jacobian(row, first + c) = number.partials().get(c);
      } else {
        jacobian(row, first + c) = number.partial(c);
      }
    } else {
      jacobian(row, first + c) = typename J::Scalar(0);  // a constant
    }
  }
}

/// Evaluates g, a function of the variables alone, over dual numbers. Calls rows(g's result, sink), which passes each row
/// of the result to sink(row, number). Writes the derivatives to J.
template <class J, class G, class Rows, class... X>
SLOM_FLATTEN void differentiate(J& jacobian, const G& g, const Rows& rows, const X&... x) {
  using S = typename J::Scalar;
  constexpr int columns = J::ColsAtCompileTime;
  constexpr int width = columns <= kMostFilterColumns ? columns : 16;
  using D = mtk::Dual<S, width>;
  for (int first = 0; first < columns; first += width) {
    int next = -first;
    const auto begin = [&](int dof) { return std::exchange(next, next + dof); };
    const std::tuple<mtk::rebind_t<X, D>...> seeded{
        mtk::detail::seededAs<mtk::rebind_t<X, D>>(x, begin(mtk::DOF_v<X>), width)...};
    std::apply(
        [&](const auto&... over_duals) {
          rows(g(over_duals...),
               [&](int row, const auto& number) { writePartials<width>(jacobian, row, first, number); });
        },
        seeded);
  }
}

/// Writes the derivatives of difference(x...), a vector, by central differences with steps h and 2 h. Their error is of
/// order h^4.
template <class J, class Difference, class... X>
void differentiateNumerically(J& jacobian, const Difference& difference, const X&... x) {
  using S = typename J::Scalar;
  using std::pow;
  const S relative = pow(std::numeric_limits<S>::epsilon(), S(0.2));
  int column = 0;
  const auto one = [&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
    using Variable = std::tuple_element_t<I, std::tuple<X...>>;
    const std::tuple<const X&...> all(x...);
    mtk::tangent_t<Variable> sizes;
    mtk::typicalSizes<Variable>(sizes, std::get<I>(all));
    for (int i = 0; i < mtk::DOF_v<Variable>; ++i, ++column) {
      const S h = relative * (sizes[i] > S(0) ? sizes[i] : S(1));
      const auto at = [&](const S& step) {
        mtk::tangent_t<Variable> d = mtk::tangent_t<Variable>::Zero();
        d[i] = step;
        std::tuple<X...> moved(x...);
        mtk::boxplus<Variable>(std::get<I>(moved), d);
        return std::apply([&](const auto&... y) { return difference(y...); }, moved);
      };
      jacobian.col(column) = (S(8) * (at(h) - at(-h)) - (at(S(2) * h) - at(S(-2) * h))) / (S(12) * h);
    }
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (one(std::integral_constant<std::size_t, I>{}), ...);
  }(std::index_sequence_for<X...>{});
}

/// Writes d (f(x..., data...) [-] y) / d x to J, in the tangent space of y = f(x..., data...). `variables`: a tuple.
template <class J, class F, class Y, class... X, class... A>
void linearizeMotion(J& jacobian, const F& f, const Y& y, const std::tuple<const X&...>& variables,
                     const A&... data) {
  using D =
      mtk::Dual<typename J::Scalar, J::ColsAtCompileTime <= kMostFilterColumns ? J::ColsAtCompileTime : 16>;
  std::apply(
      [&](const X&... x) {
        if constexpr (accepts_duals<F, D, std::tuple<X...>, std::tuple<A...>>) {
          differentiate(
              jacobian, [&](const auto&... dual) { return f(dual..., data...); },
              [&](const auto& result, const auto& sink) { eachDifference(result, y, 0, sink); }, x...);
        } else {
          differentiateNumerically(
              jacobian, [&](const X&... moved) { return mtk::difference<Y>(f(moved..., data...), y); }, x...);
        }
      },
      variables);
}

}  // namespace slom::detail
