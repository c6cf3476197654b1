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

#include <mtk/testing/random.hpp>

#include "support/classics/models.hpp"

namespace slom::testing::classics {

enum class Curve { exponential, logistic, gaussian, sine, sigmoid, decays };

struct Problem {
  std::string name;
  int classic = 0;  ///< its number; 0: a curve
  Curve curve = Curve::exponential;
  std::vector<double> start, t, y;
  int residuals = 0;
  std::vector<double> minima;  ///< minima of the RSS, empty where they are not known
  double saddle = 0;           ///< the RSS of a known saddle; 0: none
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
      case Curve::sigmoid:
        value = x[0] + x[1] / (1.0 + exp(-x[2] * (t - x[3])));
        break;
      case Curve::decays:
        value = x[0] * exp(-x[1] * t) + x[2] * exp(-x[3] * t);
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
    case Curve::sigmoid:
    case Curve::decays:
      break;  // wideSigmoid, twoDecays
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

/// Returns 1 + 2 / (1 + exp(-1.5 (t - 5))) with noise of 0.02 and a wide random start. In about half of the starts,
/// plateaus surround the fit.
inline Problem wideSigmoid(std::uint64_t seed) {
  std::mt19937_64 random(seed + 2'000'000'011);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(random);
  };
  Problem problem;
  problem.curve = Curve::sigmoid;
  problem.name = "sigmoid";
  problem.residuals = 40;
  problem.minima = {0.0121800178396339};
  mtk::testing::Random noise(11);
  for (int i = 0; i < problem.residuals; ++i) {
    problem.t.push_back(0.25 * i);
    problem.y.push_back(1 + 2 / (1 + std::exp(-1.5 * (0.25 * i - 5))) + 0.02 * noise.normal());
  }
  for (const double limit : {10.0, 10.0, 5.0}) problem.start.push_back(uniform(-limit, limit));
  problem.start.push_back(uniform(-10, 20));
  return problem;
}

/// 3 exp(-0.5 t) + 2 exp(-4 t), exact, from a random start. Equal rates are a saddle with two free directions.
inline Problem twoDecays(std::uint64_t seed) {
  std::mt19937_64 random(seed + 3'000'000'019);
  Problem problem;
  problem.curve = Curve::decays;
  problem.name = "decays";
  problem.residuals = 20;
  problem.minima = {0};
  problem.saddle = 1.2164679396202487;
  for (int i = 0; i < problem.residuals; ++i) {
    const double t = 0.2 * i;
    problem.t.push_back(t);
    problem.y.push_back(3 * std::exp(-0.5 * t) + 2 * std::exp(-4 * t));
  }
  for (const double limit : {10.0, 5.0, 10.0, 5.0})
    problem.start.push_back(std::uniform_real_distribution<>(-limit, limit)(random));
  return problem;
}

namespace detail {

/// The Jacobian by fourth-order differences, from numbers of 19 digits.
inline Matrix jacobianAt(const Problem& problem, const Vector& x) {
  Matrix J(problem.residuals, x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Number h = 1e-6L * std::max<Number>(std::abs(x[i]), 1e-8L);
    const auto shifted = [&](Number s) {
      Vector y = x;
      y[i] += s * h;
      return residualsAt(problem, y);
    };
    J.col(i) = (8 * (shifted(1) - shifted(-1)) - (shifted(2) - shifted(-2))) / (12 * h);
  }
  return J;
}

inline Vector vectorOf(const std::vector<double>& x) {
  return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size())).cast<Number>();
}

/// Scales the columns of J to length 1 and returns their lengths. Columns hidden by rounding errors of doubles become
/// 0.
inline Vector scaleColumns(Matrix& J, const Vector& x, const Vector& r) {
  Vector length = Vector::Zero(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const Number norm_of_column = J.col(i).norm();
    if (!(norm_of_column * std::abs(x[i]) > 1e-15L * r.norm())) {
      J.col(i).setZero();
      continue;
    }
    length[i] = norm_of_column;
    J.col(i) /= norm_of_column;
  }
  return length;
}

}  // namespace detail

/// Returns whether x is not a stationary point, in long double. Then the cosine of residual and some column is above
/// 1e-6, and the linear model predicts a decrease of the RSS by more than a millionth, by a step that changes some
/// digits.
inline bool isFalse(const Problem& problem, const std::vector<double>& at, std::string* why = nullptr) {
  using detail::Matrix, detail::Number, detail::Vector;
  const Vector x = detail::vectorOf(at), r = detail::residualsAt(problem, x);
  const Number rss = r.squaredNorm();
  if (!(rss > 1e-24L)) return false;
  Matrix J = detail::jacobianAt(problem, x);
  if (!J.allFinite()) return false;
  const Vector length = detail::scaleColumns(J, x, r);
  const Number cosine = (J.transpose() * r).cwiseAbs().maxCoeff() / r.norm();
  Eigen::ColPivHouseholderQR<Matrix> qr(J);
  qr.setThreshold(1e-11L);
  const Vector step = qr.solve(r);
  const Number promise = (J * step).squaredNorm() / rss;
  // Digits of x that a test of steps may leave out.
  bool is_negligible = true;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
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

/// Returns whether the measurements leave directions free at x, in long double: some combination of the columns of the
/// Jacobian, scaled to length 1, is shorter than 1e-6.
inline bool hasFreeDirections(const Problem& problem, const std::vector<double>& at) {
  using detail::Matrix, detail::Vector;
  const Vector x = detail::vectorOf(at);
  Matrix J = detail::jacobianAt(problem, x);
  if (!J.allFinite()) return false;
  detail::scaleColumns(J, x, detail::residualsAt(problem, x));
  Eigen::ColPivHouseholderQR<Matrix> qr(J);
  qr.setThreshold(1e-6L);
  return qr.rank() < x.size();
}

/// Returns whether the RSS is that of the known saddle.
inline bool isSaddle(const Problem& problem, double rss) {
  return problem.saddle > 0 && std::abs(rss - problem.saddle) <= 1e-4 * problem.saddle;
}

/// Whether the RSS is one of the known minima.
inline bool isOptimum(const Problem& problem, double rss) {
  for (const double minimum : problem.minima) {
    if (std::abs(rss - minimum) <= 1e-5 * minimum + 1e-10) return true;
  }
  return false;
}

}  // namespace slom::testing::classics
