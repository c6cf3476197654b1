// Information in a measurement: one length, measured 3 times with different accuracy.
#include <cmath>
#include <vector>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

struct Reading {
  const char* instrument;
  double value, sigma;  // [m]
  const char* colour;
};
const std::vector<Reading> kReadings{
    {"tape", 2.013, 0.010, kBlue}, {"laser", 1.998, 0.004, kRed}, {"folding rule", 2.030, 0.020, kGrey}};

struct LengthFit {
  slom::Estimator est;
  slom::VarID<double> length = est.insertRV(1.0, "length");
  slom::Summary summary;
  LengthFit() {
    for (const Reading& r : kReadings) {
      est.insertMeasurement([](const auto& l) { return 1.0 * l; }, length, slom::measured(r.value),
                            slom::StandardDeviation(r.sigma), slom::named("reading"));
    }
    summary = est.optimize();
  }
};

void printMeasurement(std::ostream& os) {
  const LengthFit fit;
  os << fit.summary << "\n";
  double weights = 0, sum = 0;
  for (const Reading& r : kReadings) {
    weights += 1 / (r.sigma * r.sigma);
    sum += r.value / (r.sigma * r.sigma);
  }
  os << format("weighted mean %.7f, standard deviation %.5f\n\n", sum / weights, 1 / std::sqrt(weights));

  slom::Estimator est;
  Eigen::Matrix2d covariance;
  covariance << 4, 3, 3, 4;  // [cm^2]
  const auto position = est.insertRV(Eigen::Vector2d(0, 0), "position");
  for (const Eigen::Vector2d& error : {Eigen::Vector2d(3, 3), Eigen::Vector2d(3, -3)}) {
    const auto m =
        est.insertMeasurement(slom::Prior(), position, slom::measured(error), slom::Covariance(covariance));
    const Eigen::VectorXd w = est.whitenedResidual(m);
    os << format("error (%g, %g) cm: whitened (%.3f, %.3f), chi-square %.3f\n", error.x(), error.y(), w[0],
                 w[1], w.squaredNorm());
  }
}

std::string drawMeasurement() {
  const LengthFit fit;
  const double best = *fit.length, sigma = fit.est.standardDeviation(fit.length)[0];
  Plot plot(740, 420);
  plot.diagram({60, 20, 660, 340, 1.96, 2.07, 0, 115});
  plot.ticks(0.02, 0, "length [m]", "probability density");
  const auto density = [](double mean, double s) {
    return [=](double x) {
      return std::exp(-0.5 * (x - mean) * (x - mean) / (s * s)) / (s * std::sqrt(2 * 3.14159265358979));
    };
  };
  for (const Reading& r : kReadings) {
    plot.curve(graph(density(r.value, r.sigma), 1.96, 2.07), r.colour);
    const double side = r.value < best ? -0.6 : 0.6, at = r.value + side * r.sigma;
    plot.text({at, density(r.value, r.sigma)(at)}, r.instrument, r.colour, side < 0 ? -8 : 8, -6,
              side < 0 ? "end" : "start");
  }
  plot.area(graph(density(best, sigma), 1.96, 2.07), kGreen, 0.2);
  plot.curve(graph(density(best, sigma), 1.96, 2.07), kGreen);
  plot.text({best, density(best, sigma)(best)}, "all three", kGreen, 10);
  return plot.svg();
}

}  // namespace

const Page kMeasurement{"measurement", &printMeasurement, &drawMeasurement};
