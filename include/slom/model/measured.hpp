/// slom::measured(z): marks the datum that a measurement function predicts.
#pragma once

#include <type_traits>
#include <utility>

#include "mtk/manifold.hpp"

namespace slom {

/// A measured value of a manifold Z; see `measured`.
template <class Z>
struct Measured {
  Z value;
};

namespace detail {

template <class A>
inline constexpr bool is_measured = false;
template <class Z>
inline constexpr bool is_measured<Measured<Z>> = true;

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
  return Measured<Z>{Z(z)};
}

}  // namespace slom
