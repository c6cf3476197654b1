/// RtsSmoother: estimates of all states of a run given all measurements, for any filter of this folder.
///
///     slom::RtsSmoother run(filter);            // a copy of a filter, at the start
///     run.predict(motion, noise, ...);          // as of the filter
///     run.update(h, data, noise);
///     for (const auto& [state, covariance] : run.smoothed()) ...
///
/// For each prediction from x to x', with C the covariance between their errors and G = C P'^-1:
///   x := x [+] G (x'_smoothed [-] x'_predicted)
///   P := P - G C^T + G P'_smoothed G^T, with P'_smoothed seen from x'_predicted, and moved to the new x
/// The memory grows with the run.
///   source  Rauch, Tung, Striebel, "Maximum likelihood estimates of linear dynamic systems", 1965; with C of sigma points
///           Sarkka, "Unscented Rauch-Tung-Striebel smoother", 2008; on manifolds: differences in tangent spaces
#pragma once

#include <cstddef>
#include <vector>

#include "slom/filter/filter_base.hpp"

namespace slom {

/// A state and the covariance of its error, in the tangent space of the state.
template <class State>
struct StateEstimate {
  State state;
  detail::SquareMatrix<mtk::scalar_t<State>, mtk::DOF_v<State>> covariance;
};

namespace detail {

/// Writes G with G P = C for symmetric P without negative eigenvalues. Where P has a direction without variance, G is 0
/// in a component of it.
template <class S, int N>
SquareMatrix<S, N> smootherGain(const SquareMatrix<S, N>& C, const SquareMatrix<S, N>& P) {
  SquareMatrix<S, N> L;
  factorize<N>(P, L);
  SquareMatrix<S, N> X = C.transpose();  // P X = C^T, G = X^T
  for (int c = 0; c < N; ++c) {
    for (int i = 0; i < N; ++i) {
      S sum = X(i, c);
      for (int k = 0; k < i; ++k) sum -= L(i, k) * X(k, c);
      X(i, c) = L(i, i) > S(0) ? sum / L(i, i) : S(0);
    }
    for (int i = N - 1; i >= 0; --i) {
      S sum = X(i, c);
      for (int k = i + 1; k < N; ++k) sum -= L(k, i) * X(k, c);
      X(i, c) = L(i, i) > S(0) ? sum / L(i, i) : S(0);
    }
  }
  return X.transpose();
}

/// Replaces the covariance at x by that of the difference to `origin`: D P D^T, D = d ((x [+] e) [-] origin) / d e.
template <class State, class Matrix>
void moveToOrigin(const State& x, const State& origin,
                  FullCovariance<mtk::scalar_t<State>, mtk::DOF_v<State>>& P) {
  mtk::detail::forEachBasicPart(x, origin, 0, [&](const auto& part, const auto& from, int at) {
    using Part = std::remove_cvref_t<decltype(part)>;
    using S = mtk::scalar_t<State>;
    constexpr int n = mtk::DOF_v<Part>;
    if constexpr (!mtk::detail::AddsToState<Part> && !requires { Part::keeps_covariance; }) {
      SquareMatrix<S, n> D;
      if constexpr (mtk::is_rebindable_v<Part>) {
        differentiate(
            D, [](const auto& dual) { return dual; },
            [&](const auto& y, const auto& sink) { eachDifference(y, from, 0, sink); }, part);
      } else {
        differentiateNumerically(
            D, [&](const Part& y) { return mtk::difference<Part>(y, from); }, part);
      }
      P.template transform<n>(at, D);
    }
  });
}

}  // namespace detail

template <class Filter>
class RtsSmoother {
 public:
  using State = std::remove_cvref_t<decltype(std::declval<const Filter&>().state())>;
  using Matrix = typename Filter::Matrix;
  using Estimate = StateEstimate<State>;

  /// Begins at the estimate of a filter.
  explicit RtsSmoother(const Filter& filter) : filter_(filter) {}

  /// Returns the filter, with what was taken so far.
  const Filter& filter() const { return filter_; }
  /// Predicts as the filter does, and records the step.
  template <class... Args>
  PredictionResult predict(const Args&... args) {
    Step step{{filter_.state(), filter_.covariance()}, {}, Matrix::Zero()};
    const PredictionResult result = filter_.predictWithCross(step.cross, args...);
    if (result) {
      step.predicted = {filter_.state(), filter_.covariance()};
      steps_.push_back(step);
    }
    return result;
  }
  /// Updates as the filter does.
  template <class... Args>
  auto update(const Args&... args) {
    return filter_.update(args...);
  }

  /// Returns the smoothed estimates: of the start, and of the state after each prediction.
  std::vector<Estimate> smoothed() const {
    std::vector<Estimate> all(steps_.size() + 1);
    all.back() = {filter_.state(), filter_.covariance()};
    for (std::size_t k = steps_.size(); k-- > 0;) all[k] = smoothedBy(steps_[k], all[k + 1]);
    return all;
  }

 private:
  struct Step {
    Estimate filtered, predicted;
    Matrix cross;
  };

  static Estimate smoothedBy(const Step& step, const Estimate& next) {
    using S = mtk::scalar_t<State>;
    constexpr int N = mtk::DOF_v<State>;
    const Matrix G = detail::smootherGain<S, N>(step.cross, step.predicted.covariance);
    const auto asNoise = [](const Matrix& P) {
      detail::FullNoise<S, N> noise;
      noise.covariance = P;
      return noise;
    };
    FullCovariance<S, N> P;
    P.set(asNoise(next.covariance));
    detail::moveToOrigin<State, Matrix>(next.state, step.predicted.state, P);
    const mtk::tangent_t<State> d = G * mtk::difference(next.state, step.predicted.state);
    const Matrix rest = step.filtered.covariance - G * step.cross.transpose();
    P.propagate(G, asNoise(rest));
    const State state = mtk::moved<State>(step.filtered.state, d);
    detail::forEachTransport(step.filtered.state, state, d,
                             [&](int at, const auto& J) { P.transform(at, J); });
    return {state, P.matrix()};
  }

  Filter filter_;
  std::vector<Step> steps_;
};

}  // namespace slom
