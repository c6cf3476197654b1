/// Values: a few values of different types, like std::tuple. Every measurement function makes several such types of its
/// own, and the constructors of std::tuple take much longer to compile.
#pragma once

#include <cstddef>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace slom::detail {

template <std::size_t I, class T>
struct ValueAt {
  T value;
};

template <class Indices, class... T>
struct IndexedValues;
template <std::size_t... I, class... T>
struct IndexedValues<std::index_sequence<I...>, T...> : ValueAt<I, T>... {};

/// An aggregate, made as `Values<A, B>{{a}, {b}}`. Values of types that cannot be moved are made in place. T may be a
/// reference.
template <class... T>
using Values = IndexedValues<std::index_sequence_for<T...>, T...>;

/// Returns value I.
template <std::size_t I, class T>
constexpr const T& valueAt(const ValueAt<I, T>& values) {
  return values.value;
}
template <std::size_t I, class T>
constexpr T& valueAt(ValueAt<I, T>& values) {
  return values.value;
}

/// Returns f(all values).
template <class F, std::size_t... I, class... T>
constexpr decltype(auto) applyTo(const IndexedValues<std::index_sequence<I...>, T...>& values, const F& f) {
  return f(static_cast<const ValueAt<I, T>&>(values).value...);
}

}  // namespace slom::detail
