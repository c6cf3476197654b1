/// AdaptiveNoise: the covariance of a measurement, estimated along the run.
///
///     slom::AdaptiveNoise<3> noise{slom::StandardDeviation(0.5)};
///     noise.update(filter, position, z);                 // as filter.update(position, z, noise)
///
/// After each update with innovation v, whose stated covariance is S = H P H^T + R,
///   R := R + a c (v v^T - S),   a = 1 / memory,   c = min(1, 1 / (2 a tr(R^-1 S)))
/// so R settles where v v^T is S on average. c keeps at least half of R, so that R stays a covariance: where R starts too
/// small, it grows by a factor in each step, and where it starts too large, it falls as fast as the memory allows.
/// It can tell the noise of a measurement only if the noise of the motion is right. A measurement that its gate rejects
/// is not learned from: a gate and an R that starts too small reject everything.
///   source  innovations by Mehra, "Approaches to adaptive filtering", 1972; the form v v^T - H P H^T with forgetting by
///           Mohamed and Schwarz, "Adaptive Kalman filtering for INS/GPS", 1999
#pragma once

#include "slom/filter/error_state_filter.hpp"

namespace slom {

template <int M, class S = double>
class AdaptiveNoise {
 public:
  using Matrix = detail::SquareMatrix<S, M>;

  /// Begins with stated noise. memory: measurements after which old ones have lost their weight, > 1; a throw of
  /// [slom.bad-option] refuses others, and noise that is no covariance.
  template <class N>
    requires IsNoise<N>
  explicit AdaptiveNoise(const N& stated, S memory = S(100)) : rate_(S(1) / memory) {
    const auto noise = detail::resolvedNoise<S, M>(stated);
    if (!(memory > S(1)) || !noise.isValid(true)) {
      mtk::detail::raise(mtk::Error(
          "slom.bad-option",
          "adaptive noise: the memory is not above 1, or the stated noise is not positive definite; "
          "pass a memory such as 100 and variances > 0",
          "adaptive noise"));
    }
    R_.setZero();
    noise.addTo(R_);
  }

  /// Returns R.
  const Matrix& covariance() const { return R_; }

  /// Updates the filter with R among the arguments, and then R.
  template <class Filter, class H, class... Args>
  auto update(Filter& filter, const H& h, const Args&... args) {
    const auto P = filter.covariance();
    Matrix expected = R_;  // S
    const auto result = filter.updateObserved(
        [&](const auto&, const auto& H_x, const auto&) {
          expected += detail::product(detail::product(H_x, P), H_x.transpose());
        },
        h, args..., Covariance(Matrix(R_)));
    if (result) learn(result.innovation, expected);
    return result;
  }

 private:
  template <class V>
  void learn(const V& innovation, const Matrix& expected) {
    Matrix root, whitened = expected;
    if (!detail::factorize<M>(R_, root)) return;
    detail::solveLower<M>(root, whitened);  // L^-1 S, whose transpose gives L^-1 S L^-T
    Matrix ratio = whitened.transpose();
    detail::solveLower<M>(root, ratio);
    const S most = S(1) / (S(2) * ratio.trace()), rate = rate_ < most ? rate_ : most;
    R_ += rate * (innovation * innovation.transpose() - expected);
  }

  S rate_;
  Matrix R_;
};

}  // namespace slom
