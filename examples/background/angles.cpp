// Means of angles and directions, which show why such values need [+] and [-].
#include <cmath>
#include <vector>

#include <Eigen/Dense>

#include <mtk/testing/random.hpp>
#include <slom/measurements.hpp>
#include <slom/slom.hpp>

#include "pages.hpp"
#include "plot.hpp"
#include "text.hpp"

namespace {

constexpr double kDegree = 3.14159265358979 / 180;
using Vec3 = Eigen::Vector3d;

/// Readings of a compass [degree].
const std::vector<double> kHeadings{350, 5, 12, 358, 340};

template <class M>
M meanOf(const std::vector<M>& samples, const M& start) {
  slom::Estimator est;
  auto mean = est.insertRV(start, "mean");
  for (const M& sample : samples) est.insertMeasurement(slom::Prior(), mean, slom::measured(sample));
  est.optimize();
  return *mean;
}

double headingMean() {
  std::vector<mtk::SO2<>> headings;
  for (const double heading : kHeadings) headings.emplace_back(heading * kDegree);
  return meanOf(headings, headings[0]).angle() / kDegree;
}

double arithmeticMean() {
  double sum = 0;
  for (const double heading : kHeadings) sum += heading;
  return sum / double(kHeadings.size());
}

std::vector<mtk::S2<>> directions() {
  mtk::testing::Random noise(3);
  std::vector<mtk::S2<>> samples;
  for (int i = 0; i < 24; ++i) {
    mtk::S2<> v(0.3, -0.5, 0.8);
    const double along = 0.35 * noise.normal(), across = 0.35 * noise.normal();
    v.boxplus(Vec2(along, across));
    samples.push_back(v);
  }
  return samples;
}

void printAngles(std::ostream& os) {
  os << format("arithmetic mean of the numbers %.1f degrees\n", arithmeticMean());
  os << format("mean on the circle %.1f degrees\n\n", headingMean());

  const mtk::SO3<> turn = mtk::SO3<>::exp(Vec3(0, 0, 170 * kDegree)),
                   back = mtk::SO3<>::exp(Vec3(0, 0, -170 * kDegree));
  const Vec3 d = mtk::difference(back, turn);
  os << format(
      "from 170 to -170 degrees about z: [-] is %.1f degrees, the difference of the numbers %.1f\n\n",
      d.z() / kDegree, -340.0);

  const std::vector<mtk::S2<>> samples = directions();
  const mtk::S2<> mean = meanOf(samples, samples[0]);
  Vec3 sum(0, 0, 0);
  Vec2 arcs(0, 0);
  for (const mtk::S2<>& v : samples) {
    sum += v.vector() / double(samples.size());
    arcs += mtk::difference(v, mean);
  }
  os << format("mean of 24 directions (%.4f, %.4f, %.4f), length %.4f\n", mean.x(), mean.y(), mean.z(),
               mean.vector().norm());
  os << format("mean of their coordinates (%.4f, %.4f, %.4f), length %.4f\n", sum.x(), sum.y(), sum.z(),
               sum.norm());
  os << format("sum of v [-] mean: %.0e or less\n", arcs.norm() < 1e-6 ? 1e-6 : arcs.norm());
}

void drawCircle(Plot& plot) {
  plot.diagram({20, 40, 340, 340, -1.5, 1.5, -1.5, 1.5}, "headings");
  const auto place = [](double heading, double radius) {  // clockwise from north
    return Vec2(radius * std::sin(heading * kDegree), radius * std::cos(heading * kDegree));
  };
  Points circle;
  for (int i = 0; i <= 72; ++i) circle.push_back(place(5.0 * i, 1));
  plot.curve(circle, kGrey, 1);
  for (const double heading : kHeadings) plot.dot(place(heading, 1), kBlue, 5);
  plot.arrow({0, 0}, place(headingMean(), 0.93), kGreen);
  plot.arrow({0, 0}, place(arithmeticMean(), 0.93), kRed);
  plot.text(place(headingMean(), 1.25), "mean on the circle", kGreen, 0, 0, "middle");
  plot.text(place(arithmeticMean(), 1.1), "mean of the numbers", kRed, 40, 20, "middle");
}

/// Draws the directions as seen from far away along `view`: the visible half of the sphere.
void drawSphere(Plot& plot) {
  plot.diagram({380, 40, 340, 340, -1.5, 1.5, -1.5, 1.5}, "directions, their mean and its tangent plane");
  const std::vector<mtk::S2<>> samples = directions();
  const mtk::S2<> mean = meanOf(samples, samples[0]);
  const Vec3 view = Vec3(-0.3, -1, 0.75).normalized(), right = Vec3(0, 0, 1).cross(view).normalized(),
             up = view.cross(right);
  const auto seen = [&](const Vec3& p) { return Vec2(right.dot(p), up.dot(p)); };
  const auto visible = [&](const auto& point_at) {  // pieces of the circle on the visible side
    Points piece;
    for (int i = 0; i <= 120; ++i) {
      const Vec3 p = point_at(i * 2 * 3.14159265358979 / 120);
      if (view.dot(p) >= 0) piece.push_back(seen(p));
      if ((view.dot(p) < 0 || i == 120) && !piece.empty()) {
        plot.curve(piece, "#c8d0d8", 1);
        piece.clear();
      }
    }
  };
  Points outline;
  for (int i = 0; i <= 90; ++i)
    outline.emplace_back(std::cos(4.0 * i * kDegree), std::sin(4.0 * i * kDegree));
  plot.curve(outline, kGrey, 1);
  for (int k = 0; k < 6; ++k) {
    const double a = 30 * k * kDegree, z = -0.75 + 0.3 * k, r = std::sqrt(1 - z * z);
    visible(
        [&](double t) { return Vec3(std::cos(t) * std::cos(a), std::cos(t) * std::sin(a), std::sin(t)); });
    visible([&](double t) { return Vec3(r * std::cos(t), r * std::sin(t), z); });
  }
  const auto axis = [&](const Vec2& d) {  // axis of the tangent plane: the point that a small step reaches
    return Vec3((mtk::moved(mean, Vec2(1e-6 * d)).vector() - mean.vector()) / 1e-6);
  };
  const Vec3 e1 = 0.9 * axis(Vec2(1, 0)), e2 = 0.9 * axis(Vec2(0, 1)), m = mean.vector();
  const Points corners{seen(m + e1 + e2), seen(m - e1 + e2), seen(m - e1 - e2), seen(m + e1 - e2),
                       seen(m + e1 + e2)};
  plot.area(corners, kGreen, 0.12);
  plot.curve(corners, kGreen, 1);
  for (const mtk::S2<>& v : samples) {
    const Vec2 d = mtk::difference(v, mean);
    plot.curve({seen(v.vector()), seen(m + axis(d))}, kGreen, 0.7);
    plot.dot(seen(m + axis(d)), kGreen, 2);
    plot.dot(seen(v.vector()), kBlue, 3.5);
  }
  plot.dot(seen(m), kBlack, 5);
}

std::string drawAngles() {
  Plot plot(740, 400);
  drawCircle(plot);
  drawSphere(plot);
  return plot.svg();
}

}  // namespace

const Page kAngles{"angles", &printAngles, &drawAngles};
