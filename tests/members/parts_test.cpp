// Parts of variables: fixed, bounded, known beforehand, and all of that taken back.
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using Eigen::MatrixXd;
using slom::testing::messageOf;
using SE2 = mtk::trafo<mtk::SO2<>>;
using SE3 = mtk::trafo<mtk::SO3<>>;
using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;

/// A pose in the plane that sees a point and two known landmarks.
struct Plane {
  slom::Estimator est;
  slom::VarID<SE2> pose = est.insertRV(SE2(mtk::SO2<>(0.3), vec2(1, 2)), "pose");
  slom::VarID<vec2> point = est.insertRV(vec2(4, 5), "point");
  slom::VarID<double> scale = est.insertRV(1.1, "scale");

  explicit Plane(bool dense = false) {
    if (dense) est.changeSolver(std::make_unique<slom::DenseQR>());
    std::mt19937 engine(7);
    std::normal_distribution<double> normal(0, 0.05);
    const auto seen = [](const auto& T, const auto& p, const auto& s) {
      return (T.inverse() * p * s).eval();
    };
    const SE2 truth(mtk::SO2<>(0.4), vec2(1.1, 1.9));
    for (const vec2& landmark : {vec2(4.2, 5.1), vec2(0, 0), vec2(-1, 3), vec2(2, -2)}) {
      const vec2 z = seen(truth, landmark, 1.05) + vec2(normal(engine), normal(engine));
      if (landmark.x() > 4) {
        est.insertMeasurement(seen, pose, point, scale, slom::measured(z));
      } else {
        est.insertMeasurement(
            [landmark](const auto& T, const auto& s) { return (T.inverse() * landmark * s).eval(); }, pose,
            scale, slom::measured(z));
      }
    }
  }
  /// The component with this number among all six.
  void fix(int c, bool is_fixed) {
    const std::vector<std::string> paths{"pos.x", "pos.y", "orient"};
    if (c < 3) is_fixed ? est.fix(pose, paths[std::size_t(c)]) : est.free(pose, paths[std::size_t(c)]);
    if (c == 3 || c == 4) is_fixed ? est.fix(point, c == 3 ? "x" : "y") : est.free(point, c == 3 ? "x" : "y");
    if (c == 5) is_fixed ? est.fix(scale) : est.free(scale);
  }
  Eigen::Matrix<double, 6, 1> values() const {
    Eigen::Matrix<double, 6, 1> x;
    x << pose->pos, pose->orient.angle(), *point, *scale;
    return x;
  }
  void set(const Eigen::Matrix<double, 6, 1>& x) {
    est.reinitRV(pose, SE2(mtk::SO2<>(x[2]), vec2(x[0], x[1])));
    est.reinitRV(point, vec2(x[3], x[4]));
    est.reinitRV(scale, x[5]);
  }
  MatrixXd jacobian() {
    const auto x = values();
    MatrixXd J(est.getM(), 6);
    for (int c = 0; c < 6; ++c) {
      const double h = 1e-6;
      auto moved = x;
      moved[c] += h;
      set(moved);
      J.col(c) = est.residuals();
      moved[c] -= 2 * h;
      set(moved);
      J.col(c) = (J.col(c) - est.residuals()) / (2 * h);
    }
    set(x);
    return J;
  }
};

TEST(FixedComponents, EveryMaskIsTheProblemWithoutThem) {
  slom::Options options;
  options.decrease_tolerance = 1e-20;  // the default, 1e-12 of the RSS, allows a gradient of 1e-6
  for (const bool dense : {false, true}) {
    Plane plane(dense);
    const auto start = plane.values();
    for (int mask = 0; mask < 64; ++mask) {
      std::vector<int> free;
      for (int c = 0; c < 6; ++c) {
        plane.fix(c, (mask >> c & 1) != 0);
        if ((mask >> c & 1) == 0) free.push_back(c);
      }
      plane.set(start);
      const slom::Summary summary = plane.est.optimize(options);
      EXPECT_TRUE(summary.converged) << mask << ": " << summary.message;
      EXPECT_EQ(plane.est.getN(), static_cast<int>(free.size()));
      EXPECT_EQ(summary.redundancy, 8 - static_cast<int>(free.size()));
      EXPECT_EQ(slom::diagnose(plane.est).rank, static_cast<int>(free.size()));
      for (int c = 0; c < 6; ++c) {
        EXPECT_TRUE((mask >> c & 1) == 0 || plane.values()[c] == start[c]) << mask;
      }
      const MatrixXd J = plane.jacobian()(Eigen::all, free);
      EXPECT_LT((J.transpose() * plane.est.residuals()).norm(), 1e-7) << mask;
      MatrixXd expected = MatrixXd::Zero(6, 6);
      if (!free.empty()) expected(free, free) = MatrixXd((J.transpose() * J).inverse());
      MatrixXd C(6, 6);
      C << plane.est.covariance(plane.pose), plane.est.covariance(plane.pose, plane.point),
          plane.est.covariance(plane.pose, plane.scale), plane.est.covariance(plane.point, plane.pose),
          plane.est.covariance(plane.point), plane.est.covariance(plane.point, plane.scale),
          plane.est.covariance(plane.scale, plane.pose), plane.est.covariance(plane.scale, plane.point),
          plane.est.covariance(plane.scale);
      EXPECT_LT((C - expected).norm(), 1e-7 * (1 + expected.norm())) << mask;
      const slom::Marginals marginals = plane.est.marginals();
      EXPECT_LT((marginals.covariance(plane.pose) - expected.topLeftCorner(3, 3)).norm(),
                1e-7 * (1 + expected.norm()))
          << mask;
    }
  }
}

