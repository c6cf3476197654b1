// A nonlinear model: Gauss-Newton, Levenberg-Marquardt, and a start that is too far away.
#include <cmath>
#include <vector>

#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

/// Voltage of a capacitor over time [s, V]: 5 V exp(-0.8 t), read to 0.1 V.
const Points kVoltages{{0, 5.0}, {0.5, 3.3}, {1, 2.3}, {1.5, 1.5}, {2, 1.0}, {2.5, 0.7}, {3, 0.4}, {4, 0.2}};

struct DecayFit {
  slom::Estimator est;
  slom::VarID<double> voltage, rate;
  explicit DecayFit(const Vec2& start)
      : voltage(est.insertRV(start.x(), "voltage")), rate(est.insertRV(start.y(), "rate")) {
    for (const Vec2& p : kVoltages) {
      est.insertMeasurement(
          [](const auto& voltage, const auto& rate, double t) {
            using std::exp;
            return voltage * exp(-rate * t);
          },
          voltage, rate, p.x(), slom::measured(p.y()), slom::StandardDeviation(0.1), slom::named("voltage"));
    }
  }
  Vec2 at() const { return {*voltage, *rate}; }
};

/// Returns the values after each step of the algorithm, beginning with the start.
Points steps(const Vec2& start, const slom::Algorithm& algorithm, int count) {
  DecayFit fit(start);
  fit.est.changeAlgorithm(algorithm.clone().release());
  Points path{fit.at()};
  for (int i = 0; i < count; ++i) {
    fit.est.optimizeStep();
    path.push_back(fit.at());
  }
  return path;
}

double rss(const Vec2& x) {
  double sum = 0;
  for (const Vec2& p : kVoltages) sum += std::pow((x.x() * std::exp(-x.y() * p.x()) - p.y()) / 0.1, 2);
  return sum;
}

/// Returns pieces of the line on which the RSS has this value, one for each grid cell that the line crosses.
Points contour(double level) {
  constexpr int columns = 80, rows = 60;
  const Vec2 origin(0, -0.5), size(8.0 / columns, 3.0 / rows);
  Points pieces;
  for (int cell = 0; cell < columns * rows; ++cell) {
    const Vec2 low = origin + size.cwiseProduct(Vec2(cell % columns, cell / columns));
    const Vec2 corners[] = {low, low + Vec2(size.x(), 0), low + size, low + Vec2(0, size.y())};
    Points crossings;
    for (int k = 0; k < 4; ++k) {
      const Vec2 &a = corners[k], &b = corners[(k + 1) % 4];
      const double fa = std::log(rss(a) / level), fb = std::log(rss(b) / level);
      if ((fa < 0) != (fb < 0)) crossings.emplace_back(a + (b - a) * (fa / (fa - fb)));
    }
    if (crossings.size() >= 2) pieces.insert(pieces.end(), {crossings[0], crossings[1]});
  }
  return pieces;
}

const Vec2 kNear(3, 0.3), kFar(1.5, 2.2);

void printNonlinear(std::ostream& os) {
  const auto table = [&](const char* title, const Points& path) {
    os << title << "\n  step  voltage     rate           RSS\n";
    for (std::size_t i = 0; i < path.size(); ++i)
      os << format("  %4d %8.4f %8.4f %13.5g\n", int(i), path[i].x(), path[i].y(), rss(path[i]));
  };
  table("Gauss-Newton, a near start", steps(kNear, slom::GaussNewton(), 4));
  table("Gauss-Newton, a far start", steps(kFar, slom::GaussNewton(), 1));
  table("Levenberg-Marquardt, the far start", steps(kFar, slom::LevenbergMarquardt(), 8));
  DecayFit fit(kFar);
  os << "\n" << fit.est.optimize();
}

std::string drawNonlinear() {
  Plot plot(740, 480);
  plot.diagram({70, 20, 650, 400, 0, 8, -0.5, 2.5});
  plot.ticks(1, 0.5, "voltage [V]", "rate [1/s]");
  for (const double level : {20.0, 100.0, 400.0, 1000.0, 2000.0, 3000.0, 5000.0, 20000.0})
    plot.segments(contour(level), "#b9c4cf");
  const auto path = [&](const Points& points, const char* colour) {
    for (std::size_t i = 0; i + 1 < points.size(); ++i) plot.arrow(points[i], points[i + 1], colour);
    for (const Vec2& p : points) plot.dot(p, colour, 3);
  };
  path(steps(kNear, slom::GaussNewton(), 4), kBlue);
  path(steps(kFar, slom::GaussNewton(), 1), kRed);
  path(steps(kFar, slom::LevenbergMarquardt(), 8), kGreen);
  plot.text(kNear, "near start, Gauss-Newton", kBlue, -20, 20);
  plot.text(kFar, "far start", kBlack, 10, 4);
  plot.text({2.5, -0.4}, "Gauss-Newton", kRed, 10, 0);
  plot.text({1.6, 1.75}, "Levenberg-Marquardt", kGreen, 8, 0);
  return plot.svg();
}

}  // namespace

const Page kNonlinear{"nonlinear", &printNonlinear, &drawNonlinear};
