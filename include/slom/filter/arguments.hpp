/// The arguments of predict and update by their kinds: noise, options, the datum, and data for the function.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/manifold.hpp"
#include "slom/filter/options.hpp"
#include "slom/filter/square_root.hpp"
#include "slom/model/measured.hpp"

namespace slom::detail {

/// True for arguments that the function gets.
template <class A>
inline constexpr bool is_passed = !is_motion_noise<A> && !is_update_option<A> && !is_measured<A>;

/// Returns the tuple of references to those of the arguments for which Passes is true.
template <class A>
auto passedOne(const A& argument) {
  if constexpr (is_passed<A>) {
    return std::tuple<const A&>(argument);
  } else {
    return std::tuple<>();
  }
}
template <class... A>
auto passedArguments(const A&... arguments) {
  return std::tuple_cat(passedOne(arguments)...);
}

/// Returns the first argument whose type is noise.
template <class First, class... Rest>
const auto& filterNoiseAmong(const First& first, const Rest&... rest) {
  if constexpr (is_motion_noise<First>) {
    return first;
  } else {
    return filterNoiseAmong(rest...);
  }
}
/// Returns the duration that is marked.
template <class First, class... Rest>
const auto& durationAmong(const First& first, const Rest&... rest) {
  if constexpr (is_duration<First>) {
    return first.seconds;
  } else {
    return durationAmong(rest...);
  }
}
/// Returns the datum of slom::measured, or nullptr.
inline std::nullptr_t datumAmong() { return nullptr; }
template <class First, class... Rest>
auto datumAmong(const First& first, const Rest&... rest) {
  if constexpr (is_measured<First>) {
    return &first.value;
  } else {
    return datumAmong(rest...);
  }
}

/// Returns whether all numbers of an argument are finite. Arguments of other types count as finite.
template <class A>
bool isFiniteArgument(const A& x) {
  if constexpr (std::is_floating_point_v<A>) {
    return isFinite(x);
  } else if constexpr (requires { []<class D>(const Eigen::DenseBase<D>&) {}(x); }) {
    return allFinite(x);
  } else if constexpr (is_measured<A>) {
    return isFiniteArgument(x.value);
  } else if constexpr (std::is_class_v<A> && mtk::Manifold<A>) {
    return allFinite(mtk::difference(x, x));
  } else {
    return true;
  }
}

/// Returns whether the last of the arguments that a motion gets is an integer.
template <class... A>
constexpr bool endsWithInteger() {
  bool is_integer = false;
  ((is_passed<A> ? void(is_integer = std::is_integral_v<A> && !std::is_same_v<A, bool>) : void()), ...);
  return is_integer;
}

/// Returns whether the duration of a prediction is positive and finite: the marked one, or the last argument if it is a
/// number.
template <class... A>
bool hasGoodDuration(const A&... arguments) {
  constexpr bool is_marked = (is_duration<A> || ...);
  bool good = true;
  [[maybe_unused]] const auto check = [&](const auto& x) {
    using X = std::remove_cvref_t<decltype(x)>;
    if constexpr (is_duration<X>) {
      good = x.seconds > 0 && isFinite(x.seconds);
    } else if constexpr (is_passed<X> && !is_marked) {
      good = true;
      if constexpr (std::is_floating_point_v<X>) good = x > 0 && isFinite(x);
    }
  };
  (check(arguments), ...);
  return good;
}

}  // namespace slom::detail
