/// FilterBase: mean and covariance of a state on a manifold, and what all filters do with them.
#pragma once

#include <cstddef>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/error.hpp"
#include "mtk/manifold.hpp"
#include "slom/filter/arguments.hpp"
#include "slom/filter/full_covariance.hpp"
#include "slom/filter/noise.hpp"
#include "slom/filter/residual.hpp"
#include "slom/filter/square_root_covariance.hpp"
#include "slom/filter/status.hpp"
#include "slom/filter/transport.hpp"

namespace slom {

namespace detail {

[[noreturn, gnu::noinline, gnu::cold]] inline void raiseBadFilterState() {
  std::string text = "filter: ";
  text += toString(FilterStatus::bad_state);
  mtk::detail::raise(mtk::Error("slom.bad-filter-state", text));
}

}  // namespace detail

/// Selects the square-root form of a filter: `slom::ErrorStateFilter filter(x0, slom::Covariance(P0), slom::square_root)`.
struct SquareRoot {};
inline constexpr SquareRoot square_root{};

/// The result of an update. It converts to true if the filter used the measurement.
template <class S, int M>
struct [[nodiscard("a refused update leaves the filter unchanged: look at the result")]] UpdateResult {
  static constexpr int dof = M;  ///< length of the residual
  FilterStatus status = FilterStatus::done;
  mtk::PlainVector<S, M> innovation = mtk::PlainVector<S, M>::Zero();  ///< residual at the predicted state
  mtk::PlainVector<S, M> whitened =
      mtk::PlainVector<S, M>::Zero();  ///< the innovation; N(0, I) if the model holds
  S nis = S(0);        ///< normalised innovation squared |whitened|^2; chi-square with M degrees of freedom
  S gate = S(1);       ///< probability of passing its gate; 1 without a gate
  S weight = S(1);     ///< of the loss, in [0, 1]; 1 without a loss
  int iterations = 0;  ///< linearisations of the measurement
  bool converged = true;  ///< of an iterated update: its last step was below 1 % of the standard deviations
  bool depends_on_state = true;  ///< false if all derivatives of the measurement are exactly 0 here

  explicit operator bool() const { return status == FilterStatus::done; }
  /// Returns the sentence of the status. If the measurement was used, says whether it does not depend on the state, or its
  /// iterated update did not converge.
  const char* message() const {
    if (status != FilterStatus::done || (converged && depends_on_state)) return toString(status);
    if (!depends_on_state) {
      return "the measurement does not depend on the state here, so the filter is unchanged; check that the function uses its "
             "state, and that the state is not at a point where its derivatives are 0";
    }
    return "the measurement was used, but its iterated update did not converge; allow more iterations, and check "
           "that the state is known well enough for this measurement";
  }
};

/// The estimate: x_true = state [+] e with e ~ N(0, covariance), in the tangent space of the state. The order of its
/// components is that of mtk::componentNames(state).
template <class State, template <class, int> class Form>
class FilterBase {
  static_assert((mtk::requireManifold<State>(), true));

 public:
  using scalar = mtk::scalar_t<State>;
  static constexpr int DOF = mtk::DOF_v<State>;
  static_assert(DOF != mtk::Dynamic, "slom: a filter needs a state of a size known at compile time");
  using Matrix = detail::SquareMatrix<scalar, DOF>;
  using CovarianceForm = Form<scalar, DOF>;

