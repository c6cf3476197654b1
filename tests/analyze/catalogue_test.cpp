// Broken problems that users bring, and the messages about them, word for word. Free gauges, the scale of a monocular
// bundle adjustment, sums and wrong sigmas are in diagnosis_test.cpp and outliers_test.cpp. NaN and wrong derivatives
// are in preflight_test.cpp.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace {

using mtk::SO3;
using SE3 = mtk::trafo<SO3<>>;
using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;
using Texts = std::vector<std::string>;

Texts faults(const slom::Estimator& est) {
  Texts result;
  for (const slom::Finding& finding : slom::diagnose(est).findings) {
    if (finding.is_fault) result.push_back(finding.text);
  }
  return result;
}

TEST(BrokenProblem, BiasThatNothingObserves) {
  slom::Estimator est;
  const auto gravity = est.insertRV(vec3(0, 0, -9.81), "gravity"),
             bias = est.insertRV(vec3(0.1, 0, 0), "bias");
  for (int i = 0; i < 5; ++i) {  // the sensor is never turned
    est.insertMeasurement([](const auto& g, const auto& b) { return (g + b).eval(); }, gravity, bias,
                          slom::measured(vec3(0.1, 0, -9.8)));
  }
  EXPECT_EQ(faults(est).size(), 3u);
  for (const std::string axis : {"x", "y", "z"}) {
    const std::string text =
        "gravity." + axis + " and bias." + axis +
        " cannot be told apart: moving them by +1 and -1 changes no residual, to first order; fix one of them, or add a prior or "
        "measurements that depend on them in another way";
    const Texts all = faults(est);
    EXPECT_EQ(std::count(all.begin(), all.end(), text), 1) << axis << ": " << ::testing::PrintToString(all);
  }
}

TEST(BrokenProblem, PlanarMotion) {
  // Where a camera sits on a robot that drives in the plane, from pairs of motions: robot X = X camera.
  slom::Estimator est;
  const SE3 truth(SO3<>::exp(vec3(0.3, -0.2, 0.5)), vec3(0.2, 0.1, 0.4));
  const auto mount = est.insertRV(truth, "camera");
  for (int i = 1; i < 6; ++i) {
    const SE3 robot(SO3<>::exp(vec3(0, 0, 0.4 * i)), vec3(std::cos(i), 0.3 * i, 0));
    const SE3 seen = truth.inverse() * robot * truth;
    est.insertMeasurement([robot](const auto& X) { return X.inverse() * robot * X; }, mount,
                          slom::measured(seen));
  }
  EXPECT_EQ(
      faults(est),
      Texts{"no residual changes with camera.pos.z, to first order: add measurements that depend on it or a "
            "prior, or fix it"});
}

struct Lens : mtk::vect<4> {
  using mtk::vect<4>::vect;
  static constexpr std::array<std::string_view, 4> component_names{"fx", "fy", "cx", "cy"};
};

/// Views of a board, 5 by 4 squares, by one camera.
struct Board {
  slom::Estimator est;
  slom::VarID<Lens> lens = est.insertRV(Lens(500, 500, 320, 240), "lens");
  std::vector<slom::VarID<SE3>> views;

  void see(const SE3& view) {
    views.push_back(est.insertRV(view, "view " + std::to_string(views.size())));
    for (int x = -2; x <= 2; ++x) {
      for (int y = -2; y <= 1; ++y) {
        const vec3 corner(0.1 * x, 0.1 * y, 0);
        const auto pixel = [corner](const auto& c, const auto& T) {
          const auto p = (T * corner).eval();
          using S = std::decay_t<decltype(c[0] * p[0])>;
          return mtk::vect<2, S>(c[0] * p[0] / p[2] + c[2], c[1] * p[1] / p[2] + c[3]);
        };
        est.insertMeasurement(pixel, lens, views.back(), slom::measured(vec2(pixel(*lens, *views.back()))));
      }
    }
  }
};

