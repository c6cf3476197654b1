// Outliers: a line fitted with and without losses.
#include <cmath>
#include <vector>

#include <mtk/testing/random.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

constexpr double kPointSigma = 0.2;

/// Returns 20 points of y = 1 + 0.5 x. Four of them are wrong, all upwards.
Points data() {
  mtk::testing::Random noise(9);
  Points points;
  for (int i = 0; i < 20; ++i) {
    const double x = 0.5 * i, wrong = i == 13 || i == 15 || i == 16 || i == 18 ? 4.0 : 0.0;
    points.emplace_back(x, 1 + 0.5 * x + wrong + kPointSigma * noise.normal());
  }
  return points;
}

struct LineFit {
  slom::Estimator est;
  slom::VarID<double> height = est.insertRV(0.0, "height"), slope = est.insertRV(0.0, "slope");
  std::vector<double> weights;
  explicit LineFit(const slom::Loss& loss) {
    const auto insert = [&](const Vec2& p) {
      return est.insertMeasurement(
          [](const auto& height, const auto& slope, double x) { return height + slope * x; }, height, slope,
          p.x(), slom::measured(p.y()), slom::StandardDeviation(kPointSigma), loss, slom::named("point"));
    };
    std::vector<decltype(insert(Vec2()))> ids;
    for (const Vec2& p : data()) ids.push_back(insert(p));
    slom::Options options;
    options.graduated_non_convexity = true;
    est.optimize(options);
    for (const auto& id : ids) weights.push_back(est.weight(id));
  }
};

struct NamedLoss {
  const char* name;
  slom::Loss loss;
  const char* colour;
};
const std::vector<NamedLoss> kLosses{{"least squares", slom::Loss(), kRed},
                                     {"Huber(1.345)", slom::Huber(1.345), kBlue},
                                     {"Tukey(4.685)", slom::Tukey(4.685), kGreen}};

void printOutliers(std::ostream& os) {
  os << "                height   slope  weights of the wrong points\n";
  for (const NamedLoss& l : kLosses) {
    const LineFit fit(l.loss);
    os << format("%-14s %7.3f %7.3f  %.2f %.2f %.2f %.2f\n", l.name, *fit.height, *fit.slope, fit.weights[13],
                 fit.weights[15], fit.weights[16], fit.weights[18]);
  }
  const LineFit plain{slom::Loss()};
  os << "\n" << slom::outliers(plain.est, {.worst = 5});
}

void drawLosses(Plot& plot) {
  plot.diagram({60, 30, 290, 310, -7, 7, 0, 24}, "loss");
  plot.ticks(2, 4, "residual [standard deviations]", "adds to the cost");
  for (const NamedLoss& l : kLosses) {
    plot.curve(
        graph([&](double w) { return l.loss.kind() == nullptr ? w * w : l.loss.evaluate(w * w).rho; }, -7, 7),
        l.colour);
  }
  plot.text({-4.2, 21}, "least squares", kRed, 4, 0);
  plot.text({6.8, 15.4}, "Huber", kBlue, 0, -14, "end");
  plot.text({6.8, 7.3}, "Tukey", kGreen, 0, -6, "end");
}

void drawLines(Plot& plot) {
  plot.diagram({410, 30, 315, 310, -0.3, 10, 0, 11}, "fit");
  plot.ticks(2, 2, "", "");
  for (const Vec2& p : data()) plot.dot(p, kBlack);
  for (const NamedLoss& l : kLosses) {
    const LineFit fit(l.loss);
    plot.curve({{-0.3, *fit.height - 0.3 * *fit.slope}, {10, *fit.height + 10 * *fit.slope}}, l.colour);
  }
}

std::string drawOutliers() {
  Plot plot(740, 400);
  drawLosses(plot);
  drawLines(plot);
  return plot.svg();
}

}  // namespace

const Page kOutliers{"outliers", &printOutliers, &drawOutliers};
