/// ErrorStateFilter: the extended Kalman filter on a manifold, with exact derivatives.
///
///     slom::ErrorStateFilter filter(State{...}, slom::Covariance(P0));
///     const auto step = filter.predict(motion, slom::Covariance(Q), imu, dt);
///     const auto update = filter.update([](const auto& x, const vec3& gps) { return x.pose.pos - gps; }, gps,
///                                       slom::StandardDeviation(0.5));
///     if (!step || !update) ...                                    // step.message() says why
///
/// The state is any manifold of fixed size (mtk/manifold.hpp). The covariance is in the tangent space of the mean.
///   predict   x := f(x), P := F P F^T + Q, F = d (f(x [+] d) [-] f(x)) / d d
///   update    x := x [+] d, d = -K r, P := J (I - K H) P J^T, with J from transport.hpp
///   iterated  minimises |x [-] mean|^2 in units of P plus the cost of r in units of R by Gauss-Newton steps, which are halved
///             while this cost rises
///   source    Hertzberg et al., "Integrating generic sensor fusion algorithms with sound state representations through
///             encapsulation of manifolds", 2013; Sola, "Quaternion kinematics for the error-state Kalman filter", 2017,
///             sections 5 and 6
#pragma once

#include "slom/filter/filter_base.hpp"
#include "slom/filter/motion_noise.hpp"

namespace slom {

template <class State, template <class, int> class Form = FullCovariance>
class ErrorStateFilter : public FilterBase<State, Form> {
  using Base = FilterBase<State, Form>;
  using typename Base::CovarianceForm;

 public:
  using Base::DOF;
  using typename Base::Matrix;
  using typename Base::scalar;

  /// Starts at a state with its noise. Throws [slom.bad-filter-state] if a number is not finite or the noise is no
  /// covariance. Components may have variance 0.
  template <class N>
  ErrorStateFilter(const State& state, const N& noise) : Base(state, noise) {}
  template <class N>
  ErrorStateFilter(const State& state, const N& noise, SquareRoot) : Base(state, noise) {}

  /// Predicts the state f(state, data...). f is any callable that returns a State; with `const auto&` parameters for the
  /// state its derivatives are exact. Among the arguments is one noise, in any place (options.hpp):
  ///   Covariance(Q), ...         of the new state, in its tangent space, DOF components
  ///   SpectralDensity(q)         the same in continuous time
  ///   noiseArgument<n>(noise)    of an argument of f behind the state
  /// slom::Duration(h) among the data is the duration of the step [s], which f gets as a number. Without it the last of the
  /// data is the duration if it is a number. It must be positive.
  template <class F, class... Args>
  PredictionResult predict(const F& f, const Args&... args) {
    return predictObserved([](const Matrix&) {}, f, args...);
  }
  /// Predicts, and writes the covariance of the errors before (rows) and after the step to `cross`. Smoothers need it.
  template <class F, class... Args>
  PredictionResult predictWithCross(Matrix& cross, const F& f, const Args&... args) {
    return predictObserved(
        [&](const Matrix& F_x) { cross = detail::product(this->form_.matrix(), F_x.transpose()); }, f,
        args...);
  }
  /// Predicts, and calls observe(derivative of the motion) before the state changes.
  template <class Observe, class F, class... Args>
  PredictionResult predictObserved(const Observe& observe, const F& f, const Args&... args) {
    return Base::withPrediction(
        [&](const auto& noise, const auto&... data) {
          return detail::withMotion<State>(
              f, noise, this->state_,
              [&](const State& next, const Matrix& F_x, const auto&... terms) {
                CovarianceForm form = this->form_;
                form.propagate(F_x, terms...);
                observe(F_x);
                return this->commit(next, form);
              },
              data...);
        },
        args...);
  }

  /// Updates by the residual r = h(state, data...), r ~ N(0, R) at the true state, a number or a vector of fixed size; or
  /// by h(state, data...) [-] z if slom::measured(z) is among the arguments. Arguments, in any order behind h: the noise
  /// of R, data, and options:
  ///   Gate(probability)   rejects improbable innovations
  ///   Iterations(n)       iterates up to n times
  ///   Huber(c), ...       a loss of the residual in units of R; the update is iterated, up to 10 times if not stated
  template <class H, class... Args>
  auto update(const H& h, const Args&... args) {
    return updateObserved([](const auto&, const auto&, const auto&) {}, h, args...);
  }
  /// Updates, and calls observe(measurement function, its derivative H, noise) if the measurement was used.
  template <class Observe, class H, class... Args>
  auto updateObserved(const Observe& observe, const H& h, const Args&... args) {
    return Base::withMeasurement(
        h,
        [&](const auto& function, const auto& noise, const detail::UpdateSettings& settings,
            FilterStatus status) { return updateBy(function, noise, settings, status, observe); },
        args...);
  }

