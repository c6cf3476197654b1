// Messages of a fit about problems that do not determine all of their unknowns, word for word.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

namespace {

using mtk::SO2;
using mtk::SO3;
using SE2 = mtk::trafo<SO2<>>;
using SE3 = mtk::trafo<SO3<>>;
using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;
using Kind = slom::Finding::Kind;

std::vector<std::string> faults(const slom::Diagnosis& diagnosis) {
  std::vector<std::string> result;
  for (const slom::Finding& finding : diagnosis.findings) {
    if (finding.is_fault) result.push_back(finding.text);
  }
  return result;
}

std::vector<std::string> hints(const slom::Diagnosis& diagnosis) {
  std::vector<std::string> result;
  for (const slom::Finding& finding : diagnosis.findings) {
    if (!finding.is_fault) result.push_back(finding.text);
  }
  return result;
}

using Texts = std::vector<std::string>;

SE3 randomPose(std::mt19937& engine) {
  std::normal_distribution<double> normal;
  SE3 pose;
  mtk::tangent_t<SE3> d;
  for (int i = 0; i < 6; ++i) d[i] = normal(engine);
  mtk::boxplus<SE3>(pose, d);
  return pose;
}

/// Poses in a ring, each measured relative to the one before.
template <class Pose, class Random>
std::vector<slom::VarID<Pose>> insertRing(slom::Estimator& est, int count, const Random& random) {
  std::vector<slom::VarID<Pose>> poses;
  for (int i = 0; i < count; ++i) poses.push_back(est.insertRV(random(), "pose " + std::to_string(i)));
  for (int i = 0; i < count; ++i) {
    const auto a = poses[std::size_t(i)], b = poses[std::size_t((i + 1) % count)];
    est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(Pose(a->inverse() * *b)));
  }
  return poses;
}

TEST(Diagnosis, FreeGaugeOfPosesInSpace) {
  std::mt19937 engine(1);
  slom::Estimator est;
  const auto poses = insertRing<SE3>(est, 5, [&] { return randomPose(engine); });
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  EXPECT_EQ(diagnosis.rank, 24);
  EXPECT_EQ(diagnosis.unknowns, 30);
  EXPECT_EQ(
      faults(diagnosis),
      Texts{
          "All 5 poses (pose 0, pose 1, ..., pose 4) can move together (translation x, y, z; rotation about x, y, z) "
          "without changing any residual: fix one pose or add a prior"});
  EXPECT_EQ(diagnosis.findings[0].kind, Kind::gauge);
  EXPECT_EQ(diagnosis.findings[0].dimension, 6);
  EXPECT_EQ(diagnosis.findings[0].names, (Texts{"pose 0", "pose 1", "pose 2", "pose 3", "pose 4"}));
  try {
    est.covariance(poses[1]);
    FAIL() << "covariance of a free gauge";
  } catch (const mtk::Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "[slom.free-gauge] the gauge is free, so there are no covariances. " + faults(diagnosis)[0] +
                  "; setFreeGauge(slom::FreeGauge::inner_constraints) fits a free network");
  }
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.stop_reason, slom::StopReason::rank_deficient);
  EXPECT_EQ(summary.warnings, faults(diagnosis));

  est.optimizeRV(poses[0], false);
  const slom::Diagnosis fixed = slom::diagnose(est);
  EXPECT_TRUE(fixed.isDetermined());
  EXPECT_EQ(fixed.text(), "rank 24 of 24 unknowns, 30 residuals\n");
}

TEST(Diagnosis, FreeGaugeOfPosesInThePlane) {
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  slom::Estimator est;
  insertRing<SE2>(est, 3,
                  [&] { return SE2(SO2<>(normal(engine)), vec2(1e3 + normal(engine), normal(engine))); });
  EXPECT_EQ(
      faults(slom::diagnose(est)),
      Texts{
          "All 3 poses (pose 0, pose 1, pose 2) can move together (translation x, y; rotation about z) without changing "
          "any residual: fix one pose or add a prior"});
}

TEST(Diagnosis, ADirectionThatIsMeasuredLeavesTheRest) {
  std::mt19937 engine(3);
  slom::Estimator est;
  const auto poses = insertRing<SE3>(est, 4, [&] { return randomPose(engine); });
  // What accelerometers say: where z is.
  for (const auto& pose : poses) {
    const auto down = [](const auto& T) { return T.orient.inverse() * vec3(0, 0, 1); };
    est.insertMeasurement(down, pose, slom::measured(down(*pose)));
  }
  EXPECT_EQ(
      faults(slom::diagnose(est)),
      Texts{
          "All 4 poses (pose 0, pose 1, pose 2, pose 3) can move together (translation x, y, z; rotation about z) without "
          "changing any residual: fix one pose or add a prior"});
  const auto position = [](const auto& T) { return T.pos; };
  est.insertMeasurement(position, poses[2], slom::measured(poses[2]->pos));
  EXPECT_EQ(
      faults(slom::diagnose(est)),
      Texts{
          "All 4 poses (pose 0, pose 1, pose 2, pose 3) can move together (rotation about z) without changing any residual: "
          "fix one pose or add a prior"});
}

