/// How the library may treat a measurement function: wrappers that the user puts around it.
///     est.insertMeasurement(slom::numeric(f), ...)      derivatives by differences, f sees doubles only
///     est.insertMeasurement(slom::vectorized(f), ...)   several measurements at once, f sees packs of numbers
#pragma once

#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "mtk/detail/cpp20.hpp"

/// Before a function that is to be compiled as one piece, with all that it calls: dual numbers stay in registers. Left out
/// under sanitizers and with SLOM_NO_FLATTEN, which compile faster.
#if defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) && !defined(SLOM_NO_FLATTEN)
#define SLOM_FLATTEN __attribute__((flatten))
#else
#define SLOM_FLATTEN
#endif

namespace slom {

/// Where a measurement's derivatives come from.
enum class DerivativeSource {
  exact,   ///< dual numbers: the chain rule on the function itself
  given,   ///< the functor's own `jacobian`
  numeric  ///< central differences in the tangent space
};

/// One word: "exact".
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

/// Central differences at several step widths, extrapolated: three times the evaluations or more, error of order h^4; the step follows
/// functions that are narrow beside their argument.
struct Richardson {};

/// Steps of central differences that the user chooses, as for a simulator that rounds its output.
struct DifferenceStep {
  double relative = 0;  ///< step of a component over its typical size, > 0
  std::vector<double>
      sizes;  ///< typical sizes of the components of all variables, in their order; empty: |x|, and 1 where that is 0
};

/// Steps of `relative` times the typical size of each component: `slom::numeric(f, slom::differences(1e-2))`. As diff_step of SciPy's
/// least_squares. `sizes`: typical sizes of the components of all variables of the measurement, in their order; empty: |x|, and 1 where
/// that is 0. Throws [slom.bad-option] unless all are positive and finite.
DifferenceStep differences(double relative, std::vector<double> sizes = {});

namespace detail {

/// std::invoke(f, x...); what is not a pointer to a member is called without its three layers, which would be compiled for each f.
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

/// A functor that is vectorised without being asked, wherever its arguments allow it.
template <class F>
concept VectorizedByItself = requires { requires bool(F::is_vectorized); };

/// The user's function inside the wrappers.
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

/// Asks for derivatives by central differences: for functions that cannot be evaluated on dual numbers, or to compare.
template <class F>
auto numeric(F f) {
  return detail::NumericFunction<F, detail::NoExtrapolation>{std::move(f)};
}
/// The same with Richardson's extrapolation: `slom::numeric(f, slom::Richardson())`.
template <class F>
auto numeric(F f, Richardson) {
  return detail::NumericFunction<F, Richardson>{std::move(f)};
}
/// The same with steps of one's own: `slom::numeric(f, slom::differences(1e-2))`.
template <class F>
auto numeric(F f, DifferenceStep step) {
  return detail::NumericFunction<F, DifferenceStep>{std::move(f), std::move(step)};
}

/// Lets f work on several measurements at once: all its parameters, data included, are `const auto&`, numbers are never
/// declared as double, and in place of `if` on computed numbers stands mtk::select. Each variable's derivatives are
/// carried only as far as they reach, so that numbers that depend on different variables have different types.
/// A functor with the member `static constexpr bool is_vectorized = true;` does without this wrapper, and is evaluated one
/// by one where its arguments do not exist in packs.
template <class F>
auto vectorized(F f) {
  return detail::VectorizedFunction<F>{std::move(f)};
}

}  // namespace slom
