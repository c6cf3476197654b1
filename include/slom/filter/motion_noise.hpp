/// The noise of a motion for the linearised prediction: the new state, its derivative, and terms of covariance.
#pragma once

#include <limits>
#include <tuple>
#include <type_traits>
#include <utility>

#include "slom/filter/arguments.hpp"
#include "slom/filter/linearization.hpp"
#include "slom/filter/noise.hpp"
#include "slom/filter/options.hpp"
#include "slom/filter/status.hpp"

namespace slom::detail {

/// Noise as a motion gets it. An index beyond the end reads NaN, so that the step is refused.
template <class V>
struct NoiseVector : V {
  using T = typename V::scalar;
  explicit NoiseVector(const V& v) : V(v) {}
  T operator[](Eigen::Index i) const { return entry(i); }
  T operator()(Eigen::Index i) const { return entry(i); }

 private:
  T entry(Eigen::Index i) const {
    return i >= 0 && i < V::DOF ? T(this->coeff(i)) : T(std::numeric_limits<double>::quiet_NaN());
  }
};

/// Returns what a motion gets for a datum: the number of a duration.
template <class A>
const auto& motionDatum(const A& x) {
  if constexpr (is_duration<A>) {
    return x.seconds;
  } else {
    return x;
  }
}
template <class A>
using MotionDatum = decltype(motionDatum(std::declval<const A&>()));

/// A motion as filters call it: f(state, data...), or f(state, w, data...) with noise.
template <class F, bool HasNoise>
struct Motion {
  const F& f;
  template <class X, class... A>
  auto operator()(const X& x, const A&... data) const
      -> std::remove_cvref_t<std::invoke_result_t<const F&, const X&, MotionDatum<A>...>> {
    return f(x, motionDatum(data)...);
  }
};
template <class F>
struct Motion<F, true> {
  const F& f;
  template <class X, class W, class... A>
  auto operator()(const X& x, const W& w, const A&... data) const -> std::remove_cvref_t<
      std::invoke_result_t<const F&, const X&, const NoiseVector<W>&, MotionDatum<A>...>> {
    return f(x, NoiseVector<W>(w), motionDatum(data)...);
  }
};
/// A motion over a part of the duration.
template <class M, class T>
struct PartOfMotion {
  const M& motion;
  Duration<T> part;
  template <class A>
  const auto& replaced(const A& x) const {
    if constexpr (is_duration<A>) {
      return part;
    } else {
      return x;
    }
  }
  template <class... A>
  auto operator()(const A&... arguments) const -> std::invoke_result_t<const M&, const A&...> {
    return motion(replaced(arguments)...);
  }
};

/// Returns whether f, with these arguments, returns a State; otherwise fails to compile.
template <class State, class F, class M, class... A>
constexpr bool isMotion() {
  constexpr bool accepted = is_function<F> && std::is_invocable_v<const M&, const A&...>;
  static_assert(
      accepted,
      "slom: the motion of a prediction comes first and is called with the state, with slom::noiseArgument the "
      "noise, and the data that are passed: check their number and types, and write a covariance as "
      "slom::Covariance(Q)");
  if constexpr (accepted) {
    constexpr bool returns_state = std::is_convertible_v<std::invoke_result_t<const M&, const A&...>, State>;
    static_assert(returns_state,
                  "slom: the motion of a prediction must return the new state, of the type of the state");
    return returns_state;
  } else {
    return false;
  }
}

/// Returns stated noise, or the covariance of a density in one second.
template <class S, int N, class Noise>
auto resolvedInput(const Noise& stated) {
  if constexpr (is_density<Noise>) {
    return resolvedNoise<S, N>(Covariance(stated.value));
  } else {
    return resolvedNoise<S, N>(stated);
  }
}

/// Calls finish(terms of covariance...) for noise that is added to the new state; returns its status, or why not.
template <class State, class M, class Noise, class Finish, class... A>
FilterStatus withAdditiveNoise(const M& motion, const Noise& stated, const State& x, const Finish& finish,
                               const A&... data) {
  using S = mtk::scalar_t<State>;
  constexpr int N = mtk::DOF_v<State>;
  const auto noise = resolvedInput<S, N>(stated);
  if (!noise.isValid(false)) return FilterStatus::bad_noise;
  if constexpr (is_density<Noise>) {
    // Gauss-Legendre on [0, 1]: abscissas (1 +- sqrt(3/5)) / 2 and 1/2, weights 5/18 and 8/18.
    constexpr double abscissa[] = {0.1127016653792583, 0.5, 0.8872983346207417};
    constexpr double weight[] = {5. / 18, 8. / 18, 5. / 18};
    const auto h = durationAmong(data...);
    using T = std::remove_const_t<decltype(h)>;
    MappedNoise<S, N, N, std::remove_const_t<decltype(noise)>> terms[3];
    for (int k = 0; k < 3; ++k) {
      const PartOfMotion<M, T> part{motion, Duration<T>(h * T(abscissa[k]))};
      const State there = part(x, data...);
      linearizeMotion(terms[k].G, part, there, std::tuple<const State&>(x), data...);
      if (!allFinite(terms[k].G)) return FilterStatus::function_not_finite;
      terms[k].noise = noise;
      terms[k].factor = S(weight[k]) * S(h);
    }
    return finish(terms[0], terms[1], terms[2]);
  } else {
    return finish(noise);
  }
}

/// Returns the status; if the covariance is not finite, and the derivative neither, names the function.
template <class J>
FilterStatus withReason(FilterStatus status, const J& derivative) {
  const bool is_function = status == FilterStatus::covariance_not_finite && !allFinite(derivative);
  return is_function ? FilterStatus::function_not_finite : status;
}

/// Returns the factor of an input's covariance: 1 / duration for a density.
template <class Inner, class S, class... A>
S inputFactor([[maybe_unused]] const A&... data) {
  if constexpr (is_density<Inner>) {
    return S(1) / S(durationAmong(data...));
  } else {
    return S(1);
  }
}

/// Calls finish(new state, derivative, terms of covariance...) for a motion f; returns its status, or why not.
template <class State, class F, class Noise, class Finish, class... A>
FilterStatus withMotion(const F& f, const Noise& stated, const State& x, const Finish& finish,
                        const A&... data) {
  using S = mtk::scalar_t<State>;
  constexpr int N = mtk::DOF_v<State>;
  if constexpr (is_noise_argument<Noise>) {
    return [&]<int Q, class Inner>(const NoiseArgument<Q, Inner>& argument) {
      using W = mtk::vect<Q, S>;
      using M = Motion<F, true>;
      if constexpr (isMotion<State, F, M, State, W, A...>()) {
        const M motion{f};
        MappedNoise<S, N, Q, decltype(resolvedInput<S, Q>(argument.noise))> term{
            {}, resolvedInput<S, Q>(argument.noise)};
        if (!term.noise.isValid(false)) return FilterStatus::bad_noise;
        term.factor = inputFactor<Inner, S>(data...);
        const W w;
        const State next = motion(x, w, data...);
        FixedMatrix<S, N, N + Q> J;
        linearizeMotion(J, motion, next, std::tuple<const State&, const W&>(x, w), data...);
        term.G = J.template rightCols<Q>();
        return withReason(finish(next, SquareMatrix<S, N>(J.template leftCols<N>()), term), J);
      } else {
        return FilterStatus::function_not_finite;
      }
    }(stated);
  } else if constexpr (isMotion<State, F, Motion<F, false>, State, A...>()) {
    const Motion<F, false> motion{f};
    const State next = motion(x, data...);
    SquareMatrix<S, N> J;
    linearizeMotion(J, motion, next, std::tuple<const State&>(x), data...);
    return withAdditiveNoise<State>(
        motion, stated, x, [&](const auto&... terms) { return withReason(finish(next, J, terms...), J); },
        data...);
  } else {
    return FilterStatus::function_not_finite;  // does not compile
  }
}

}  // namespace slom::detail
