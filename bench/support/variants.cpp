#include "support/variants.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace slom::bench {

namespace {

/// Returns the deviation of x. Entry k of x belongs to class k / run modulo `classes`.
double deviationOf(const std::vector<double>& x, const std::vector<double>& reference, int run, int classes) {
  const auto classOf = [&](std::size_t k) { return k / Derivatives::size(run) % Derivatives::size(classes); };
  std::vector<double> scale(Derivatives::size(classes), 0.0);
  for (std::size_t k = 0; k < x.size(); ++k) {
    scale[classOf(k)] = std::max(scale[classOf(k)], std::abs(reference[k]));
  }
  double worst = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double difference = std::abs(x[k] - reference[k]);
    if (!std::isfinite(difference)) return std::numeric_limits<double>::quiet_NaN();
    if (difference > 0) worst = std::max(worst, difference / scale[classOf(k)]);
  }
  return worst;
}

double nanosecondsOf(const std::function<void()>& pass, int passes) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (int i = 0; i < passes; ++i) pass();
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count() / passes;
}

/// Returns the value below which the fraction p of the values lies.
double quantile(std::vector<double> values, double p) {
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - std::floor(at)) * (values[above] - values[below]);
}

}  // namespace

double deviation(const Derivatives& x, const Derivatives& reference) {
  if (x.rows != reference.rows || x.cols != reference.cols || x.count != reference.count) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double of_residuals = deviationOf(x.r, reference.r, 1, x.rows);
  const double of_jacobians = deviationOf(x.J, reference.J, x.rows, x.cols);
  return std::isnan(of_residuals) || std::isnan(of_jacobians) ? std::numeric_limits<double>::quiet_NaN()
                                                              : std::max(of_residuals, of_jacobians);
}

std::vector<Timing> timeInTurn(const std::vector<Variant>& variants, int count, int repetitions) {
  constexpr double shortest_ns = 5e5;
  std::vector<std::vector<double>> times(variants.size());
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    for (std::size_t v = 0; v < variants.size(); ++v) {
      const double warm_up_ns = nanosecondsOf(variants[v].pass, 1);
      const int passes = std::max(1, static_cast<int>(std::ceil(shortest_ns / warm_up_ns)));
      times[v].push_back(nanosecondsOf(variants[v].pass, passes) / count);
    }
  }
  std::vector<Timing> result;
  for (const auto& of_variant : times) {
    result.push_back({quantile(of_variant, 0.25), quantile(of_variant, 0.5), quantile(of_variant, 0.75)});
  }
  return result;
}

}  // namespace slom::bench
