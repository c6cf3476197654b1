// Covariances, and their assumption of independent errors.
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include <mtk/testing/random.hpp>
#include <slom/analyze/clustered.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

constexpr double kReadingSigma = 0.3, kDaySigma = 0.3;  // of each reading, and of all readings of a day [mm]
constexpr int kDays = 12, kPerDay = 8;
const Vec2 kTruth(20, 0.5);

/// A spring of 20 mm and 0.5 mm/N, measured 8 times on each of 12 days, at random loads up to 12 N.
struct Simulation {
  slom::Estimator est;
  slom::VarID<double> rest = est.insertRV(0.0, "rest"), rate = est.insertRV(0.0, "rate");
  Simulation(mtk::testing::Random& noise, double day_sigma) {
    for (int day = 0; day < kDays; ++day) {
      const double shared = day_sigma * noise.normal();
      for (int i = 0; i < kPerDay; ++i) {
        const double load = noise.uniform(0, 12);
        const double length = kTruth.x() + kTruth.y() * load + shared + kReadingSigma * noise.normal();
        est.insertMeasurement(
            [](const auto& rest, const auto& rate, double load) { return rest + rate * load; }, rest, rate,
            load, slom::measured(length), slom::StandardDeviation(kReadingSigma), slom::named("length"),
            slom::group("day", day));
      }
    }
    est.optimize();
  }
  Vec2 at() const { return {*rest, *rate}; }
};

/// Number of `count` simulations whose interval of 95 % contains the true rest length.
struct Coverage {
  int stated = 0, clustered = 0;
  Coverage(double day_sigma, int count) {
    mtk::testing::Random noise(5);
    for (int i = 0; i < count; ++i) {
      const Simulation s(noise, day_sigma);
      const double error = std::abs(*s.rest - kTruth.x());
      const slom::Clustered by_day = slom::clustered(s.est, {.by = {"day"}});
      stated += error < 1.96 * s.est.standardDeviation(s.rest)[0];
      clustered += error < by_day.interval(s.rest, 0.95)[0];
    }
  }
};

void printUncertainty(std::ostream& os) {
  mtk::testing::Random noise(1);
  const Simulation one(noise, 0);
  const Eigen::Matrix2d C = one.est.jointCovariance(one.rest, one.rate);
  os << format("rest %.3f +- %.3f mm, rate %.4f +- %.4f mm/N, correlation %.2f\n", *one.rest,
               std::sqrt(C(0, 0)), *one.rate, std::sqrt(C(1, 1)), C(0, 1) / std::sqrt(C(0, 0) * C(1, 1)));
  int inside = 0;
  constexpr int count = 500;
  for (int i = 0; i < count; ++i) {
    const Simulation s(noise, 0);
    const Vec2 d = s.at() - kTruth;
    inside += d.dot(s.est.jointCovariance(s.rest, s.rate).inverse() * d) < 5.991;
  }
  os << format("truth within the ellipse of 95 %%: %.1f %% of %d simulations\n\n", 100.0 * inside / count,
               count);
  os << "intervals of 95 % that hold the true rest length, of 300 simulations\n";
  os << "  errors                          stated    clustered by day\n";
  const Coverage independent(0, 300), shared(kDaySigma, 300);
  os << format("  independent                     %4.1f %%    %4.1f %%\n", independent.stated / 3.0,
               independent.clustered / 3.0);
  os << format("  partly shared by a day          %4.1f %%    %4.1f %%\n", shared.stated / 3.0,
               shared.clustered / 3.0);
}

std::string drawUncertainty() {
  Plot plot(740, 400);
  const auto panel = [&](double x_px, const char* title, double day_sigma) {
    plot.diagram({x_px, 30, 280, 300, 19.5, 20.5, 0.43, 0.57}, title);
    plot.ticks(0.25, 0.05, "rest length [mm]", "rate [mm/N]");
    mtk::testing::Random noise(2);
    for (int i = 0; i < 400; ++i) plot.dot(Simulation(noise, day_sigma).at(), "#9db4c8", 2);
    const Simulation one(noise, day_sigma);
    plot.ellipse(kTruth, one.est.jointCovariance(one.rest, one.rate), 5.991, kGreen);
    plot.dot(kTruth, kBlack);
  };
  panel(70, "independent errors", 0);
  panel(430, "errors partly shared by a day", kDaySigma);
  return plot.svg();
}

}  // namespace

const Page kUncertainty{"uncertainty", &printUncertainty, &drawUncertainty};
