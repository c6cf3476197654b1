#pragma once
// A straight line y = 1 + 2 x with gross outliers, and its robust fit by an independent way: iteratively reweighted
// least squares in long double, with the weights of the textbook.

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <slom/slom.hpp>

namespace slom::testing {

using Real = long double;

struct Point {
  double x, y;
  bool is_outlier;
};

constexpr double kLineSigma = 0.1;

/// 60 points with normal noise of kLineSigma and `outliers` others, high up and falling with x.
inline std::vector<Point> linePoints(int outliers = 40, unsigned seed = 5) {
  std::mt19937 rng(seed);
  std::normal_distribution<double> noise(0, kLineSigma), scatter(0, 1);
  std::vector<Point> points;
  for (int i = 0; i < 60; ++i) points.push_back({i / 20.0, 1 + 2 * (i / 20.0) + noise(rng), false});
  for (int i = 0; i < outliers; ++i) {
    const double x = 3.0 * i / outliers;
    points.push_back({x, 14 - 4 * x + scatter(rng), true});
  }
  return points;
}

struct LineResidual {
  double operator()(const Eigen::Vector2d& line, double x, double y) const {
    return line[0] + line[1] * x - y;
  }
};

/// The problem: measurements with one loss (or none).
struct LineFit {
  slom::Estimator est;
  slom::VarID<Eigen::Vector2d> line;

  template <class... LossType>
  explicit LineFit(const Eigen::Vector2d& start, const std::vector<Point>& points, const LossType&... loss)
      : est(), line(est.insertRV(start, "line")) {
    for (const Point& p : points) {
      est.insertMeasurement(LineResidual{}, line, p.x, p.y, slom::StandardDeviation(kLineSigma), loss...);
    }
  }
};

/// A weight as a function of t = s / c^2.
using Weight = Real (*)(Real t);

/// The fixed point of iteratively reweighted least squares from `start`.
inline Eigen::Vector2d reweightedLine(const Eigen::Vector2d& start, const std::vector<Point>& points,
                                      double scale, Weight weight) {
  Real a = start[0], b = start[1];
  const Real sigma = kLineSigma, c = scale;
  for (int round = 0; round < 20000; ++round) {
    Real w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (const Point& p : points) {
      const Real x = p.x, y = p.y, r = (a + b * x - y) / sigma, k = weight(r * r / (c * c));
      w += k, wx += k * x, wy += k * y, wxx += k * x * x, wxy += k * x * y;
    }
    const Real det = w * wxx - wx * wx, a_new = (wxx * wy - wx * wxy) / det,
               b_new = (w * wxy - wx * wy) / det;
    const bool at_rest = std::fabs(a_new - a) + std::fabs(b_new - b) < 1e-18L;
    a = a_new, b = b_new;
    if (at_rest) break;
  }
  return {static_cast<double>(a), static_cast<double>(b)};
}

}  // namespace slom::testing