struct Camera : mtk::vect<3> {
  static constexpr std::array<std::string_view, 3> component_names{"f", "k1", "k2"};
};
struct Rig {
  SE3 pose;
  Camera left;
  std::array<vec2, 2> corners;
};

TEST(FixedComponents, AreNamedByPathOrMember) {
#ifdef __clang__  // which numbers the members of plain structs
  const std::string pose = "0", left = "1", corners = "2";
#else
  const std::string pose = "pose", left = "left", corners = "corners";
#endif
  slom::Estimator est;
  const auto rig = est.insertRV(Rig(), "rig");
  EXPECT_EQ(est.getN(), 13);
  est.fix(rig, pose + ".pos");
  EXPECT_EQ(est.getN(), 10);
  est.fix(&Rig::pose, rig);
  EXPECT_EQ(est.getN(), 7);
  est.fix(rig, left + ".k2");
  est.fix(rig, corners + ".1.y");
  EXPECT_EQ(est.getN(), 5);
  est.fix(&Rig::corners, rig);
  EXPECT_EQ(est.getN(), 2);
  est.free(&Rig::pose, rig);
  EXPECT_EQ(est.getN(), 8);
  est.free(rig);
  EXPECT_EQ(est.getN(), 13);
  EXPECT_EQ(messageOf([&] { est.fix(rig, left + ".k3"); }),
            "[slom.no-component] variable rig has no component \"" + left + ".k3\"; pass one of " + pose +
                ".pos.x, " + pose + ".pos.y, " + pose + ".pos.z, " + pose + ".orient.x, " + pose +
                ".orient.y, " + pose + ".orient.z, " + left + ".f, " + left + ".k1, " + left + ".k2, " +
                corners + ".0.x, " + corners + ".0.y, " + corners + ".1.x, " + corners + ".1.y");
  EXPECT_EQ(messageOf([&] { est.fix(rig, ""); }).substr(0, 46),
            "[slom.no-component] variable rig has no compon");
  const auto number = est.insertRV(1.0, "gain");
  EXPECT_EQ(messageOf([&] { est.bound(number, "x", 0, 2); }),
            "[slom.no-component] variable gain has no component \"x\"; pass \"\" for its only one");
  EXPECT_EQ(est.getN(), 14);
}

/// y = a + b x through (0, 0), (1, 2), (2, 4.3): b = 2.15, a = -0.05.
struct Line {
  slom::Estimator est;
  slom::VarID<vec2> line = est.insertRV(vec2(0, 1), "line");
  Line() {
    const double y[] = {0, 2, 4.3};
    for (int i = 0; i < 3; ++i) {
      est.insertMeasurement([x = double(i), z = y[i]](const auto& c) { return c[0] + c[1] * x - z; }, line);
    }
  }
};

