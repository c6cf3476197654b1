/// Compile-time checks whether a callable accepts its arguments, with a message that names the one that does not fit.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "slom/model/argument.hpp"

namespace slom {

namespace detail {

/// Whether F can be called with these arguments, and its return type. If F's return type is written out, F's body is
/// not compiled.
template <class F, class Passed>
struct Call {
  static constexpr bool is_possible = false;
  using Result = double;
};
template <class F, class... P>
  requires requires(const F& f) { f(std::declval<P>()...); }
struct Call<F, std::tuple<P...>> {
  static constexpr bool is_possible = true;
  using Result = std::remove_cvref_t<decltype(std::declval<const F&>()(std::declval<P>()...))>;
};
template <class F, class... P>
  requires(std::is_member_pointer_v<F> && std::is_invocable_v<const F&, P...>)
struct Call<F, std::tuple<P...>> {
  static constexpr bool is_possible = true;
  using Result = std::remove_cvref_t<std::invoke_result_t<const F&, P...>>;
};

/// The parameters of a function that is not a template.
template <class F>
struct Parameters {
  static constexpr bool known = false;
};
template <class... P>
struct ParameterList {
  static constexpr bool known = true;
  using type = std::tuple<P...>;
};
template <class R, class... P>
struct Parameters<R (*)(P...)> : ParameterList<P...> {};
template <class R, class... P>
struct Parameters<R (*)(P...) noexcept> : ParameterList<P...> {};
template <class R, class C, class... P>
struct Parameters<R (C::*)(P...) const> : ParameterList<P...> {};
template <class R, class C, class... P>
struct Parameters<R (C::*)(P...) const noexcept> : ParameterList<P...> {};
template <class F>
  requires requires { &F::operator(); }
struct Parameters<F> : Parameters<decltype(&F::operator())> {};

/// Fails to compile with one line for the first argument that does not fit. The line that names the place shows both
/// types.
template <int Number, class Given, class Wanted>
constexpr void requireArgument() {
  constexpr bool fits = std::is_convertible_v<Given, Wanted>;
  static_assert(Number != 1 || fits,
                "slom: argument 1 of the measurement function does not convert to the type of its parameter");
  static_assert(Number != 2 || fits,
                "slom: argument 2 of the measurement function does not convert to the type of its parameter");
  static_assert(Number != 3 || fits,
                "slom: argument 3 of the measurement function does not convert to the type of its parameter");
  static_assert(Number != 4 || fits,
                "slom: argument 4 of the measurement function does not convert to the type of its parameter");
  static_assert(Number != 5 || fits,
                "slom: argument 5 of the measurement function does not convert to the type of its parameter");
  static_assert(Number != 6 || fits,
                "slom: argument 6 of the measurement function does not convert to the type of its parameter");
  static_assert(
      Number <= 6 || fits,
      "slom: an argument after the 6th of the measurement function does not convert to the type of its "
      "parameter");
}
/// Fails to compile if F does not accept its arguments for another reason than the number of data. If F is not a
/// template, the message names the argument.
template <class F, class... Given>
constexpr void requireAcceptedOne(std::type_identity<std::tuple<Given...>>) {
  if constexpr (!Call<F, std::tuple<Given...>>::is_possible) {
    constexpr bool is_mutable = requires(F& f) { f(std::declval<Given>()...); };
    static_assert(
        !is_mutable,
        "slom: the measurement function must be const, because several threads call it at once: remove "
        "`mutable`, or write `const` after the parameters of operator()");
    if constexpr (is_mutable) {
    } else if constexpr (Parameters<F>::known) {
      using Wanted = typename Parameters<F>::type;
      constexpr bool right_number = std::tuple_size_v<Wanted> == sizeof...(Given);
      static_assert(
          right_number,
          "slom: the measurement function has the wrong number of parameters: it gets one argument for each "
          "VarID and each datum, none for noise, loss, name and slom::measured");
      if constexpr (right_number) {
        [&]<std::size_t... I>(std::index_sequence<I...>) {
          (requireArgument<static_cast<int>(I) + 1, Given, std::tuple_element_t<I, Wanted>>(), ...);
        }(std::index_sequence_for<Given...>{});
      }
    } else {
      static_assert(
          Call<F, std::tuple<Given...>>::is_possible,
          "slom: the measurement function does not accept these arguments: it gets `const T&` for each VarID<T> "
          "and `const D&` for each datum of type D, in the order of the call");
    }
  }
}

/// Returns whether F takes only the first `Left` of its arguments.
template <class F, std::size_t Left, class... Given>
constexpr bool acceptsFirst() {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    return Call<F, std::tuple<std::tuple_element_t<I, std::tuple<Given...>>...>>::is_possible;
  }(std::make_index_sequence<Left>{});
}
/// Returns the number of data at the end of F's arguments. `Args` are all arguments of insertMeasurement except
/// options.
template <class... Args>
constexpr std::size_t countLastData() {
  constexpr bool is_measured_datum[] = {is_measured<Args>...}, is_variable[] = {is_var_id<Args>...};
  std::size_t count = 0;
  for (std::size_t i = sizeof...(Args); i-- > 0 && !is_variable[i];) count += is_measured_datum[i] ? 0 : 1;
  return count;
}
/// Returns whether F accepts its arguments without the last one or two, which are data.
template <class F, class... Args, class... Given>
constexpr bool getsTooManyData(std::type_identity<std::tuple<Given...>>) {
  constexpr std::size_t given = sizeof...(Given), data = countLastData<Args...>();
  bool accepts = false;
  if constexpr (data >= 1) accepts = acceptsFirst<F, given - 1, Given...>();
  if constexpr (data >= 2) accepts = accepts || acceptsFirst<F, given - 2, Given...>();
  return accepts;
}

/// Fails to compile, with the remedy, if F does not accept its arguments.
template <class F, class... Args, class... Given>
constexpr void requireAccepted(std::type_identity<std::tuple<Given...>> given) {
  if constexpr (!Call<F, std::tuple<Given...>>::is_possible) {
    constexpr bool has_too_many = getsTooManyData<F, Args...>(std::type_identity<std::tuple<Given...>>());
    constexpr bool has_datum = (is_measured<Args> || ...);
    static_assert(
        !has_too_many || !has_datum,
        "slom: the measurement function does not accept the last argument, which counts as data: write an "
        "uncertainty as slom::StandardDeviation(s) or slom::Covariance(c)");
    static_assert(
        !has_too_many || has_datum,
        "slom: the measurement function has too few parameters for its data: mark the datum that it "
        "predicts by slom::measured(z), and write an uncertainty as slom::StandardDeviation(s) or "
        "slom::Covariance(c)");
    if constexpr (!has_too_many) requireAcceptedOne<F>(given);
  }
}

/// Returns whether a parameter would round the value of a variable that is a number.
template <class Arg, class Parameter>
constexpr bool roundsVariable() {
  using P = std::remove_cvref_t<Parameter>;
  return std::is_same_v<Arg, VarID<double>> && (std::is_integral_v<P> || std::is_same_v<P, float>);
}
/// Returns whether any parameter rounds its variable. `Wanted`: the parameters. The function gets those of `Args` that
/// are not marked by slom::measured.
template <class Wanted, class... Args>
constexpr bool roundsVariables() {
  constexpr std::size_t count = (std::size_t{!is_measured<Args>} + ... + 0);
  if constexpr (std::tuple_size_v<Wanted> == count) {
    bool any = false;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      std::size_t next = 0;
      const auto check = [&]<class Arg>(std::type_identity<Arg>) {
        const std::size_t here = is_measured<Arg> ? count : next++;
        ((I == here ? any = any || roundsVariable<Arg, std::tuple_element_t<I, Wanted>>() : false), ...);
      };
      (check(std::type_identity<Args>()), ...);
    }(std::make_index_sequence<count>());
    return any;
  } else {
    return false;
  }
}
template <class F, class... Args>
constexpr bool parametersRoundVariables() {
  if constexpr (Parameters<F>::known) {
    return roundsVariables<typename Parameters<F>::type, Args...>();
  } else {
    return false;
  }
}

}  // namespace detail

}  // namespace slom
