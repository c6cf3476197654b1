/// Weighted mean and covariance of samples on a manifold.
///   source   Hertzberg et al. 2013, section 3.4: the mean is the point whose differences to the samples sum
///            to zero, found by fixed-point iteration; the covariance lives in the tangent space there.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "mtk/manifold.hpp"

namespace mtk {

namespace detail {
/// Checks the weights (empty: all 1) and returns their sum.
template <class S>
S checkedWeightSum(std::size_t samples, std::span<const S> weights) {
  if (samples == 0) throw Error("mtk.no-samples", "the mean of no samples does not exist; pass at least one");
  if (weights.empty()) return S(samples);
  if (weights.size() != samples) {
    throw Error("mtk.weight-count", std::to_string(weights.size()) + " weights for " +
                                        std::to_string(samples) +
                                        " samples; pass one weight for each sample, or none");
  }
  S sum(0);
  for (std::size_t i = 0; i < samples; ++i) {
    if (!(weights[i] >= S(0)) || !(weights[i] <= std::numeric_limits<S>::max())) {
      throw Error("mtk.bad-weight", "weight " + std::to_string(i) + " is " +
                                        classicText("%f", static_cast<double>(weights[i])) +
                                        "; weights must be finite and not negative");
    }
    sum += weights[i];
  }
  if (!(sum > S(0))) throw Error("mtk.bad-weight", "all weights are zero; at least one must be positive");
  return sum;
}

template <class V>
bool isFinite(const V& v) {
  return ((v - v).array() == 0).all();
}
/// Throws for the sample that differs from itself by NaN, or else for the first one whose difference from the mean is
/// not finite.
template <class M, class Samples>
[[noreturn]] void raiseNotFinite(const Samples& samples, const M& mean) {
  std::size_t found = std::size(samples);
  for (std::size_t i = 0; i < std::size(samples) && found == std::size(samples); ++i) {
    if (!isFinite(difference<M>(samples[i], samples[i]))) found = i;
  }
  for (std::size_t i = 0; i < std::size(samples) && found == std::size(samples); ++i) {
    if (!isFinite(difference<M>(samples[i], mean))) found = i;
  }
  throw Error("mtk.no-mean", "sample " + std::to_string(found) + " of " + std::to_string(std::size(samples)) +
                                 " is not finite, or infinitely far from the others; leave such samples out");
}
}  // namespace detail

/// Returns the weighted mean. If the samples spread over more than a half circle or half sphere, there may be several
/// means. Then the one found from the heaviest sample is returned. Throws mtk::Error for no samples, for bad weights,
/// and if the iteration does not settle: samples spread evenly around a circle have no mean.
template <Manifold M, class Samples = std::vector<M>>
M weightedMean(const Samples& samples, std::span<const scalar_t<M>> weights = {}) {
  using S = scalar_t<M>;
  const S sum = detail::checkedWeightSum<S>(std::size(samples), weights);
  std::size_t heaviest = 0;
  for (std::size_t i = 1; i < weights.size(); ++i) {
    if (weights[i] > weights[heaviest]) heaviest = i;
  }
  M mean = samples[heaviest];
  tangent_t<M> scale(dof(mean));
  for (int iteration = 0; iteration < 200; ++iteration) {
    tangent_t<M> step = tangent_t<M>::Zero(dof(mean));
    for (std::size_t i = 0; i < std::size(samples); ++i) {
      step += (weights.empty() ? S(1) : weights[i]) * difference<M>(samples[i], mean);
    }
    step /= sum;
    if (!detail::isFinite(step)) detail::raiseNotFinite<M>(samples, mean);
    boxplus<M>(mean, step);
    typicalSizes<M>(scale, mean);
    const S small = S(8) * std::numeric_limits<S>::epsilon();
    if ((step.array().abs() <= small * (scale.array() + S(1))).all()) return mean;
  }
  throw Error("mtk.no-mean",
              "the mean of " + std::to_string(std::size(samples)) +
                  " samples did not settle in 200 iterations; they spread too evenly over the manifold");
}

template <Manifold M>
M weightedMean(const std::vector<M>& samples, const std::vector<scalar_t<M>>& weights = {}) {
  return weightedMean<M, std::vector<M>>(samples, std::span<const scalar_t<M>>(weights));
}

/// Returns the second moment of the samples about `center`, divided by the sum of weights: sum w (x [-] c)(x [-] c)^T /
/// sum w, DOF x DOF. About the samples' own mean this is the covariance of the distribution that the samples form. For
/// the unbiased estimate from n equally weighted draws, multiply by n / (n - 1).
template <Manifold M>
auto weightedCovariance(const std::vector<M>& samples, const M& center,
                        const std::vector<scalar_t<M>>& weights = {}) {
  using S = scalar_t<M>;
  const S sum = detail::checkedWeightSum<S>(samples.size(), std::span<const S>(weights));
  using Matrix = Eigen::Matrix<S, DOF_v<M>, DOF_v<M>>;
  Matrix covariance = Matrix::Zero(dof(center), dof(center));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const tangent_t<M> d = difference(samples[i], center);
    covariance += (weights.empty() ? S(1) : weights[i]) * d * d.transpose();
  }
  return Matrix(covariance / sum);
}

}  // namespace mtk
