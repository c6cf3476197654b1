/// The arguments of insertMeasurement: variables, a datum to be predicted, and other data.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "slom/model/function.hpp"
#include "slom/model/measurement.hpp"
#include "slom/model/prediction.hpp"
#include "slom/model/vectorized.hpp"

namespace slom {

namespace detail {

/// Returns what is stored for an argument: the value of an Eigen expression, any other argument unchanged.
template <class T>
auto plainValue(const T& x) {
  if constexpr (requires { typename T::PlainObject; }) {
    // Types derived from Eigen's vectors stay unchanged; expressions are evaluated.
    if constexpr (requires { []<class D>(const Eigen::PlainObjectBase<D>&) {}(x); }) {
      return x;
    } else {
      return typename T::PlainObject(x);
    }
  } else {
    return x;
  }
}
template <class T>
using PlainValue = decltype(plainValue(std::declval<const std::decay_t<T>&>()));

/// The type of the marked datum; double for integers.
template <class Z>
using DatumType =
    std::conditional_t<std::is_integral_v<Z> && !std::is_same_v<Z, bool>, double, PlainValue<Z>>;

}  // namespace detail

/// Marks the datum z. The callable then predicts a Z, and the library forms the residual f(Y) [-] z. Integers are
/// converted to double; expressions of Eigen are evaluated.
template <class Datum>
auto measured(const Datum& z) {
  using Z = detail::DatumType<Datum>;
  static_assert((mtk::requireManifold<Z>(), true));
  if constexpr (requires { typename mtk::scalar_t<Z>; }) {
    static_assert(
        std::is_same_v<mtk::scalar_t<Z>, double>,
        "slom: the datum of slom::measured must consist of doubles; this one consists of float, integers "
        "or other numbers, which round the residual so that it has no derivatives");
  }
  return Measured<Z>{Z(z)};
}

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