TEST(Bounds, AreKeptAndReported) {
  for (int algorithm = 0; algorithm < 3; ++algorithm) {
    Line fit;
    if (algorithm == 1) fit.est.changeAlgorithm(slom::LevenbergMarquardt());
    if (algorithm == 2) fit.est.changeAlgorithm(slom::DogLeg());
    slom::Estimator& est = fit.est;
    est.bound(fit.line, "y", 0, 2);
    slom::Summary summary = est.optimize();
    EXPECT_TRUE(summary.converged) << summary.message;
    EXPECT_EQ((*fit.line)[1], 2);
    EXPECT_NEAR((*fit.line)[0], 0.1, 1e-9);  // the mean of y - 2 x
    EXPECT_EQ(summary.active_bounds, std::vector<std::string>{"line.y is at its upper bound 2"});
    EXPECT_NE(slom::report(summary).find(
                  "  line.y is at its upper bound 2; standard deviations hold if it stays there\n"),
              std::string::npos);
    EXPECT_EQ(summary.unknowns, 1);
    EXPECT_EQ(est.getN(), 2);
    MatrixXd C = MatrixXd::Zero(2, 2);
    C(0, 0) = 1.0 / 3;
    EXPECT_LT((est.covariance(fit.line) - C).norm(), 1e-12);
    EXPECT_LT((est.marginals().covariance(fit.line) - C).norm(), 1e-12);

    // Wider, and the bound lets go; the values move on from where they are.
    est.bound(fit.line, "y", 0, 3);
    summary = est.optimize();
    EXPECT_TRUE(summary.active_bounds.empty());
    EXPECT_NEAR((*fit.line)[1], 2.15, 1e-9);
    EXPECT_EQ(est.getN(), 2);
    est.reinitRV(fit.line, vec2(-3, 0.5));
    est.bound(fit.line, "y", -1, 1);
    est.bound(fit.line, "x", -std::numeric_limits<double>::infinity(), 0.5);
    summary = est.optimize();
    EXPECT_EQ(summary.active_bounds, (std::vector<std::string>{"line.x is at its upper bound 0.5",
                                                               "line.y is at its upper bound 1"}));
    EXPECT_EQ(*fit.line, vec2(0.5, 1));
    EXPECT_EQ(est.covariance(fit.line), MatrixXd::Zero(2, 2));
    const double inf = std::numeric_limits<double>::infinity();
    est.bound(fit.line, "x", -inf, inf);
    est.bound(fit.line, "y", -inf, inf);
    EXPECT_TRUE(est.optimize().active_bounds.empty());
    EXPECT_NEAR((*fit.line)[1], 2.15, 1e-9);
  }
}

/// Against exhaustive search over all active sets, for random convex problems in a box.
TEST(Bounds, GiveTheSolutionOfBoxConstrainedLeastSquares) {
  std::mt19937 engine(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 100; ++trial) {
    constexpr int n = 4, m = 6;
    Eigen::Matrix<double, m, n> A;
    Eigen::Matrix<double, m, 1> b;
    for (double& a : A.reshaped()) a = normal(engine);
    for (double& y : b) y = 3 * normal(engine);
    double best = std::numeric_limits<double>::infinity();
    Eigen::Matrix<double, n, 1> solution = Eigen::Matrix<double, n, 1>::Zero();
    for (int set = 0; set < 81; ++set) {  // each component at -1, at 1, or free
      Eigen::Matrix<double, n, 1> x;
      std::vector<int> free;
      for (int c = 0, rest = set; c < n; ++c, rest /= 3) {
        x[c] = rest % 3 - 1;
        if (rest % 3 == 1) free.push_back(c);
      }
      const Eigen::VectorXd r = b - A * x;
      if (!free.empty()) x(free) += A(Eigen::all, free).colPivHouseholderQr().solve(r);
      const double rss = (A * x - b).squaredNorm();
      if (x.cwiseAbs().maxCoeff() <= 1 + 1e-12 && rss < best) {
        best = rss;
        solution = x;
      }
    }
    slom::Estimator est;
    const auto x = est.insertRV(Eigen::Vector4d(Eigen::Vector4d::Zero()), "x");
    est.insertMeasurement([A, b](const auto& v) { return (A * v - b).eval(); }, x);
    for (const char* path : {"0", "1", "2", "3"}) est.bound(x, path, -1, 1);
    est.changeAlgorithm(slom::LevenbergMarquardt());
    const slom::Summary summary = est.optimize();
    EXPECT_TRUE(summary.converged) << summary.message;
    EXPECT_NEAR(summary.final_rss, best, 1e-9 * (1 + best)) << trial;
    EXPECT_LT((*x - solution).norm(), 1e-5) << trial;
  }
}