  /// Returns the mean.
  const State& state() const { return state_; }
  /// Returns the covariance, DOF x DOF.
  Matrix covariance() const { return form_.matrix(); }
  /// Returns L with L L^T = covariance.
  Matrix covarianceRoot() const { return form_.root(); }
  /// Returns the standard deviation of each component.
  mtk::tangent_t<State> standardDeviations() const {
    using std::sqrt;
    const Matrix P = form_.matrix();
    mtk::tangent_t<State> sigma;
    for (int i = 0; i < DOF; ++i) sigma[i] = sqrt(P(i, i) > scalar(0) ? P(i, i) : scalar(0));
    return sigma;
  }
  /// Returns the normalised estimation error squared (NEES) e^T covariance^-1 e, e = truth [-] state; NaN if the
  /// covariance is singular.
  scalar nees(const State& truth) const {
    detail::SquareMatrix<scalar, DOF> L;
    const bool is_definite = detail::factorize<DOF>(Matrix(form_.matrix()), L);
    mtk::tangent_t<State> e = mtk::difference(truth, state_);
    detail::solveLower<DOF>(L, e);
    return is_definite ? e.squaredNorm() : std::numeric_limits<scalar>::quiet_NaN();
  }

  /// Sets state and covariance. Refuses numbers that are not finite, and noise that is no covariance (bad_state).
  template <class N>
    requires IsNoise<N>
  FilterStatus reset(const State& state, const N& noise) {
    const auto resolved = detail::resolvedNoise<scalar, DOF>(noise);
    if (!resolved.isValid(false) || !detail::isFiniteArgument(state)) return FilterStatus::bad_state;
    state_ = state;
    form_.set(resolved);
    return FilterStatus::done;
  }

 protected:
  template <class N>
  FilterBase(const State& state, const N& noise) {
    static_assert(IsNoise<N> && !std::is_same_v<N, UnitCovariance>,
                  "slom: a filter starts from a state and its noise: pass slom::Covariance(P0) or "
                  "slom::StandardDeviation(sigmas)");
    if (reset(state, noise) != FilterStatus::done) {
      detail::raiseBadFilterState();
    }
  }

  /// Moves the covariance from the tangent space of `from`, at the error d, to that of `to` = from [+] d.
  static void transport(CovarianceForm& form, const State& from, const State& to,
                        const mtk::tangent_t<State>& d) {
    detail::forEachTransport(from, to, d, [&](int at, const auto& J) { form.transform(at, J); });
  }

  /// Takes over a state and a covariance if they are finite.
  FilterStatus commit(const State& state, const CovarianceForm& form) {
    if (!detail::isFiniteArgument(state)) return FilterStatus::function_not_finite;
    if (!form.isFinite()) return FilterStatus::covariance_not_finite;
    state_ = state;
    form_ = form;
    return FilterStatus::done;
  }

  /// Returns whether these are arguments of a prediction; otherwise fails to compile.
  template <class... Args>
  static constexpr bool isPrediction() {
    constexpr bool has_noise = (int{detail::is_motion_noise<Args>} + ... + 0) == 1;
    static_assert(
        has_noise,
        "slom: a prediction takes its noise once: pass slom::Covariance(Q) or slom::StandardDeviation(s), "
        "slom::SpectralDensity(q), or slom::noiseArgument<n>(noise)");
    constexpr bool has_options = (detail::is_update_option<Args> || ...);
    static_assert(!has_options, "slom: gates, losses and iterations belong to update(), not to predict()");
    constexpr bool has_datum = (detail::is_measured<Args> || ...);
    static_assert(!has_datum, "slom: a prediction has no datum; pass it to update()");
    constexpr int durations = (int{detail::is_duration<Args>} + ... + 0);
    constexpr bool has_duration = durations == 1 || (durations == 0 && !(detail::is_density<Args> || ...));
    static_assert(
        has_duration,
        "slom: a prediction with slom::SpectralDensity needs its duration, and any prediction has at most one: "
        "pass slom::Duration(seconds) among the data, which the motion gets as a number");
    constexpr bool has_integer = durations == 0 && detail::endsWithInteger<Args...>();
    static_assert(
        !has_integer,
        "slom: the last number of a prediction is its duration, and this one is an integer: pass seconds as a "
        "floating-point number, or mark the duration by slom::Duration and pass an index before it");
    return has_noise && !has_options && !has_datum && has_duration && !has_integer;
  }
  /// Checks the arguments of a prediction that do not depend on the filter.
  template <class... Args>
  static FilterStatus checkPrediction(const Args&... args) {
    if (!detail::hasGoodDuration(args...)) return FilterStatus::bad_duration;
    const auto good = [](const auto& x) {
      return !detail::is_passed<std::remove_cvref_t<decltype(x)>> || detail::isFiniteArgument(x);
    };
    return (good(args) && ...) ? FilterStatus::done : FilterStatus::data_not_finite;
  }

