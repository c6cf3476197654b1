/// UnscentedFilter: the unscented Kalman filter on a manifold.
///
///     slom::UnscentedFilter filter(State{...}, slom::Covariance(P0));
///
/// It takes the same functions, noises and options as ErrorStateFilter and needs no derivatives. Functions may have kinks.
/// They are called 2 n + 1 times for n degrees of freedom.
///   predict   mean and covariance of the sigma points, in the tangent space of their mean (sigma_points.hpp)
///   update    the residual is r + D u + e, where x = L u: a Kalman update for the statistical linearisation; then the
///             covariance moves to the tangent space of the new mean (transport.hpp)
///   source    Hertzberg et al. 2013, section 3.5; Brossard, Barrau, Bonnabel 2020
#pragma once

#include <cmath>
#include <cstddef>

#include "slom/filter/filter_base.hpp"
#include "slom/filter/motion_noise.hpp"
#include "slom/filter/sigma_points.hpp"

namespace slom {

/// Distance of the sigma points from the mean, in standard deviations: at least 1.
struct SigmaSpread {
  double value;
  /// Sets the distance.
  explicit constexpr SigmaSpread(double standard_deviations) : value(standard_deviations) {}
};

template <class State, template <class, int> class Form = FullCovariance>
class UnscentedFilter : public FilterBase<State, Form> {
  using Base = FilterBase<State, Form>;
  using typename Base::CovarianceForm;

 public:
  using Base::DOF;
  using typename Base::Matrix;
  using typename Base::scalar;

  /// Starts at a state with its noise. Throws [slom.bad-filter-state] if a number is not finite, the noise is no
  /// covariance, or the spread is below 1.
  template <class N>
  UnscentedFilter(const State& state, const N& noise, SigmaSpread spread = SigmaSpread(std::sqrt(3.)))
      : Base(state, noise), spread_(spread.value) {
    if (!(spread_ >= scalar(1)) || !detail::isFinite(spread_)) {
      mtk::detail::raise(mtk::Error(
          "slom.bad-filter-state",
          "filter: the spread of the sigma points is below 1 or not finite; pass 1 to 3 standard deviations"));
    }
  }
  template <class N>
  UnscentedFilter(const State& state, const N& noise, SquareRoot,
                  SigmaSpread spread = SigmaSpread(std::sqrt(3.)))
      : UnscentedFilter(state, noise, spread) {}

  /// Predicts the state f(state, data...), as ErrorStateFilter::predict does.
  template <class F, class... Args>
  PredictionResult predict(const F& f, const Args&... args) {
    return predictThen([](const auto&) {}, f, args...);
  }
  /// Predicts, and writes the covariance of the errors before (rows) and after the step to `cross`.
  template <class F, class... Args>
  PredictionResult predictWithCross(Matrix& cross, const F& f, const Args&... args) {
    return predictThen(
        [&](const auto& first) {
          cross = detail::product(this->form_.root(), first.template leftCols<DOF>().transpose());
        },
        f, args...);
  }

  /// Predicts, and calls observe(derivative of the motion at the mean) if the step was taken.
  template <class Observe, class F, class... Args>
  PredictionResult predictObserved(const Observe& observe, const F& f, const Args&... args) {
    Matrix derivative;
    const PredictionResult linearised = Base::withPrediction(
        [&](const auto& noise, const auto&... data) {
          return detail::withMotion<State>(
              f, noise, this->state_,
              [&](const State&, const Matrix& F_x, const auto&...) {
                derivative = F_x;
                return FilterStatus::done;
              },
              data...);
        },
        args...);
    if (!linearised) return linearised;
    const PredictionResult result = predict(f, args...);
    if (result) observe(derivative);
    return result;
  }