TEST(Bounds, FaultsAreNamed) {
  Line fit;
  EXPECT_EQ(
      messageOf([&] { fit.est.bound(fit.line, "y", 2, 1); }),
      "[slom.bad-bound] the bound of line.y is [2, 1]; pass a lower limit that is not above the upper one");
  EXPECT_EQ(
      messageOf([&] { fit.est.bound(fit.line, "y", 2, 3); }),
      "[slom.outside-bound] line.y is 1, outside of its bound [2, 3]; give it a value inside, or another bound");
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(
      messageOf([&] { fit.est.bound(fit.line, "y", inf, inf); }),
      "[slom.bad-bound] the bound of line.y is [inf, inf], which holds no finite number; pass -infinity and "
      "infinity to remove a bound");
  EXPECT_EQ(
      messageOf([&] { fit.est.bound(fit.line, "y", -inf, -inf); }),
      "[slom.bad-bound] the bound of line.y is [-inf, -inf], which holds no finite number; pass -infinity "
      "and infinity to remove a bound");
  fit.est.bound(fit.line, "y", 0, 2);
  EXPECT_EQ(
      messageOf([&] { fit.est.reinitRV(fit.line, vec2(0, 5)); }),
      "[slom.outside-bound] line.y is 5, outside of its bound [0, 2]; give it a value inside, or another bound");
  EXPECT_EQ(*fit.line, vec2(0, 1));
  const auto pose = fit.est.insertRV(SE3(), "pose");
  EXPECT_EQ(
      messageOf([&] { fit.est.bound(pose, "orient.z", 0, 1); }),
      "[slom.bad-bound] pose.orient.z has no coordinate that can be bounded: it is part of a rotation or the "
      "like; bound "
      "components of vectors, or add a prior");
}

TEST(Bounds, OfAVariableWithOneComponentNeedNoName) {
  slom::Estimator est;
  const double inf = std::numeric_limits<double>::infinity();
  const auto check = [&](const auto& start, const auto& target) {
    const auto id = est.insertRV(start);
    est.prior(id, target, 1);
    est.bound(id, 0, 2);
    EXPECT_EQ(est.optimize().active_bounds.size(), 1u);
    EXPECT_EQ(slom::profile(est, id).upper, 2);
    est.bound(id, -inf, inf);
    EXPECT_EQ(est.optimize().active_bounds.size(), 0u);
    EXPECT_EQ(*id, target);
  };
  check(1.0, 3.0);
  check(mtk::vect<1>(1.0), mtk::vect<1>(3.0));
  check(Eigen::VectorXd(Eigen::VectorXd::Ones(1)), Eigen::VectorXd(3 * Eigen::VectorXd::Ones(1)));
}

/// A component at its bound is a component: the count of getN does not depend on the last linearisation.
TEST(Bounds, DoNotChangeTheNumberOfUnknowns) {
  slom::Estimator est;
  const auto x = est.insertRV(vec2(1, 1), "x");
  est.prior(x, vec2(5, 1), 1);
  est.bound(x, "x", 0, 2);
  EXPECT_EQ(est.getN(), 2);
  const slom::Summary summary = est.optimize();
  ASSERT_EQ(summary.active_bounds.size(), 1u);
  EXPECT_EQ(summary.unknowns, 1);
  EXPECT_EQ(summary.redundancy, 1);
  EXPECT_EQ(est.getN(), 2);
  est.covariance(x);
  EXPECT_EQ(est.getN(), 2);
  est.fix(x, "y");
  EXPECT_EQ(est.getN(), 1);
  est.fix(x, "x");
  EXPECT_EQ(est.getN(), 0);
  est.free(x);
  EXPECT_EQ(est.getN(), 2);
  est.optimizeRV(x, false);
  EXPECT_EQ(est.getN(), 0);
}

TEST(Priors, AreMeasurementsThatCanBeTakenBack) {
  Line fit;
  const auto prior = fit.est.prior(fit.line, vec2(0, 0), 0.5);
  EXPECT_EQ(fit.est.getM(), 5);
  fit.est.optimize();
  // (J^T J + 4 I) x = J^T y
  Eigen::Matrix2d H;
  H << 3 + 4, 3, 3, 5 + 4;
  EXPECT_LT((*fit.line - H.inverse() * Eigen::Vector2d(6.3, 10.6)).norm(), 1e-12);
  EXPECT_LT((fit.est.covariance(fit.line) - H.inverse()).norm(), 1e-12);
  fit.est.removeMeasurement(prior);
  EXPECT_EQ(fit.est.getM(), 3);
  fit.est.prior(fit.line, vec2(0, 0), slom::Covariance(Eigen::Vector2d(1, 4)));
  EXPECT_EQ(fit.est.getM(), 5);
}

}  // namespace
