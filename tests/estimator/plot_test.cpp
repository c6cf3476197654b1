// Pictures of fits: well-formed SVG with points at the positions of the data.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/plot.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "support/paths.hpp"
#include "support/temporary_folder.hpp"

namespace {

using slom::testing::messageOf;

/// Elements by their tag's beginning: `<circle class="point"`.
std::vector<std::string> elements(const std::string& svg, const std::string& beginning) {
  std::vector<std::string> result;
  for (auto at = svg.find(beginning); at != std::string::npos; at = svg.find(beginning, at + 1))
    result.push_back(svg.substr(at, svg.find('>', at) - at));
  return result;
}

double attribute(const std::string& element, const std::string& name) {
  const auto at = element.find(" " + name + "=\"");
  return at == std::string::npos ? NAN : std::stod(element.substr(at + name.size() + 3));
}

/// Every tag is closed in order, and no number is NaN.
void expectWellFormed(const std::string& svg) {
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z]+)[^>]*?(/?)>");
  for (std::sregex_iterator i(svg.begin(), svg.end(), tag), end; i != end; ++i) {
    if ((*i)[1].length() > 0) {
      ASSERT_FALSE(open.empty());
      EXPECT_EQ(open.back(), (*i)[2].str());
      open.pop_back();
    } else if ((*i)[3].length() == 0) {
      open.push_back((*i)[2].str());
    }
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf\""), std::string::npos);
}

struct Decay {
  slom::Estimator est;
  slom::VarID<double> size = est.insertRV(1.0, "size"), rate = est.insertRV(1.0, "rate");
  std::vector<double> t, y;
  static constexpr auto curve = [](const auto& a, const auto& k, double at) { return a * exp(-k * at); };

  Decay() {
    for (int i = 0; i < 20; ++i) {
      t.push_back(0.2 * i);
      y.push_back(3 * std::exp(-0.7 * t.back()) + 0.02 * std::sin(37.0 * i));
      est.insertMeasurement(curve, size, rate, t.back(), slom::measured(y.back()),
                            slom::StandardDeviation(0.02), slom::named("sample <&>"));
    }
    EXPECT_TRUE(est.optimize().converged);
  }
};

TEST(Plot, OfDataAndCurve) {
  Decay decay;
  const slom::Plot plot = slom::plot(decay.est, decay.t, decay.y, 0.02, Decay::curve, decay.size, decay.rate);
  expectWellFormed(plot.svg);
  // Two diagrams with all points, which are linear images of the data in the upper one.
  const std::vector<std::string> points = elements(plot.svg, "<circle class=\"point\"");
  ASSERT_EQ(points.size(), 40u);
  const double x0 = attribute(points[0], "cx"), x19 = attribute(points[19], "cx");
  const double y0 = attribute(points[0], "cy"), y19 = attribute(points[19], "cy");
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_NEAR(attribute(points[i], "cx"), x0 + (x19 - x0) * decay.t[i] / decay.t[19], 0.11);
    EXPECT_NEAR(attribute(points[i], "cy"),
                y0 + (y19 - y0) * (decay.y[i] - decay.y[0]) / (decay.y[19] - decay.y[0]), 0.11);
  }
  EXPECT_EQ(elements(plot.svg, "<path class=\"bar\"").size(), 40u);
  EXPECT_EQ(elements(plot.svg, "<path class=\"band\"").size(), 1u);
  slom::testing::TemporaryFolder folder;
  const std::string file = (folder / "decay.svg").string();
  plot.save(file);
  EXPECT_EQ(slom::testing::readFile(file), plot.svg);
  EXPECT_EQ(messageOf([&] { plot.save((folder / "none/decay.svg").string()); }),
            "[slom.cannot-write] the plot could not be written to " + folder.path().string() +
                "/none/decay.svg; check that its folder exists and is writable");
}