  /// Updates by the residual of a measurement, as ErrorStateFilter::update does. A loss reweights the measurement for
  /// the statistical linearisation.
  template <class H, class... Args>
  auto update(const H& h, const Args&... args) {
    return updateObserved(Unobserved(), h, args...);
  }
  /// Updates, and calls observe(measurement function, its derivative at the predicted mean, noise) if the measurement was used.
  template <class Observe, class H, class... Args>
  auto updateObserved(const Observe& observe, const H& h, const Args&... args) {
    static_assert(
        (int{std::is_same_v<Args, Iterations>} + ... + 0) == 0,
        "slom: the update of an UnscentedFilter is not iterated: use ErrorStateFilter with slom::Iterations");
    return Base::withMeasurement(
        h,
        [&](const auto& function, const auto& noise, const detail::UpdateSettings& settings,
            FilterStatus status) {
          if constexpr (std::is_same_v<Observe, Unobserved>) {
            return updateBy(function, noise, settings, status);
          } else {
            using Function = std::remove_cvref_t<decltype(function)>;
            typename Function::Jacobian derivative;
            if (status == FilterStatus::done) function.differentiate(this->state_, derivative);
            const auto result = updateBy(function, noise, settings, status);
            if (result) observe(function, derivative, noise);
            return result;
          }
        },
        args...);
  }

 private:
  struct Unobserved {};

  template <class Before, class F, class... Args>
  PredictionResult predictThen(const Before& before, const F& f, const Args&... args) {
    return Base::withPrediction(
        [&](const auto& noise, const auto&... data) { return predictBy(before, f, noise, data...); },
        args...);
  }

  template <class Before, class F, class Noise, class... A>
  FilterStatus predictBy(const Before& before, const F& f, const Noise& stated, const A&... data) {
    if constexpr (detail::is_noise_argument<Noise>) {
      return predictWithInput(before, f, stated, data...);
    } else if constexpr (detail::isMotion<State, F, detail::Motion<F, false>, State, A...>()) {
      const detail::Motion<F, false> motion{f};
      const Matrix L = this->form_.root();
      const auto value = [&](const detail::SigmaPoint& point) {
        return State(motion(moved(L, point), data...));
      };
      return detail::withAdditiveNoise<State>(
          motion, stated, this->state_,
          [&](const auto&... terms) { return predictPoints<DOF>(before, value, terms...); }, data...);
    } else {
      return FilterStatus::function_not_finite;  // does not compile
    }
  }
  /// Predicts with noise of an input, which has sigma points of its own.
  template <class Before, class F, int Q, class Inner, class... A>
  FilterStatus predictWithInput(const Before& before, const F& f, const NoiseArgument<Q, Inner>& argument,
                                const A&... data) {
    using S = scalar;
    using W = mtk::vect<Q, S>;
    using Motion = detail::Motion<F, true>;
    if constexpr (detail::isMotion<State, F, Motion, State, W, A...>()) {
      const Motion motion{f};
      const auto noise = detail::resolvedInput<S, Q>(argument.noise);
      if (!noise.isValid(false)) return FilterStatus::bad_noise;
      detail::SquareMatrix<S, Q> root;
      noise.writeRoot(root, 0, detail::inputFactor<Inner, S>(data...));
      const Matrix L = this->form_.root();
      return predictPoints<DOF + Q>(before, [&](const detail::SigmaPoint& point) {
        W w;
        if (point.column >= DOF) w = W(S(point.sign) * spread_ * root.col(point.column - DOF));
        return State(motion(point.column >= DOF ? this->state_ : moved(L, point), w, data...));
      });
    } else {
      return FilterStatus::function_not_finite;  // does not compile
    }
  }

  /// Predicts from the values at the sigma points of Columns columns, and further noise.
  template <int Columns, class Before, class Value, class... Terms>
  FilterStatus predictPoints(const Before& before, const Value& value, const Terms&... terms) {
    using S = scalar;
    const detail::SigmaWeights<S, Columns> weights(spread_);
    detail::SigmaValues<State, Columns> values;
    values[0] = value(detail::SigmaPoint{});
    for (int k = 1; k <= 2 * Columns; ++k)
      values[std::size_t(k)] = value(detail::SigmaPoint{(k - 1) / 2, k % 2 == 1 ? 1 : -1});
    for (const State& y : values) {
      if (!detail::isFiniteArgument(y)) return FilterStatus::function_not_finite;
    }
    State mean;
    if (!detail::sigmaMean<State, Columns>(values, weights, mean)) return FilterStatus::no_mean;
    detail::SigmaColumns<S, DOF, Columns> columns;
    columns.set(weights, [&](int k) { return mtk::difference(values[std::size_t(k)], mean); });
    CovarianceForm form = this->form_;
    form.compose(detail::ColumnsNoise<S, DOF, Columns>{columns.first},
                 detail::ColumnsNoise<S, DOF, Columns>{columns.second}, terms...);
    if (!form.isFinite()) return FilterStatus::covariance_not_finite;
    before(columns.first);
    return this->commit(mean, form);
  }

