/// The arguments of insertMeasurement: variables, a datum to be predicted, other data.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>

#include "slom/model/function.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/prediction.hpp"
#include "slom/model/vectorized.hpp"

namespace slom {

/// Marks the datum: the callable then predicts a Z, and the library forms the residual f(Y) [-] z.
template <class Z>
Measured<Z> measured(const Z& z) {
  mtk::requireManifold<Z>();
  if constexpr (requires { typename mtk::scalar_t<Z>; }) {
    static_assert(
        std::is_same_v<mtk::scalar_t<Z>, double>,
        "slom: what slom::measured marks must be made of doubles; this datum is made of float, integers or other numbers, which "
        "round the residual so that it has no derivatives");
  }
  return {z};
}

namespace detail {

/// How an argument of insertMeasurement is stored, and what the callable gets of it.
template <class A>
struct Argument {
  using Stored = A;
  using Passed = std::tuple<const A&>;
};
template <class T>
struct Argument<VarID<T>> {
  using Stored = VarArg<T>;
  using Passed = std::tuple<const T&>;
};
template <class Z>
struct Argument<Measured<Z>> {
  using Stored = Measured<Z>;
  using Passed = std::tuple<>;
};

template <class A>
inline constexpr bool is_var_id = false;
template <class T>
inline constexpr bool is_var_id<VarID<T>> = true;

/// The types of several tuples in a row.
template <class... Tuples>
struct Join;
template <class... A>
struct Join<std::tuple<A...>> {
  using type = std::tuple<A...>;
};
template <class... A, class... B, class... More>
struct Join<std::tuple<A...>, std::tuple<B...>, More...> : Join<std::tuple<A..., B...>, More...> {};

/// The datum z of `measured(z)` among the stored arguments, or a null pointer.
inline constexpr std::nullptr_t findDatum() { return nullptr; }
template <class First, class... Rest>
constexpr auto findDatum(const First& first, const Rest&... rest) {
  if constexpr (requires { []<class Z>(const Measured<Z>&) {}(first); }) {
    return &first.value;
  } else {
    return findDatum(rest...);
  }
}

}  // namespace detail

}  // namespace slom