 private:
  template <class Function, class Noise, class Observe>
  UpdateResult<scalar, Function::rows> updateBy(const Function& function, const Noise& noise,
                                                const detail::UpdateSettings& settings, FilterStatus status,
                                                const Observe& observe) {
    using S = scalar;
    constexpr int M = Function::rows;
    UpdateResult<S, M> result;
    const auto refused = [&](FilterStatus why) {
      result.status = why;
      return result;
    };
    if (status != FilterStatus::done) return refused(status);
    const int most = settings.mostIterations();
    result.gate = S(settings.gate);
    IteratedCost cost(*this, most > 1);
    S lowest(0);  // the cost at x

    State x = this->state_;                                        // the linearisation point
    CovarianceForm form;                                           // the covariance of the error about x
    mtk::tangent_t<State> offset = mtk::tangent_t<State>::Zero();  // of the predicted mean, from x
    detail::Correction<S, DOF, M> correction;
    typename Function::Jacobian H;
    for (bool is_last = false; !is_last;) {
      form = this->form_;
      if (result.iterations > 0) {
        const mtk::tangent_t<State> d = mtk::difference(x, this->state_);
        Base::transport(form, this->state_, x, d);
        offset = mtk::difference(this->state_, x);
      }
      typename Function::Residual r = function(x);
      function.differentiate(x, H);
      if (!detail::allFinite(r) || !detail::allFinite(H)) return refused(FilterStatus::function_not_finite);
      if (result.iterations == 0) {
        result.innovation = r;
        result.depends_on_state = detail::hasEntries(H);
      }
      const S square = noise.squaredLength(r);
      result.weight = settings.weightOf(square);
      if (result.iterations == 0) lowest = settings.costOf(square);
      r.noalias() += H.lazyProduct(offset);
      const S factor = detail::factorOf(result.weight);
      if (!form.template correct<M>(H, r, noise, factor, correction)) {
        return refused(FilterStatus::singular_innovation);
      }
      correction.step += offset;
      if (result.iterations++ == 0) {
        result.whitened = correction.whitened;
        result.nis = correction.nis;
        if (!settings.passes(double(result.nis), M)) return refused(FilterStatus::gated);
      }
      if (most == 1) break;
      // What the linearised cost gains: the square of the step in standard deviations.
      const S linearised = cost.prior(x) + result.weight * square, gain = linearised - correction.nis;
      const S rounding = S(32) * std::numeric_limits<S>::epsilon() * linearised;
      result.converged = gain <= S(1e-4) + rounding;
      is_last = result.iterations >= most || isSmall(correction.step, form);
      const auto costAt = [&](const State& y) {
        return cost.prior(y) + settings.costOf(noise.squaredLength(function(y)));
      };
      const S slack = result.converged ? S(1e-3) + rounding : S(0);  // rounding errors of the residual
      is_last = !shorten(correction.step, x, costAt, slack, lowest) || is_last;
      if (!is_last) mtk::boxplus<State>(x, correction.step);
    }
    const State next = mtk::moved<State>(x, correction.step);
    Base::transport(form, x, next, correction.step);
    result.status = this->commit(next, form);
    if (result) observe(function, H, noise);
    return result;
  }

  /// The cost of a state by the prediction: |y [-] mean|^2 in units of P. Components without variance count 0.
  class IteratedCost {
   public:
    IteratedCost(const ErrorStateFilter& filter, bool is_used) : filter_(filter) {
      if (!is_used) return;
      root_ = filter.form_.root();
      detail::makeLowerTriangular<DOF, DOF>(root_);
    }
    scalar prior(const State& y) const {
      mtk::tangent_t<State> d = mtk::difference(y, filter_.state_);
      for (int i = 0; i < DOF; ++i) {
        scalar sum = d[i];
        for (int k = 0; k < i; ++k) sum -= root_(i, k) * d[k];
        d[i] = root_(i, i) > scalar(0) ? sum / root_(i, i) : scalar(0);
      }
      return d.squaredNorm();
    }

   private:
    const ErrorStateFilter& filter_;
    Matrix root_;
  };

  /// Halves a step from x while it raises the cost by more than `slack`. Sets `lowest` to the cost at the end of the step.
  /// If no step lowers the cost, sets the step to 0 and returns false.
  template <class CostAt>
  static bool shorten(mtk::tangent_t<State>& step, const State& x, const CostAt& costAt, const scalar& slack,
                      scalar& lowest) {
    for (int half = 0; half < 20; ++half) {
      const scalar reached = costAt(mtk::moved<State>(x, step));
      if (reached <= lowest + slack) {
        lowest = reached;
        return true;
      }
      step /= scalar(2);
    }
    step.setZero();
    return false;
  }
  /// Returns whether a step is far below the standard deviations of the new estimate.
  static bool isSmall(const mtk::tangent_t<State>& step, const CovarianceForm& form) {
    const Matrix P = form.matrix();
    for (int i = 0; i < DOF; ++i) {
      if (!(step[i] * step[i] <= std::numeric_limits<scalar>::epsilon() * P(i, i))) return false;
    }
    return true;
  }
};

template <class State, class N>
ErrorStateFilter(const State&, const N&) -> ErrorStateFilter<State, FullCovariance>;
template <class State, class N>
ErrorStateFilter(const State&, const N&, SquareRoot) -> ErrorStateFilter<State, SquareRootCovariance>;

}  // namespace slom