/// A simulator takes doubles, and its derivatives are differences.
TEST(Plot, OfAFunctionOfDoublesIsTheSame) {
  Decay decay;
  const auto simulator = [](double a, double k, double at) { return a * std::exp(-k * at); };
  const std::vector<std::string> exact = elements(
      slom::plot(decay.est, decay.t, decay.y, 0.02, Decay::curve, decay.size, decay.rate).svg, "<path");
  EXPECT_EQ(
      elements(slom::plot(decay.est, decay.t, decay.y, 0.02, simulator, decay.size, decay.rate).svg, "<path"),
      exact);
  EXPECT_EQ(elements(slom::plot(decay.est, decay.t, decay.y, 0.02,
                                slom::numeric(simulator, slom::differences(1e-4)), decay.size, decay.rate)
                         .svg,
                     "<path"),
            exact);
}

TEST(Plot, OfEstimatedNoiseHasTheBarsThatResidualsShow) {
  Decay decay;
  decay.est.setSigma(slom::Sigma::estimated);
  const double factor = std::sqrt(decay.est.getRSS() / 18);
  const std::vector<double> shown(20, 0.02 * factor);
  const slom::PlotText text{"title", "t", "y"};
  const slom::Plot estimated =
      slom::plot(decay.est, text, decay.t, decay.y, 0.02, Decay::curve, decay.size, decay.rate);
  const std::string svg = estimated.svg;
  EXPECT_NE(svg.find(">title</text>"), std::string::npos);
  const std::vector<std::string> bars = elements(svg, "<path class=\"bar\"");
  decay.est.setSigma(slom::Sigma::known);
  EXPECT_EQ(
      elements(slom::plot(decay.est, text, decay.t, decay.y, shown, Decay::curve, decay.size, decay.rate).svg,
               "<path class=\"bar\""),
      bars);
}

TEST(Plot, OfResidualsNamesSuspects) {
  Decay decay;
  decay.est.insertMeasurement(Decay::curve, decay.size, decay.rate, 1.0, slom::measured(9.0),
                              slom::StandardDeviation(0.02), slom::named("sample <&>"));
  ASSERT_TRUE(decay.est.optimize().converged);
  const std::string svg = slom::plotResiduals(decay.est).svg;
  expectWellFormed(svg);
  EXPECT_GE(elements(svg, "<circle class=\"marked\"").size(), 1u);
  EXPECT_NE(svg.find(">sample &lt;&amp;&gt; #21</text>"), std::string::npos);
  EXPECT_EQ(elements(svg, "<circle").size(), 21u);
  slom::Estimator none;
  EXPECT_EQ(messageOf([&] { slom::plotResiduals(none); }),
            "[slom.no-measurements] plotResiduals got an estimator without measurements; insert some first");
}

TEST(Plot, OfResidualsOfAFreeNetworkNeedsNoCovariances) {
  slom::Estimator est;
  const auto a = est.insertRV(1.0, "a"), b = est.insertRV(2.0, "b");
  est.insertMeasurement([](const auto& x, const auto& y) { return y - x; }, a, b, slom::measured(1.5));
  expectWellFormed(slom::plotResiduals(est).svg);
}

TEST(Plot, RefusesOtherData) {
  Decay decay;
  const auto plotted = [&](std::vector<double> x, std::vector<double> y, std::vector<double> sigma) {
    return messageOf([&] { slom::plot(decay.est, x, y, sigma, Decay::curve, decay.size, decay.rate); });
  };
  EXPECT_EQ(plotted({1, 2}, {1}, {}),
            "[slom.bad-plot] plot got 2 values of x and 1 of y; pass one y for each x");
  EXPECT_EQ(
      plotted({1, 2, 3}, {1, 2, 3}, {1, 2}),
      "[slom.bad-plot] plot got 2 standard deviations for 3 values; pass one for each, one for all, or none");
  EXPECT_EQ(plotted({1, NAN}, {1, 2}, {}),
            "[slom.bad-plot] point 1 of the plot is (nan, 2); pass finite numbers");
  EXPECT_EQ(plotted({1, 2}, {1, 2}, {-1}),
            "[slom.bad-plot] a standard deviation of the plot is -1; pass positive, finite numbers");
  expectWellFormed(
      slom::plot(decay.est, {2}, {1}, std::vector<double>{}, Decay::curve, decay.size, decay.rate).svg);
}

}  // namespace