/// Poses from the world to the camera, as in bundle adjustment, and points that are measured by bearings only.
TEST(Diagnosis, ScaleOfMonocularBundleAdjustment) {
  std::mt19937 engine(4);
  std::normal_distribution<double> normal;
  slom::Estimator est;
  std::vector<slom::VarID<SE3>> cameras;
  std::vector<slom::VarID<vec3>> points;
  for (int i = 0; i < 3; ++i) {
    SE3 camera(vec3(0.3 * i, 0.1 * i * i, 5));
    camera.orient = SO3<>::exp(0.1 * vec3(normal(engine), normal(engine), normal(engine)));
    cameras.push_back(est.insertRV(camera, "camera " + std::to_string(i)));
  }
  for (int i = 0; i < 10; ++i) {
    points.push_back(
        est.insertRV(vec3(normal(engine), normal(engine), normal(engine)), "point " + std::to_string(i)));
  }
  for (const auto& camera : cameras) {
    for (const auto& point : points) {
      const auto project = [](const auto& T, const auto& p) {
        const auto q = T * p;
        return (q.template head<2>() / q[2]).eval();
      };
      est.insertMeasurement(project, camera, point, slom::measured(vec2(project(*camera, *point))));
    }
  }
  EXPECT_EQ(
      faults(slom::diagnose(est)),
      Texts{
          "All 10 points (point 0, point 1, ..., point 9) and all 3 poses (camera 0, camera 1, camera 2) can move together "
          "(translation x, y, z; rotation about x, y, z; scale) without changing any residual: fix one pose or add a prior, "
          "and measure a length"});
  est.optimizeRV(cameras[0], false);
  EXPECT_EQ(
      faults(slom::diagnose(est)),
      Texts{
          "All 10 points (point 0, point 1, ..., point 9) and both poses (camera 1, camera 2) can move together (scale) "
          "without changing any residual: measure a length or fix one"});
}

TEST(Diagnosis, TwoVariablesThatOnlyAppearAsASum) {
  slom::Estimator est;
  const auto a = est.insertRV(1.0, "offset"), b = est.insertRV(2.0, "bias");
  for (const double z : {1.0, 2.0, 3.0})
    est.insertMeasurement([z](const auto& x, const auto& y) { return x + y - z; }, a, b);
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  EXPECT_EQ(diagnosis.rank, 1);
  EXPECT_EQ(
      faults(diagnosis),
      Texts{
          "offset and bias cannot be told apart: moving them by +1 and -1 changes no residual, to first order; fix one of them, or add a "
          "prior or measurements that depend on them in another way"});
}

TEST(Diagnosis, AComponentThatNothingMeasures) {
  slom::Estimator est;
  const auto p = est.insertRV(vec3(1, 2, 3), "antenna");
  const auto unused = est.insertRV(5.0, "clock");
  est.insertMeasurement([](const auto& x) { return (x.template head<2>() - vec2(1, 1)).eval(); }, p);
  EXPECT_EQ(
      faults(slom::diagnose(est)),
      (Texts{
          "no residual changes with antenna.z, to first order: add measurements that depend on it or a "
          "prior, or fix it",
          "no measurement depends on variable clock, so nothing determines it; add measurements or fix it with "
          "fix(id)"}));
  EXPECT_EQ(slom::diagnose(est).rank, 2);
  est.optimizeRV(unused, false);
  EXPECT_EQ(slom::diagnose(est).rank, 2);
}

TEST(Diagnosis, HintsOnWhatIsHardlyDetermined) {
  slom::Estimator est;
  const auto line = est.insertRV(vec2(0, 0), "line");
  for (int i = 0; i < 10; ++i) {
    const double x = 1000 + i;
    est.insertMeasurement([x](const auto& c) { return c[0] + c[1] * x - x; }, line);
  }
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  EXPECT_TRUE(diagnosis.isDetermined());
  EXPECT_EQ(
      hints(diagnosis),
      Texts{
          "line.x and line.y can hardly be told apart (correlation -0.999996): add measurements that depend on them in "
          "another way or a prior, or fix one of them"});

  const auto other = est.insertRV(1.0, "other"), fixed = est.insertRV(1.0, false);
  est.insertMeasurement([](const auto& x) { return 1e-15 * x; }, other, slom::named("faint"));
  est.insertMeasurement([](const auto& x) { return x; }, fixed, slom::named("idle"));
  EXPECT_EQ(
      hints(slom::diagnose(est)),
      (Texts{
          "1 of 1 measurement idle depends on fixed variables alone: they count in chi-square and redundancy, but determine "
          "nothing",
          "the variables form 2 groups that no measurement connects: line; other",
          "a unit of line.y changes the residuals 3e+18 times as much as a unit of other: choose units in which both are "
          "of a size that can be told apart from 0",
          "line.x and line.y can hardly be told apart (correlation -0.999996): add measurements that depend on them in "
          "another way or a prior, or fix one of them"}));
}

