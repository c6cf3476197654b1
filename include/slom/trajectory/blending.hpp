/// Blending: the weights of a cumulative B-spline on one segment.
///   basis       B_j(t), j = 0, ..., N - 1: the weights of the N control points, with sum 1
///   cumulative  b_j(t) = B_j + ... + B_{N-1}, j = 1, ..., N - 1: the weight of the step from control point j - 1 to j
/// Both are polynomials of degree N - 1 in u = (t - start) / spacing. Outside the segment they continue as polynomials.
///   source      recursion of Cox and de Boor, on coefficients of polynomials; Qin, "General matrix representations for
///               B-splines", 2000; cumulative form: Kim, Kim and Shin, "A general construction scheme for unit
///               quaternion curves with simple high order derivatives", 1995
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "mtk/dual.hpp"
#include "slom/trajectory/knots.hpp"

namespace slom::trajectory {

namespace detail {

template <int N>
using Polynomial = std::array<double, static_cast<std::size_t>(N)>;

/// Returns the derivative of order D by time of the polynomial p in u = since / spacing.
template <int D, std::size_t N, class T>
T derivativeOf(const std::array<double, N>& p, const T& since, double spacing) {
  if constexpr (mtk::detail::is_dual<T>) {  // the chain rule once, not in each step of Horner's scheme
    return mtk::detail::chain(since, derivativeOf<D>(p, since.value(), spacing),
                              derivativeOf<D + 1>(p, since.value(), spacing));
  } else {
    const T u = since / T(spacing);
    T sum(0.0);
    for (int k = static_cast<int>(N) - 1; k >= D; --k) {
      int falling = 1;  // k (k - 1) ... (k - D + 1)
      for (int m = 0; m < D; ++m) falling *= k - m;
      sum = sum * u + T(falling * p[static_cast<std::size_t>(k)]);
    }
    for (int m = 0; m < D; ++m) sum = sum / T(spacing);
    return sum;
  }
}

/// Returns p(u) (u - root) / scale for a polynomial whose degree leaves room for one more.
template <int N>
constexpr Polynomial<N> timesLinear(const Polynomial<N>& p, double root, double scale) {
  Polynomial<N> result{};
  for (std::size_t k = 0; k < p.size(); ++k) {
    result[k] += -root / scale * p[k];
    if (k + 1 < p.size()) result[k + 1] += p[k] / scale;
  }
  return result;
}

/// Returns the cumulative weights b_1, ..., b_{N-1} as polynomials in u. x: the knots i - N + 2, ..., i + N - 1 around
/// segment i in the unit u, so that x[N - 2] = 0 and x[N - 1] = 1.
template <int N>
constexpr std::array<Polynomial<N>, std::size_t{N - 1}> cumulativeWeights(
    const std::array<double, std::size_t{2 * N - 2}>& x) {
  std::array<Polynomial<N>, std::size_t{N}> basis{};
  basis[0][0] = 1;
  for (int order = 2; order <= N; ++order) {
    std::array<Polynomial<N>, std::size_t{N}> next{};
    for (int r = 0; r < order; ++r) {
      const auto first = static_cast<std::size_t>(N - 1 - order + r), m = static_cast<std::size_t>(order);
      for (std::size_t k = 0; k < std::size_t{N}; ++k) next[static_cast<std::size_t>(r)][k] = 0;
      if (r > 0) {  // rises from the first knot of the support on
        const auto rising =
            timesLinear<N>(basis[static_cast<std::size_t>(r - 1)], x[first], x[first + m - 1] - x[first]);
        for (std::size_t k = 0; k < std::size_t{N}; ++k) next[static_cast<std::size_t>(r)][k] += rising[k];
      }
      if (r + 1 < order) {  // falls until its last knot
        const auto falling =
            timesLinear<N>(basis[static_cast<std::size_t>(r)], x[first + m], x[first + 1] - x[first + m]);
        for (std::size_t k = 0; k < std::size_t{N}; ++k) next[static_cast<std::size_t>(r)][k] += falling[k];
      }
    }
    basis = next;
  }
  std::array<Polynomial<N>, std::size_t{N - 1}> cumulative{};
  for (std::size_t j = std::size_t{N - 1}; j > 0; --j) {
    for (std::size_t k = 0; k < std::size_t{N}; ++k) {
      cumulative[j - 1][k] = basis[j][k] + (j + 1 < std::size_t{N} ? cumulative[j][k] : 0.0);
    }
  }
  return cumulative;
}

/// Returns the knots of a uniform spline around the segment from 0 to 1.
template <int N>
constexpr std::array<double, std::size_t{2 * N - 2}> unitKnots() {
  std::array<double, std::size_t{2 * N - 2}> x{};
  for (int k = 0; k < 2 * N - 2; ++k) x[static_cast<std::size_t>(k)] = k - (N - 2);
  return x;
}
/// The weights on each segment of a uniform spline.
template <int N>
inline constexpr auto uniform_weights = cumulativeWeights<N>(unitKnots<N>());

}  // namespace detail

/// The weights of order N on one segment.
template <int N>
class Blending {
  static_assert(N >= 2 && N <= 6, "slom: splines have an order from 2 (linear) to 6 (degree 5)");

 public:
  static constexpr int order = N;
  static constexpr std::size_t steps = std::size_t{N - 1};

  /// Computes the weights on segment `i` between these knots.
  Blending(const Knots& knots, std::int64_t i) : start_(knots[i]), spacing_(knots[i + 1] - knots[i]) {
    if (knots.isUniform()) {
      weights_ = detail::uniform_weights<N>;
    } else {
      std::array<double, std::size_t{2 * N - 2}> x{};
      for (int k = 0; k < 2 * N - 2; ++k) {
        x[static_cast<std::size_t>(k)] = (knots[i - (N - 2) + k] - start_) / spacing_;
      }
      weights_ = detail::cumulativeWeights<N>(x);
    }
  }

  /// Returns the first knot of the segment.
  double start() const { return start_; }
  /// Returns the time between the two knots of the segment.
  double spacing() const { return spacing_; }

  /// Returns b_1(t), ..., b_{N-1}(t), or their derivatives by time of order `Derivative`. The time may be of any number
  /// type. If it carries derivatives, so do the weights.
  template <int Derivative = 0, class Time>
  auto at(const Time& t) const {
    const auto since = t - start_;
    using T = std::remove_cvref_t<decltype(since)>;
    std::array<T, steps> result;
    for (std::size_t j = 0; j < steps; ++j)
      result[j] = detail::derivativeOf<Derivative>(weights_[j], since, spacing_);
    return result;
  }

 private:
  double start_, spacing_;
  std::array<detail::Polynomial<N>, steps> weights_;
};

}  // namespace slom::trajectory
