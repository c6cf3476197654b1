// Motion in continuous time: a carriage on a rail as a spline, by integrated readings, and as a Gaussian process.
#include <cmath>
#include <vector>

#include <mtk/testing/random.hpp>
#include <slom/measurements/preintegration.hpp>
#include <slom/slom.hpp>
#include <slom/trajectory.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

using slom::trajectory::Knots;
using slom::trajectory::WhiteNoise;
using Number = mtk::vect<1>;

constexpr double kPoseSigma = 0.1, kEnd = 10;  // [m, s]

double truth(double t) { return std::sin(1.1 * t) + 0.4 * std::sin(2.3 * t); }
double acceleration(double t) { return -1.21 * std::sin(1.1 * t) - 2.116 * std::sin(2.3 * t); }

/// Returns positions each 0.3 s, and none from 4 s to 6 s.
Points positions() {
  mtk::testing::Random noise(4);
  Points points;
  for (int i = 0; i <= 33; ++i) {
    const double t = 0.3 * i;
    if (t < 4 || t > 6) points.emplace_back(t, truth(t) + kPoseSigma * noise.normal());
  }
  return points;
}

/// The position at a time, of a spline or a process.
struct Position {
  auto operator()(const auto& motion, double t) const { return motion.at(t); }
};
template <class Motion>
slom::Summary fitted(slom::Estimator& est, Motion& motion) {
  motion.extend(est, 0, kEnd);
  motion.tieEnds(est);
  for (const Vec2& p : positions()) {
    slom::trajectory::insertMeasurement(est, Position(), motion.around(p.x()), p.x(),
                                        slom::measured(Number(p.y())), slom::StandardDeviation(kPoseSigma));
  }
  return est.optimize();
}

/// Cubic splines with other knots.
struct SplineFit {
  slom::Estimator est;
  slom::trajectory::VectorSpline<1, 4> motion;
  slom::Summary summary;
  explicit SplineFit(double spacing)
      : motion(Knots(0, spacing), "motion"), summary((start(), fitted(est, motion))) {}
  double at(double t) const { return motion.segmentAt(t).at(t)[0]; }
  /// Returns the root mean square of the residuals, or of the errors where there are data.
  double mean(bool of_residuals) const {
    double sum = 0;
    for (const Vec2& p : positions()) sum += std::pow(at(p.x()) - (of_residuals ? p.y() : truth(p.x())), 2);
    return std::sqrt(sum / double(positions().size()));
  }

 private:
  /// Starts at the positions nearest in time, so that the ties of the ends have the size of the motion.
  void start() {
    motion.extend(est, 0, kEnd, [](double t) {
      double value = 0, distance = 1e9;
      for (const Vec2& p : positions()) {
        if (std::abs(p.x() - t) < distance) distance = std::abs(p.x() - t), value = p.y();
      }
      return Number(value);
    });
  }
};

/// A process whose states are so close together that each datum is at one of them.
struct ProcessFit {
  slom::Estimator est;
  slom::trajectory::VectorProcess<1, WhiteNoise::on_acceleration> motion;
  slom::Summary summary;
  explicit ProcessFit(double density)
      : motion(Knots(0, 0.1), Number(density), "motion"), summary(fitted(est, motion)) {}
  double at(int i) const { return motion.controls()[std::size_t(i)]->value[0]; }
  double deviation(int i) const { return est.standardDeviation(motion.controls()[std::size_t(i)])[0]; }
};

constexpr double kDensity = 6;  // [m^2/s^3]

/// Readings of an accelerometer at 50 Hz along the rail, with a poor sensor's noise of 0.05 m/s^2/sqrt(Hz).
struct Readings {
  static constexpr double kNoise = 0.05;
  std::vector<slom::ImuSample> all;
  explicit Readings(unsigned seed) {
    mtk::testing::Random noise(seed);
    for (int i = 0; i <= 50 * kEnd; ++i) {
      const double t = i / 50.0, force = acceleration(t) + kNoise * std::sqrt(50.0) * noise.normal();
      all.push_back({t, mtk::vect<3>(), mtk::vect<3>(force, 0, 0)});
    }
  }
  /// Returns position and standard deviation at a time, from the true state at `from`.
  Vec2 integrated(double from, double t) const {
    const slom::PreintegratedImu moved(slom::ImuSamples(all), from, t, {1e-9, kNoise, 0, 0});
    const double speed = 1.1 * std::cos(1.1 * from) + 0.92 * std::cos(2.3 * from);
    return {
        truth(from) + speed * (t - from) + moved.motion<double>(mtk::vect<3>(), mtk::vect<3>()).position[0],
        std::sqrt(moved.covariance()(6, 6))};
  }
};