  /// Returns the state at a sigma point of L.
  State moved(const Matrix& L, const detail::SigmaPoint& point) const {
    if (point.sign == 0) return this->state_;
    const mtk::tangent_t<State> d = scalar(point.sign) * spread_ * L.col(point.column);
    return mtk::moved<State>(this->state_, d);
  }

  template <class Function, class Noise>
  UpdateResult<scalar, Function::rows> updateBy(const Function& function, const Noise& noise,
                                                const detail::UpdateSettings& settings, FilterStatus status) {
    using S = scalar;
    constexpr int M = Function::rows;
    UpdateResult<S, M> result;
    const auto refused = [&](FilterStatus why) {
      result.status = why;
      return result;
    };
    if (status != FilterStatus::done) return refused(status);
    const detail::SigmaWeights<S, DOF> weights(spread_);
    const Matrix L = this->form_.root();
    std::array<typename Function::Residual, std::size_t{2 * DOF + 1}> r;
    r[0] = function(this->state_);
    typename Function::Residual mean = weights.center * r[0];
    for (int k = 1; k <= 2 * DOF; ++k) {
      r[std::size_t(k)] = function(moved(L, detail::SigmaPoint{(k - 1) / 2, k % 2 == 1 ? 1 : -1}));
      mean += weights.outer * r[std::size_t(k)];
    }
    if (!detail::allFinite(mean)) return refused(FilterStatus::function_not_finite);
    detail::SigmaColumns<S, M, DOF> columns;
    columns.set(weights, [&](int k) { return r[std::size_t(k)]; });

    result.innovation = mean;
    result.depends_on_state = detail::hasEntries(columns.first) || detail::hasEntries(columns.second);
    result.gate = S(settings.gate);
    detail::Correction<S, DOF, M> correction;
    SquareRootCovariance<S, DOF> root;
    mtk::PlainVector<S, DOF> u = mtk::PlainVector<S, DOF>::Zero();  // the correction in units of L
    for (bool settled = false; !settled;) {
      const typename Function::Residual expected = mean + columns.first.lazyProduct(u);
      result.weight = settings.weightOf(noise.squaredLength(expected));
      root.setRoot(Matrix::Identity());
      const auto write_noise = [&](auto& A) {
        noise.writeRoot(A, 0, detail::factorOf(result.weight));
        A.template block<M, DOF>(0, M) = columns.second;
      };
      if (!root.template correctWhitened<M, M + DOF>(columns.first, mean, write_noise, correction)) {
        return refused(FilterStatus::singular_innovation);
      }
      if (result.iterations++ == 0) {
        result.whitened = correction.whitened;
        result.nis = correction.nis;
        if (!settings.passes(double(result.nis), M)) return refused(FilterStatus::gated);
      }
      const S change = (correction.step - u).squaredNorm();  // in standard deviations
      result.converged = settings.mostIterations() == 1 || change < S(1e-4);
      settled = result.iterations >= settings.mostIterations() || change < std::numeric_limits<S>::epsilon();
      u = correction.step;
    }
    CovarianceForm form = this->form_;
    form.setRoot(detail::product(L, root.root()));
    const mtk::tangent_t<State> step = L * u;
    const State next = mtk::moved<State>(this->state_, step);
    Base::transport(form, this->state_, next, step);
    return refused(this->commit(next, form));
  }

  scalar spread_;
};

template <class State, class N>
UnscentedFilter(const State&, const N&) -> UnscentedFilter<State, FullCovariance>;
template <class State, class N>
UnscentedFilter(const State&, const N&, SigmaSpread) -> UnscentedFilter<State, FullCovariance>;
template <class State, class N>
UnscentedFilter(const State&, const N&, SquareRoot) -> UnscentedFilter<State, SquareRootCovariance>;
template <class State, class N>
UnscentedFilter(const State&, const N&, SquareRoot, SigmaSpread)
    -> UnscentedFilter<State, SquareRootCovariance>;

}  // namespace slom
