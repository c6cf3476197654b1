// From a line to the normal equations.
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include <mtk/testing/random.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

constexpr double kSigma = 0.3;  // [mm]

/// Returns lengths of a spring under load: 20 mm + 0.5 mm/N.
Points springData() {
  mtk::testing::Random noise(7);
  Points points;
  for (int i = 0; i < 12; ++i) {
    const double load = 1.0 + i;
    points.emplace_back(load, std::round(100 * (20 + 0.5 * load + kSigma * noise.normal())) / 100);
  }
  return points;
}

struct SpringFit {
  Points points = springData();
  slom::Estimator est;
  slom::VarID<double> rest = est.insertRV(0.0, "rest"), rate = est.insertRV(0.0, "rate");
  slom::Summary summary;
  SpringFit() {
    for (const Vec2& p : points) {
      est.insertMeasurement(
          [](const auto& rest, const auto& rate, double load) { return rest + rate * load; }, rest, rate,
          p.x(), slom::measured(p.y()), slom::StandardDeviation(kSigma), slom::named("length"));
    }
    summary = est.optimize();
  }
};

void printLine(std::ostream& os) {
  const SpringFit fit;
  Eigen::MatrixXd J(12, 2);
  Eigen::VectorXd z(12);
  for (int i = 0; i < 12; ++i) {
    const Vec2& p = fit.points[std::size_t(i)];
    J.row(i) << 1 / kSigma, p.x() / kSigma;
    z[i] = p.y() / kSigma;
  }
  const Eigen::Matrix2d H = J.transpose() * J;
  const Eigen::Vector2d b = J.transpose() * z, x = H.ldlt().solve(b);
  const Eigen::Matrix2d C = H.inverse();
  os << format("J^T J = %8.2f %9.2f    J^T z = %9.2f\n", H(0, 0), H(0, 1), b[0]);
  os << format("        %8.2f %9.2f            %9.2f\n", H(1, 0), H(1, 1), b[1]);
  os << format("rest = %.7f +- %.4f\n", x[0], std::sqrt(C(0, 0)));
  os << format("rate = %.7f +- %.4f\n\n", x[1], std::sqrt(C(1, 1)));
  os << fit.summary << "\n";
  const auto length = [](const auto& rest, const auto& rate) { return rest + rate * 20.0; };
  const auto at_20 = fit.est.propagate(length, fit.rest, fit.rate);
  os << format("length at 20 N: %.3f +- %.3f mm\n", at_20.value, at_20.standardDeviation()[0]);
}

std::string drawLine() {
  const SpringFit fit;
  const Eigen::Matrix2d C = fit.est.jointCovariance(fit.rest, fit.rate);
  const auto line = [&](double load) { return *fit.rest + *fit.rate * load; };
  const auto deviation = [&](double load) { return std::sqrt(Vec2(1, load).dot(C * Vec2(1, load))); };
  Plot plot(740, 460);
  plot.diagram({70, 20, 650, 380, 0, 20, 19, 32});
  plot.ticks(2, 2, "load [N]", "length [mm]");
  Points band = graph([&](double x) { return line(x) + 1.96 * deviation(x); }, 0, 20, 60);
  const Points lower = graph([&](double x) { return line(x) - 1.96 * deviation(x); }, 0, 20, 60);
  band.insert(band.end(), lower.rbegin(), lower.rend());
  plot.area(band, kBlue, 0.15);
  plot.curve(graph(line, 0, 20, 2), kBlue);
  for (const Vec2& p : fit.points) {
    plot.curve({p, Vec2(p.x(), line(p.x()))}, kRed);
    plot.dot(p, kBlack);
  }
  plot.text({13, 25}, "fitted line, and where the true one", kBlue, 0, 0);
  plot.text({13, 24.3}, "lies at each load with 95 %", kBlue, 0, 0);
  plot.text({fit.points[9].x(), fit.points[9].y()}, "residual", kRed, 6, 16);
  return plot.svg();
}

}  // namespace

const Page kLine{"line", &printLine, &drawLine};