TEST(Diagnosis, WeakDirectionsComeWithTheirStandardDeviation) {
  slom::Estimator est;
  const auto a = est.insertRV(0.0, "a"), b = est.insertRV(0.0, "b");
  est.insertMeasurement([](const auto& x, const auto& y) { return x + y; }, a, b);
  est.insertMeasurement([](const auto& x, const auto& y) { return x + y * (1 + 1e-7); }, a, b);
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  EXPECT_TRUE(diagnosis.isDetermined());
  ASSERT_FALSE(hints(diagnosis).empty());
  EXPECT_EQ(
      hints(diagnosis)[0],
      "a and b are hardly determined: moving together (by +1 and -1), a has a standard deviation of 1.41e+07");
}

TEST(Diagnosis, TellsTwentyWeakDirectionsAndCountsTheRest) {
  slom::Estimator est;
  for (int i = 0; i < 23; ++i) {
    const auto a = est.insertRV(0.0), b = est.insertRV(0.0);
    est.insertMeasurement([](const auto& x, const auto& y) { return x + y; }, a, b);
    est.insertMeasurement([](const auto& x, const auto& y) { return x + y * (1 + 1e-7); }, a, b);
  }
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  EXPECT_TRUE(diagnosis.isDetermined());
  int weak = 0, directions = 0;
  std::string last;
  for (const slom::Finding& finding : diagnosis.findings) {
    if (finding.kind != slom::Finding::Kind::weak) continue;
    ++weak;
    directions += finding.dimension;
    last = finding.text;
  }
  EXPECT_EQ(weak, 21);
  EXPECT_EQ(directions, 23);
  EXPECT_EQ(
      last,
      "3 more directions are hardly determined; check that all components of all measurements are as certain "
      "as stated");
}

void connect(slom::Estimator& est, const slom::VarID<SE2>& a, const slom::VarID<SE2>& b) {
  est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(SE2(a->inverse() * *b)));
}

/// All poses, named by number, can move in the plane, and there is nothing else to say.
void expectFreePoses(const slom::Estimator& est, int count) {
  const slom::Diagnosis diagnosis = slom::diagnose(est);
  const std::string last = std::to_string(count - 1);
  EXPECT_EQ(diagnosis.rank, 3 * (count - 1));
  EXPECT_EQ(faults(diagnosis),
            Texts{"All " + std::to_string(count) + " poses (pose 0, pose 1, ..., pose " + last +
                  ") can move together (translation x, y; "
                  "rotation about z) without changing any residual: fix one pose or add a prior"});
}

/// A grid of 100 x 100 poses: nothing grows with the square of their number.
TEST(Diagnosis, OfManyVariables) {
  slom::Estimator est;
  std::vector<slom::VarID<SE2>> poses;
  constexpr int width = 100;
  for (int i = 0; i < width * width; ++i) {
    poses.push_back(
        est.insertRV(SE2(SO2<>(0.1 * i), vec2(i % width, i / width)), "pose " + std::to_string(i)));
    if (i % width > 0) connect(est, poses[std::size_t(i - 1)], poses.back());
    if (i >= width) connect(est, poses[std::size_t(i - width)], poses.back());
  }
  expectFreePoses(est, 10000);
}

/// A chain has many directions that are nearly free, and three that are.
TEST(Diagnosis, OfALongChain) {
  slom::Estimator est;
  std::vector<slom::VarID<SE2>> poses;
  for (int i = 0; i < 2000; ++i) {
    poses.push_back(est.insertRV(SE2(SO2<>(0.1 * i), vec2(i, 0)), "pose " + std::to_string(i)));
    if (i > 0) connect(est, poses[std::size_t(i - 1)], poses.back());
  }
  expectFreePoses(est, 2000);
}

TEST(Diagnosis, OfAnEmptyProblem) {
  EXPECT_EQ(slom::diagnose(slom::Estimator()).text(), "rank 0 of 0 unknowns, 0 residuals\n");
}

}  // namespace