  /// Calls body(noise, data...) with the parts of a prediction's arguments.
  template <class Body, class... Args>
  static PredictionResult withPrediction(const Body& body, const Args&... args) {
    if constexpr (isPrediction<Args...>()) {
      const FilterStatus checked = checkPrediction(args...);
      if (checked != FilterStatus::done) return {checked};
      return {
          std::apply([&](const auto&... data) { return body(detail::filterNoiseAmong(args...), data...); },
                     detail::passedArguments(args...))};
    } else {
      return {FilterStatus::bad_noise};  // does not compile
    }
  }

  /// Calls body(measurement function, noise, settings) with the parts of an update's arguments.
  template <class H, class Body, class... Args>
  static auto withMeasurement(const H& h, const Body& body, const Args&... args) {
    constexpr bool has_noise = (int{IsNoise<Args> && !std::is_same_v<Args, UnitCovariance>} + ... + 0) == 1 &&
                               (int{detail::is_motion_noise<Args>} + ... + 0) == 1;
    static_assert(
        has_noise,
        "slom: an update takes its noise once: pass slom::StandardDeviation(s) or slom::Covariance(R)");
    constexpr bool has_datum = (int{detail::is_measured<Args>} + ... + 0) <= 1;
    static_assert(has_datum, "slom: an update predicts one datum: mark one argument by slom::measured");
    constexpr bool has_duration = (detail::is_duration<Args> || ...);
    static_assert(!has_duration, "slom: an update has no duration; pass slom::Duration to predict()");
    return std::apply(
        [&](const auto&... data) {
          using H0 = std::remove_cvref_t<H>;
          constexpr bool accepted =
              detail::is_function<H0> && std::is_invocable_v<const H0&, const State&, decltype(data)...>;
          static_assert(
              accepted,
              "slom: the measurement function of an update comes first and is called with the state and the "
              "data that are passed: mark the datum that it predicts by slom::measured(z), and write an "
              "uncertainty as slom::StandardDeviation(s) or slom::Covariance(R)");
          if constexpr (accepted && has_noise && has_datum && !has_duration) {
            const auto datum = detail::datumAmong(args...);
            const detail::MeasurementFunction<H0, State, std::remove_const_t<decltype(datum)>,
                                              std::remove_cvref_t<decltype(data)>...>
            function(h, datum, data...);
            const auto& noise = detail::filterNoiseAmong(args...);
            const auto resolved =
                detail::resolvedNoise<scalar, std::remove_cvref_t<decltype(function)>::rows>(noise);
            detail::UpdateSettings settings;
            const auto take = [&](const auto& x) {
              if constexpr (detail::is_update_option<std::remove_cvref_t<decltype(x)>>) settings.take(x);
            };
            (take(args), ...);
            const auto good = [](const auto& x) {
              using A = std::remove_cvref_t<decltype(x)>;
              return !(detail::is_passed<A> || detail::is_measured<A>) || detail::isFiniteArgument(x);
            };
            const FilterStatus status = !(good(args) && ...)              ? FilterStatus::data_not_finite
                                        : !resolved.isValid(true)         ? FilterStatus::bad_noise
                                        : !settings.loss.hasGoodNumbers() ? FilterStatus::bad_loss
                                                                          : FilterStatus::done;
            return body(function, resolved, settings, status);
          }
        },
        detail::passedArguments(args...));
  }

  State state_;
  CovarianceForm form_;
};

}  // namespace slom
