/// Fits from published and random starts, and whether a claim to have converged there is true.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/QR>

#include "support/classics/models.hpp"

namespace slom::testing::classics {

enum class Curve { exponential, logistic, gaussian, sine };

struct Problem {
  std::string name;
  int classic = 0;  ///< its number; 0: a curve
  Curve curve = Curve::exponential;
  std::vector<double> start, t, y;
  int residuals = 0;
  std::vector<double> minima;  ///< minima of the RSS, empty where they are not known
};

template <class T>
void evaluate(const Problem& problem, const T* x, T* r) {
  using std::exp, std::sin;
  if (problem.classic > 0)
    return classics::residuals(problem.classic, x, static_cast<int>(problem.start.size()), r);
  for (std::size_t i = 0; i < problem.t.size(); ++i) {
    const double t = problem.t[i];
    T value = x[0];
    switch (problem.curve) {
      case Curve::exponential:
        value = x[0] * exp(-x[1] * t) + x[2];
        break;
      case Curve::logistic:
        value = x[0] / (1.0 + exp(-x[1] * (t - x[2])));
        break;
      case Curve::gaussian:
        value = x[0] * exp(-0.5 * ((t - x[1]) / x[2]) * ((t - x[1]) / x[2]));
        break;
      case Curve::sine:
        value = x[0] * sin(x[1] * t + x[2]);
        break;
    }
    r[i] = value - problem.y[i];
  }
}

namespace detail {

inline Problem fromClassic(const Classic& classic) {
  Problem problem;
  problem.name = classic.name;
  problem.classic = classic.number;
  problem.start = classic.start;
  problem.residuals = classic.residuals;
  problem.minima = classic.minima;
  return problem;
}

using Number = long double;
using Vector = Eigen::Matrix<Number, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;

inline Vector residualsAt(const Problem& problem, const Vector& x) {
  Vector r(problem.residuals);
  evaluate<Number>(problem, x.data(), r.data());
  return r;
}

}  // namespace detail

/// The published starts, one, ten and a hundred times as far.
inline std::vector<Problem> publishedStarts() {
  std::vector<Problem> problems;
  for (const Classic& classic : all()) {
    for (const double factor : {1.0, 10.0, 100.0}) {
      Problem problem = detail::fromClassic(classic);
      const bool is_zero =
          Eigen::Map<Eigen::VectorXd>(problem.start.data(), static_cast<Eigen::Index>(problem.start.size()))
              .isZero();
      for (double& x : problem.start) x = is_zero && factor > 1 ? factor : factor * x;
      problem.name += " x " + std::to_string(static_cast<int>(factor));
      problems.push_back(problem);
    }
  }
  return problems;
}

/// A classic from a random start, by number.
inline Problem randomClassic(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Problem problem = detail::fromClassic(all()[seed % all().size()]);
  const double scale = std::pow(10.0, std::uniform_real_distribution<>(-1, 1.5)(random));
  std::normal_distribution<> normal;
  for (double& x : problem.start) x += scale * std::max(1.0, std::abs(x)) * normal(random);
  return problem;
}

/// A curve with noise, from a random start.
inline Problem randomCurve(std::uint64_t seed) {
  std::mt19937_64 random(seed + 1'000'000'007);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  std::normal_distribution<> normal;
  Problem problem;
  problem.curve = static_cast<Curve>(seed % 4);
  static const char* const names[] = {"exponential", "logistic", "gaussian", "sine"};
  problem.name = names[seed % 4];
  problem.residuals = 30;
  std::vector<double> truth;
  switch (problem.curve) {
    case Curve::exponential:
      truth = {uniform(1, 10), uniform(0.1, 2), uniform(-2, 2)};
      break;
    case Curve::logistic:
      truth = {uniform(1, 10), uniform(0.5, 3), uniform(2, 8)};
      break;
    case Curve::gaussian:
      truth = {uniform(1, 10), uniform(2, 8), uniform(0.5, 2)};
      break;
    case Curve::sine:
      truth = {uniform(1, 10), uniform(0.5, 3), uniform(-3, 3)};
      break;
  }
  for (int i = 0; i < problem.residuals; ++i) problem.t.push_back(10.0 * i / (problem.residuals - 1));
  problem.y.assign(problem.t.size(), 0.0);
  std::vector<double> r(problem.t.size());
  evaluate<double>(problem, truth.data(), r.data());
  const double noise = std::pow(10.0, uniform(-4, 0));
  for (std::size_t i = 0; i < r.size(); ++i) problem.y[i] = r[i] + noise * normal(random);
  const double scale = std::pow(10.0, uniform(-1, 1.5));
  for (const double x : truth)
    problem.start.push_back(x + scale * std::max(1.0, std::abs(x)) * normal(random));
  return problem;
}

/// Whether x is not a stationary point, in long double: the cosine of residual and some column is above 1e-6,
/// and the linear model promises a decrease of the RSS by more than a millionth, by a step that changes some
/// digits.
inline bool isFalse(const Problem& problem, const std::vector<double>& at, std::string* why = nullptr) {
  using detail::Matrix, detail::Number, detail::Vector, detail::residualsAt;
  const auto n = static_cast<Eigen::Index>(at.size());
  Vector x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = at[static_cast<std::size_t>(i)];
  const Vector r = residualsAt(problem, x);
  const Number rss = r.squaredNorm();
  if (!(rss > 1e-24L)) return false;
  Matrix J(problem.residuals, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    // The fourth-order difference, from numbers of 19 digits.
    const Number h = 1e-6L * std::max<Number>(std::abs(x[i]), 1e-8L);
    const auto shifted = [&](Number s) {
      Vector y = x;
      y[i] += s * h;
      return residualsAt(problem, y);
    };
    J.col(i) = (8 * (shifted(1) - shifted(-1)) - (shifted(2) - shifted(-2))) / (12 * h);
  }
  if (!J.allFinite()) return false;
  Number cosine = 0;
  Vector length = Vector::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Number norm_of_column = J.col(i).norm();
    // Columns that rounding errors of doubles hide are not part of it.
    if (!(norm_of_column * std::abs(x[i]) > 1e-15L * r.norm())) {
      J.col(i).setZero();
      continue;
    }
    length[i] = norm_of_column;
    cosine = std::max(cosine, std::abs(J.col(i).dot(r)) / (norm_of_column * r.norm()));
    J.col(i) /= norm_of_column;
  }
  Eigen::ColPivHouseholderQR<Matrix> qr(J);
  qr.setThreshold(1e-11L);
  const Vector step = qr.solve(r);
  const Number promise = (J * step).squaredNorm() / rss;
  // Digits of x that a test of steps may leave out.
  bool is_negligible = true;
  for (Eigen::Index i = 0; i < n; ++i) {
    is_negligible =
        is_negligible && std::abs(step[i]) <= 1e-9L * std::max(std::abs(x[i]) * length[i], Number(1));
  }
  if (why != nullptr) {
    char text[96];
    std::snprintf(text, sizeof text, "cosine %.2Lg, promise %.2Lg of the RSS %.6Lg", cosine, promise, rss);
    *why = text;
  }
  return cosine > 1e-6L && promise > 1e-6L && !is_negligible;
}

/// Whether the RSS is one of the known minima.
inline bool isOptimum(const Problem& problem, double rss) {
  for (const double minimum : problem.minima) {
    if (std::abs(rss - minimum) <= 1e-5 * minimum + 1e-10) return true;
  }
  return false;
}

}  // namespace slom::testing::classics
