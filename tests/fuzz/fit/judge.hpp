// Whether a fit that says that it has converged has, by residuals and derivatives of its own and a
// column-pivoted QR decomposition in long double.
#pragma once

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/QR>

#include <slom/model/loss.hpp>

#include "fuzz/fit/residuals.hpp"

namespace slom::fuzz::fit {

inline Loss lossOf(const Measurement& m) {
  switch (m.loss) {
    case 1:
      return Huber(m.scale);
    case 2:
      return PseudoHuber(m.scale);
    case 3:
      return Cauchy(m.scale);
    case 4:
      return Tukey(m.scale);
    case 5:
      return GemanMcClure(m.scale);
    case 6:
      return Barron(m.shape, m.scale);
    default:
      return Loss();
  }
}

struct Judgement {
  bool is_smooth = true;     ///< the residuals have derivatives here, as numbers
  bool is_false = false;     ///< the linear model promises something
  long double rss = 0;       ///< robust
  long double rounding = 0;  ///< rounding error of whitened residuals, from that of values and data
  std::string text;
};

/// `values` of all variables, at which a fit has stopped.
inline Judgement judge(const Problem& problem, const std::vector<Value>& values) {
  using Number = long double;
  using Matrix = Eigen::Matrix<Number, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<Number, Eigen::Dynamic, 1>;
  constexpr Number epsilon = std::numeric_limits<double>::epsilon();
  std::vector<int> offset;
  std::vector<Number> typical_size;  // 1 for angles
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Type type = problem.variables[i].type;
    offset.push_back(int(typical_size.size()));
    for (int c = 0; c < dofOf(type); ++c) {
      const Number x = c < positionOf(type) ? std::abs(Number(values[i][std::size_t(c)])) : 1;
      typical_size.push_back(std::isfinite(x) ? x : 0);  // no measurement depends on what is not finite
    }
  }
  const Eigen::Index n = Eigen::Index(typical_size.size());
  Judgement result;
  bool has_differences = false;
  Number data = 0;
  std::vector<Vector> rows;
  std::vector<Number> r;
  for (const Measurement& m : problem.measurements) {
    const Type ta = problem.variables[std::size_t(m.a)].type, tb = problem.variables[std::size_t(m.b)].type;
    const Residual residual = residualOf(m, ta, values[std::size_t(m.a)], tb, values[std::size_t(m.b)]);
    result.is_smooth = result.is_smooth && residual.is_smooth;
    has_differences = has_differences || m.kind == Kind::numeric;
    for (const double z : m.z) data += std::abs(z) / m.sigma;
    if (isScalar(m.kind) && m.formula == 5) data += std::abs(m.c[1]) / m.sigma;
    Number s = 0;
    for (const Jet& x : residual.r) s += (x.v / m.sigma) * (x.v / m.sigma);
    if (!(s < 1e300L)) {
      result.is_smooth = false;
      return result;
    }
    const LossValue loss = lossOf(m).evaluate(double(s));
    result.rss += m.loss == 0 ? s : Number(loss.rho);
    const Number factor = (m.loss == 0 ? 1 : std::sqrt(Number(loss.first))) / m.sigma;
    for (const Jet& x : residual.r) {
      Vector row = Vector::Zero(n);
      for (int c = 0; c < dofOf(ta); ++c) row[offset[std::size_t(m.a)] + c] += factor * x.d[std::size_t(c)];
      for (int c = 0; c < dofOf(tb); ++c)
        row[offset[std::size_t(m.b)] + c] += factor * x.d[std::size_t(dofOf(ta) + c)];
      rows.push_back(row);
      r.push_back(factor * x.v);
    }
  }
  if (rows.empty()) return result;
  Matrix J(Eigen::Index(rows.size()), n);
  for (std::size_t i = 0; i < rows.size(); ++i) J.row(Eigen::Index(i)) = rows[i].transpose();
  const Vector all = Eigen::Map<const Vector>(r.data(), Eigen::Index(r.size()));
  if (!J.allFinite() || !all.allFinite()) {
    result.is_smooth = false;
    return result;
  }
  Number effect = data;
  Vector length(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    length[i] = J.col(i).norm();
    effect += length[i] * typical_size[std::size_t(i)];
  }
  const Number size = all.norm();
  result.rounding = 64 * epsilon * (effect + size);
  // Fixed components, and columns that rounding errors of doubles or their range hide, are not part of it.
  int unknowns = 0;
  for (std::size_t v = 0; v < values.size(); ++v) {
    const Variable& variable = problem.variables[v];
    for (int c = 0; c < dofOf(variable.type); ++c) {
      const Eigen::Index i = offset[v] + c;
      const Number g = J.col(i).dot(all);
      bool is_fixed = variable.is_fixed || std::count(variable.fixed.begin(), variable.fixed.end(), c) > 0;
      for (const Bound& bound : variable.bounds) {
        if (bound.component != c) continue;
        const Number x = values[v][std::size_t(c)], margin = 1e-13L * std::abs(x);
        is_fixed = is_fixed || (x >= bound.upper - margin && g <= 0) || (x <= bound.lower + margin && g >= 0);
      }
      unknowns += is_fixed ? 0 : 1;
      const Number seen = length[i] * typical_size[std::size_t(i)];
      if (is_fixed || !(length[i] > 1e-140L) || (seen > 0 && seen < 1e-8L * (effect + size))) {
        J.col(i).setZero();
      } else {
        J.col(i) /= length[i];
      }
    }
  }
  // The library finds rank down to 1e-6 of a column by Cholesky's decomposition: what is closer to dependent
  // is not judged.
  constexpr Number dependent = 1e-5L;
  Eigen::ColPivHouseholderQR<Matrix> qr(J);
  qr.setThreshold(dependent);
  const Number square = all.squaredNorm();
  Vector turned = all;
  turned.applyOnTheLeft(qr.householderQ().adjoint());
  const Number promise = turned.head(qr.rank()).squaredNorm();
  const Number variance =
      problem.has_estimated_sigma ? result.rss / std::max<Number>(1, Number(r.size()) - unknowns) : 1;
  // deviation_tolerance, 1e-8 standard deviations, hundredfold; what rounding of residuals leaves open, and
  // of derivatives near dependence.
  const Number negligible = std::max(
      {1e-12L * variance, result.rounding * result.rounding, (has_differences ? 1e-5L : 1e-16L) * square});
  // Where no step helps, a tiny gradient will do that promises less than a hundredth of a standard deviation.
  const bool is_tiny = promise <= 1e-3L * variance && promise <= 1e-10L * square;
  // Far from zero the noise of differences may be larger than derivatives.
  const bool is_noise = has_differences && *std::max_element(typical_size.begin(), typical_size.end()) > 100;
  const bool is_perfect = square < 1e-23L;
  result.is_false = promise > negligible && !is_perfect && !is_tiny && !is_noise;
  char text[160];
  std::snprintf(text, sizeof text,
                "promise %.3Lg of the RSS %.6Lg, variance %.3Lg, rounding %.3Lg, rank %d of %d", promise,
                square, variance, result.rounding, int(qr.rank()), unknowns);
  result.text = text;
  return result;
}

}  // namespace slom::fuzz::fit
