/// Variables and data as recorded numbers.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "mtk/rebind.hpp"
#include "mtk/types/s2.hpp"
#include "slom/model/runtime_type.hpp"
#include "slom/model/type_name.hpp"
#include "slom/tape/recording.hpp"
#include "slom/tape/rotation.hpp"

namespace mtk::detail {
template <class S>
struct Rebind<slom::tape::Number, S> {
  using type = S;
};
}  // namespace mtk::detail

namespace slom::tape {

/// Where the coordinates of a type lie in memory: distances from the start of the object [bytes].
using Layout = std::vector<std::uint32_t>;

/// Returns the type of variables that is described at run time, as tapes know it.
VariableType typeOf(const RuntimeType& type);
/// Returns where its coordinates lie.
Layout layoutOf(const RuntimeType& type);

namespace detail {

/// True if T is moved part by part, by parts that a tape knows.
template <class P>
inline constexpr bool is_known_part = std::derived_from<P, mtk::SO3<>> || std::derived_from<P, mtk::S2<>> ||
                                      std::derived_from<P, mtk::SO2<>> || mtk::detail::AddsToState<P>;

/// Returns the numbers of a basic part in their order.
template <class P>
const double* numbersOf(const P& part) {
  const auto& state = mtk::detail::stateOf(part);
  if constexpr (mtk::detail::EigenState<P>) {
    return state.data();
  } else {
    return &static_cast<const double&>(state);
  }
}
template <class P>
int countNumbers(const P& part) {
  if constexpr (mtk::detail::EigenState<P>) {
    return static_cast<int>(mtk::detail::stateOf(part).size());
  } else {
    return 1;
  }
}
template <class P>
Part partOf(const P& part) {
  static_assert(
      is_known_part<P>,
      "slom: a traced measurement function needs variables made of numbers, vectors, SO2, SO3 and S2: this "
      "variable has a part with its own boxplus; insert the function without slom::traced");
  if constexpr (std::derived_from<P, mtk::SO3<>>) {
    return {Part::Kind::rotation, 0};
  } else if constexpr (std::derived_from<P, mtk::S2<>>) {
    return {Part::Kind::direction, 0};
  } else if constexpr (std::derived_from<P, mtk::SO2<>>) {
    return {Part::Kind::angle, 0};
  } else {
    return {Part::Kind::vector, countNumbers(part)};
  }
}

/// Sets the recorded part y to these numbers; `tangent`: unknowns of a rotation, null for data.
template <class Y, class X>
void setPart(Y& y, const X& x, const Number* numbers, const Number* tangent) {
  if constexpr (std::derived_from<X, mtk::SO3<>>) {
    typename mtk::SO3<Number>::Tangent right;
    if (tangent != nullptr) right = {tangent[0], tangent[1], tangent[2]};
    y = mtk::SO3<Number>(
        typename mtk::SO3<Number>::Coefficients(numbers[0], numbers[1], numbers[2], numbers[3]), right);
  } else if constexpr (mtk::detail::EigenState<X>) {
    auto& to = mtk::detail::stateOf(y);
    const auto& from = mtk::detail::stateOf(x);
    if constexpr (std::remove_cvref_t<decltype(to)>::SizeAtCompileTime == mtk::Dynamic)
      to.resize(from.rows(), from.cols());
    for (int i = 0; i < countNumbers(x); ++i) to.data()[i] = numbers[i];
  } else {
    mtk::detail::stateOf(y) = numbers[0];
  }
}

template <class T>
inline constexpr bool is_traceable = !std::is_void_v<mtk::rebind_t<T, Number>>;

template <class T>
VariableType typeOf(const T& x) {
  VariableType type{slom::typeName<T>(), {}};
  mtk::detail::forEachBasicPart(
      x, x, 0, [&](const auto& part, const auto&, int) { type.parts.push_back(partOf(part)); });
  return type;
}
/// Appends where the coordinates of a part of x lie in x.
template <class T, class P>
void appendLayout(const T& x, const P& part, Layout& layout) {
  const auto* const numbers = reinterpret_cast<const std::byte*>(numbersOf(part));
  for (int i = 0; i < countNumbers(part); ++i) {
    layout.push_back(static_cast<std::uint32_t>(numbers - reinterpret_cast<const std::byte*>(&x) +
                                                static_cast<std::ptrdiff_t>(sizeof(double)) * i));
  }
}
template <class T>
Layout layoutOf(const T& x) {
  Layout layout;
  mtk::detail::forEachBasicPart(x, x, 0,
                                [&](const auto& part, const auto&, int) { appendLayout(x, part, layout); });
  return layout;
}

/// Adds a variable of this value's type to the recording and returns it.
template <class T>
auto variableOf(Recording& recording, const T& x) {
  static_assert(
      is_traceable<T>,
      "slom: a traced measurement function needs variables that exist over other scalars: numbers, vectors, "
      "mtk's types, compounds of them and class templates (see mtk/rebind.hpp)");
  static_assert(
      mtk::DOF_v<T> != mtk::Dynamic,
      "slom: a traced measurement function needs variables of sizes known at compile time; insert the "
      "function without slom::traced");
  const Recording::Input input = recording.variable(typeOf(x));
  mtk::rebind_t<T, Number> y{};
  std::size_t next = 0;
  mtk::detail::forEachBasicPart(y, x, 0, [&](auto& to, const auto& from, int offset) {
    setPart(to, from, input.coordinates.data() + next, input.tangent.data() + offset);
    next += static_cast<std::size_t>(countNumbers(from));
  });
  return y;
}

/// Appends the numbers of data to `values`.
template <class D>
void appendNumbers(const D& datum, std::vector<double>& values) {
  mtk::detail::forEachBasicPart(datum, datum, 0, [&](const auto& part, const auto&, int) {
    const double* const numbers = numbersOf(part);
    values.insert(values.end(), numbers, numbers + countNumbers(part));
  });
}
/// True if the numbers of D become columns of data; other data are passed to the function as they are.
template <class D>
inline constexpr bool is_column_data = [] {
  if constexpr (!mtk::Manifold<D>) {
    return mtk::detail::EigenState<D> && is_traceable<D>;
  } else {
    return is_traceable<D>;
  }
}();
/// Returns the datum as new columns of data, or as it is.
template <class D>
decltype(auto) dataOf(Recording& recording, const D& datum) {
  if constexpr (is_column_data<D>) {
    mtk::rebind_t<D, Number> y{};
    mtk::detail::forEachBasicPart(y, datum, 0, [&](auto& to, const auto& from, int) {
      std::vector<Number> numbers;
      const double* const values = numbersOf(from);
      for (int i = 0; i < countNumbers(from); ++i) numbers.push_back(recording.data(values[i]));
      setPart(to, from, numbers.data(), nullptr);
    });
    return y;
  } else {
    return (datum);
  }
}

}  // namespace detail
}  // namespace slom::tape
