/// Fits a problem of NIST, and counts the digits that agree with the certified ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>

#include <Eigen/Core>

#include <slom/slom.hpp>

#include "support/nist/problem.hpp"

namespace slom::testing::nist {

struct Fit {
  Eigen::VectorXd parameters, deviations;  ///< deviations: empty where J has not full rank
  double rss = 0;
  int iterations = 0;
  bool converged = false;
};

/// Returns one setting for all problems, for more digits than a fit to measurements needs. fitBySlom solves by QR,
/// because the normal equations have only half of the digits.
inline Options toTheLastDigit() {
  Options options;
  options.max_iterations = 10000;
  options.gradient_tolerance = options.step_tolerance = 1e-15;
  options.decrease_tolerance = 0;
  return options;
}

/// The damping that goes with it: some starts are so far off that the first steps must be short.
inline constexpr double kCautiousDamping = 1e3;

/// One variable, a measurement for each datum.
inline VarID<Eigen::VectorXd> insert(const Problem& problem, const Eigen::VectorXd& start, Estimator& est) {
  const auto b = est.insertRV(start, "b");
  for (const Datum& datum : problem.data) {
    est.insertMeasurement(
        [](const auto& p, Model model, const Predictors& x, double y) { return predict(model, p, x) - y; }, b,
        problem.model, datum.x, datum.y);
  }
  return b;
}

/// Returns the fit at the end of `summary`; sigma is unknown.
inline Fit fitted(Estimator& est, const VarID<Eigen::VectorXd>& b, const Summary& summary) {
  est.setSigma(Sigma::estimated);
  Fit fit{*b, {}, est.getRSS(), summary.iterations, summary.converged};
  try {
    fit.deviations = est.standardDeviation(b);
  } catch (const Error&) {  // it ended where J has not full rank
  }
  return fit;
}

/// A fit by the library, to the last digit.
inline Fit fitBySlom(const Problem& problem, const Eigen::VectorXd& start, const Algorithm& algorithm,
                     const Options& options) {
  Estimator est;
  est.setThreads(1);
  const auto b = insert(problem, start, est);
  est.changeAlgorithm(algorithm.clone().release());
  est.changeSolver(std::make_unique<DenseQR>());
  est.setSigma(Sigma::estimated);
  return fitted(est, b, est.optimize(options));
}

/// A fit by the library with the default algorithm, solver and options.
inline Fit fitAsItComes(const Problem& problem, const Eigen::VectorXd& start) {
  Estimator est;
  const auto b = insert(problem, start, est);
  return fitted(est, b, est.optimize());
}

/// NIST gives 11 digits.
constexpr double kCertifiedDigits = 11;

/// Returns the digits of x that agree with the certified c, -log10(|x - c| / |c|), from 0 to 11.
///   source   McCullough, "Assessing the reliability of statistical software", The American Statistician 52, 1998:
///            "LRE"
inline double digits(double x, double c) {
  const double off = std::abs(x - c) / std::abs(c);
  if (!(off < 1)) return 0;
  return off > 0 ? std::min(kCertifiedDigits, -std::log10(off)) : kCertifiedDigits;
}

/// The digits of the component that has the fewest.
inline double digits(const Eigen::VectorXd& x, const Eigen::VectorXd& c) {
  if (x.size() != c.size()) return 0;
  double fewest = kCertifiedDigits;
  for (Eigen::Index i = 0; i < c.size(); ++i) fewest = std::min(fewest, digits(x[i], c[i]));
  return fewest;
}

}  // namespace slom::testing::nist