TEST(BrokenProblem, AllImagesParallelToTheBoard) {
  Board board;
  for (int i = 0; i < 4; ++i)
    board.see(SE3(SO3<>::exp(vec3(0, 0, 0.3 * i)), vec3(0.05 * i, 0.02 * i * i, 1 + 0.2 * i)));
  EXPECT_EQ(
      faults(board.est),
      (Texts{
          "lens.cx, view 0.pos.x, view 1.pos.x and 2 more can move together (by +1, -0.002, -0.0024 and 2 more) without changing any residual; fix one of them, or add a prior or measurements that depend on them in another way",
          "lens.cy, view 0.pos.y, view 1.pos.y and 2 more can move together (by +1, -0.002, -0.0024 and 2 more) without changing any residual; fix one of them, or add a prior or measurements that depend on them in another way",
          "lens.fx, lens.fy, view 3.pos.z and 3 more can move together (by +1, +1, +0.0032 and 3 more) without changing any residual; fix one of them, or add a prior or measurements that depend on them in another way"}));
}

TEST(BrokenProblem, ABoardSeenOnce) {
  Board board;
  board.see(SE3(SO3<>::exp(vec3(0.4, -0.3, 0.2)), vec3(0.05, 0.02, 1.2)));
  EXPECT_EQ(slom::diagnose(board.est).rank, 8);  // a homography
  EXPECT_EQ(
      faults(board.est),
      (Texts{
          "view 0.pos.y, lens.cy, view 0.pos.z and 6 more can move together (by +1, -418, -1.07 and 6 more) without changing any residual; fix one of them, or add a prior or measurements that depend on them in another way",
          "view 0.pos.x, lens.cx, view 0.pos.z and 6 more can move together (by +1, -419, -1.78 and 6 more) without changing any residual; fix one of them, or add a prior or measurements that depend on them in another way"}));
  // Two views and a square pixel are enough.
  board.see(SE3(SO3<>::exp(vec3(-0.4, 0.3, 0.2)), vec3(0.05, 0.02, 1.2)));
  EXPECT_EQ(faults(board.est), (Texts{}));
}

/// A stereo camera that sees a board from many sides; in one pair the images are swapped.
TEST(BrokenProblem, SwappedImages) {
  slom::Estimator est;
  std::mt19937 engine(8);
  std::normal_distribution<double> normal;
  const SE3 truth(vec3(-0.2, 0.01, 0));
  const auto left2right = est.insertRV(SE3(vec3(-0.18, 0, 0)), "left2right");
  for (int i = 0; i < 8; ++i) {
    const SE3 view(SO3<>::exp(0.2 * vec3(normal(engine), normal(engine), normal(engine))),
                   vec3(0.05, 0.02, 1.2));
    const auto id = est.insertRV(view, "view " + std::to_string(i));
    for (int c = 0; c < 12; ++c) {
      const vec3 corner(0.1 * (c % 4), 0.1 * (c / 4), 0);
      const auto project = [corner](const auto& T) {
        const auto p = (T * corner).eval();
        return (500 * p.template head<2>() / p[2]).eval();
      };
      vec2 left = project(view) + 0.2 * vec2(normal(engine), normal(engine));
      vec2 right = project(truth * view) + 0.2 * vec2(normal(engine), normal(engine));
      if (i == 5) std::swap(left, right);
      const std::string image = std::to_string(i);
      est.insertMeasurement(project, id, slom::measured(left), slom::StandardDeviation(0.2),
                            slom::named("left " + image));
      est.insertMeasurement([project](const auto& T, const auto& l2r) { return project(l2r * T); }, id,
                            left2right, slom::measured(right), slom::StandardDeviation(0.2),
                            slom::named("right " + image), slom::Cauchy(3));
    }
  }
  est.changeAlgorithm(slom::LevenbergMarquardt());
  EXPECT_TRUE(est.optimize().converged);
  const slom::OutlierReport report = slom::outliers(est);
  for (const slom::GroupCheck& group : report.groups) {
    EXPECT_EQ(group.suspects > 0, group.name == "right 5")
        << group.name << " has " << group.suspects << " suspects";
  }
}

}  // namespace