void printMotion(std::ostream& os) {
  os << "knots each   unknowns   residuals   errors where there are data\n";
  for (const double spacing : {0.4, 1.0, 2.5}) {
    const SplineFit fit(spacing);
    os << format("  %.1f s       %5d      %.3f m     %.3f m\n", spacing, fit.est.getN(), fit.mean(true),
                 fit.mean(false));
  }
  const Readings readings(1);
  os << "\nafter          0.5 s   1 s     2 s     4 s\n";
  os << format("deviation [m]  %.3f   %.3f   %.3f   %.3f\n", readings.integrated(0, 0.5).y(),
               readings.integrated(0, 1).y(), readings.integrated(0, 2).y(), readings.integrated(0, 4).y());
  os << "\ndensity [m^2/s^3]   deviation at 2 s   in the gap, at 5 s   chi-square / dof\n";
  for (const double density : {0.06, kDensity, 600.0}) {
    const ProcessFit fit(density);
    os << format("%8.2f                 %.3f m            %.3f m            %.2f\n", density,
                 fit.deviation(20), fit.deviation(50), fit.summary.chi2PerDof());
  }
}

Plot& begin(Plot& plot, double y_px, const char* title, const char* below = "") {
  plot.diagram({60, y_px, 670, 190, 0, kEnd, -2.2, 2.2}, title);
  plot.ticks(1, 1, below, "position [m]");
  plot.curve(graph(truth, 0, kEnd), kGrey, 1.5, "4 3");
  return plot;
}
/// Draws what lies within `factor` standard deviations.
void band(Plot& plot, const Points& means, const std::vector<double>& deviations, const char* colour) {
  Points outline;
  for (std::size_t i = 0; i < means.size(); ++i)
    outline.emplace_back(means[i].x(), means[i].y() + 1.96 * deviations[i]);
  for (std::size_t i = means.size(); i-- > 0;)
    outline.emplace_back(means[i].x(), means[i].y() - 1.96 * deviations[i]);
  plot.area(outline, colour, 0.18);
}

std::string drawMotion() {
  Plot plot(740, 740);
  begin(plot, 30, "splines");
  const SplineFit loose(0.4), good(1), stiff(2.5);
  plot.curve(graph([&](double t) { return loose.at(t); }, 0, kEnd), kRed, 1.5);
  plot.curve(graph([&](double t) { return stiff.at(t); }, 0, kEnd), kGreen, 1.5);
  plot.curve(graph([&](double t) { return good.at(t); }, 0, kEnd), kBlue);
  for (const Vec2& p : positions()) plot.dot(p, kBlack, 3);
  plot.text({7, 1.8}, "knots each 0.4 s", kRed, 0, 0);
  plot.text({7, 1.35}, "1 s", kBlue, 0, 0);
  plot.text({7, 0.9}, "2.5 s", kGreen, 0, 0);

  begin(plot, 265, "integrated readings");
  const Readings readings(1);
  for (const double from : {0.0, 2.5, 5.0, 7.5}) {
    Points path;
    std::vector<double> deviations;
    for (double t = from + 0.05; t <= from + 2.5 + 1e-9; t += 0.05) {
      const Vec2 p = readings.integrated(from, t);
      path.emplace_back(t, p.x());
      deviations.push_back(p.y());
    }
    band(plot, path, deviations, kBlue);
    plot.curve(path, kBlue);
    plot.dot({from, truth(from)}, kBlack);
  }
  plot.text({5, truth(5)}, "state", kBlack, 8, 12);

  begin(plot, 500, "Gaussian process", "time [s]");
  const ProcessFit fit(kDensity);
  Points path;
  std::vector<double> deviations;
  for (int i = 0; i <= 100; ++i) {
    path.emplace_back(0.1 * i, fit.at(i));
    deviations.push_back(fit.deviation(i));
  }
  band(plot, path, deviations, kBlue);
  plot.curve(path, kBlue);
  for (const Vec2& p : positions()) plot.dot(p, kBlack, 3);
  return plot.svg();
}

}  // namespace

const Page kMotion{"motion", &printMotion, &drawMotion};
