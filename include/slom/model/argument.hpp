/// The arguments of insertMeasurement: variables, a datum to be predicted, and other data.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "slom/model/function.hpp"
#include "slom/model/measured.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/prediction.hpp"
#include "slom/model/vectorized.hpp"

namespace slom {

namespace detail {

/// How an argument of insertMeasurement is stored, and what the callable gets for it.
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
  static constexpr bool hasDoubles() {
    if constexpr (requires { typename mtk::scalar_t<Z>; }) return std::is_same_v<mtk::scalar_t<Z>, double>;
    return true;
  }
  static_assert(
      hasDoubles(),
      "slom: the datum of slom::measured must consist of doubles; this one consists of float, integers "
      "or other numbers, which round the residual so that it has no derivatives");
  using Stored = Measured<Z>;
  using Passed = std::tuple<>;
};

template <class A>
inline constexpr bool is_var_id = false;
template <class T>
inline constexpr bool is_var_id<VarID<T>> = true;

/// The concatenated types of several tuples.
template <class... Tuples>
struct Join;
template <class... A>
struct Join<std::tuple<A...>> {
  using type = std::tuple<A...>;
};
template <class... A, class... B, class... More>
struct Join<std::tuple<A...>, std::tuple<B...>, More...> : Join<std::tuple<A..., B...>, More...> {};

/// Returns the datum z of `measured(z)` among the stored arguments, or a null pointer.
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
