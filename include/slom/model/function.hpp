/// Wrappers around a measurement function that say how the library may treat it.
///     est.insertMeasurement(slom::numeric(f), ...)      derivatives by differences, f sees doubles only
///     est.insertMeasurement(slom::vectorized(f), ...)   several measurements at once, f sees packs of numbers
#pragma once

#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "mtk/detail/cpp20.hpp"
#include "slom/model/flatten.hpp"

namespace slom {

/// Source of a measurement's derivatives.
enum class DerivativeSource {
  exact,   ///< dual numbers: the chain rule on the function itself
  given,   ///< the member `jacobian` of the functor
  numeric  ///< central differences in the tangent space
};

/// Returns one word: "exact".
constexpr const char* toString(DerivativeSource source) {
  switch (source) {
    case DerivativeSource::exact:
      return "exact";
    case DerivativeSource::given:
      return "given";
    case DerivativeSource::numeric:
      return "numeric";
  }
  return "unknown";
}

/// Central differences at several step widths, extrapolated. They take at least 3 times the evaluations and have an
/// error of order h^4. The steps adapt to functions that are narrow compared with their argument.
struct Richardson {};

/// Step widths of central differences chosen by the user, for example for a simulator that rounds its output.
struct DifferenceStep {
  double relative = 0;  ///< step of a component divided by its typical size, > 0
  /// Typical sizes of the components of all variables, in their order; empty: |x|, and 1 if that is 0.
  std::vector<double> sizes;
};

/// Returns steps of `relative` times the typical size of each component: `slom::numeric(f, slom::differences(1e-2))`.
/// This corresponds to diff_step of SciPy's least_squares. `sizes`: typical sizes of the components of all variables of
/// the measurement, in their order; empty: |x|, and 1 if that is 0. Throws [slom.bad-option] unless all are positive
/// and finite.
DifferenceStep differences(double relative, std::vector<double> sizes = {});

namespace detail {

/// Returns std::invoke(f, x...). Only pointers to members go through std::invoke, whose three layers would be compiled
/// for each f.
template <class F, class... A>
decltype(auto) call(const F& f, const A&... x) {
  if constexpr (std::is_member_pointer_v<F>) {
    return std::invoke(f, x...);
  } else {
    return f(x...);
  }
}

struct NoExtrapolation {};

template <class F, class Extrapolation>
struct NumericFunction {
  F f;
  [[no_unique_address]] Extrapolation how{};
  template <class... A>
  auto operator()(const A&... a) const -> decltype(std::invoke(f, a...)) {
    return std::invoke(f, a...);
  }
};

template <class F>
struct VectorizedFunction {
  F f;
  template <class... A>
  auto operator()(const A&... a) const -> decltype(std::invoke(f, a...)) {
    return std::invoke(f, a...);
  }
};

template <class F>
inline constexpr bool is_numeric = false;
template <class F, class E>
inline constexpr bool is_numeric<NumericFunction<F, E>> = true;
template <class F>
inline constexpr bool is_richardson = false;
template <class F>
inline constexpr bool is_richardson<NumericFunction<F, Richardson>> = true;
template <class F>
inline constexpr bool has_difference_step = false;
template <class F>
inline constexpr bool has_difference_step<NumericFunction<F, DifferenceStep>> = true;
template <class F>
inline constexpr bool is_vectorized = false;
template <class F>
inline constexpr bool is_vectorized<VectorizedFunction<F>> = true;

/// A functor that is vectorised without a wrapper if its arguments allow it.
template <class F>
concept VectorizedByItself = requires { requires bool(F::is_vectorized); };

/// The user's function without the wrappers.
template <class F>
struct Unwrapped {
  using type = F;
};
template <class F, class E>
struct Unwrapped<NumericFunction<F, E>> {
  using type = F;
};
template <class F>
struct Unwrapped<VectorizedFunction<F>> {
  using type = F;
};

}  // namespace detail

/// Selects derivatives by central differences, for functions that cannot be evaluated on dual numbers, or to compare.
template <class F>
auto numeric(F f) {
  return detail::NumericFunction<F, detail::NoExtrapolation>{std::move(f)};
}
/// Selects differences with Richardson's extrapolation: `slom::numeric(f, slom::Richardson())`.
template <class F>
auto numeric(F f, Richardson) {
  return detail::NumericFunction<F, Richardson>{std::move(f)};
}
/// Selects differences with the user's steps: `slom::numeric(f, slom::differences(1e-2))`.
template <class F>
auto numeric(F f, DifferenceStep step) {
  return detail::NumericFunction<F, DifferenceStep>{std::move(f), std::move(step)};
}

/// Lets f work on several measurements at once. All parameters of f, including data, must be `const auto&`. f must not
/// declare numbers as double, and must use mtk::select in place of `if` on computed numbers. A number carries only the
/// derivatives of the variables that it depends on, so numbers that depend on different variables have different types.
/// A functor with the member `static constexpr bool is_vectorized = true;` needs no wrapper. If its arguments do not
/// exist in packs, its measurements are evaluated one by one.
template <class F>
auto vectorized(F f) {
  return detail::VectorizedFunction<F>{std::move(f)};
}

}  // namespace slom
