// Marginalised variables leave their information behind: the rest of the problem keeps its optimum and its covariances.
#include <cmath>
#include <numeric>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "slom/measurements.hpp"
#include "slom/measurements/gaussian_prior.hpp"
#include "slom/slom.hpp"
#include "slom/solve/dense_qr.hpp"
#include "support/message_of.hpp"

namespace slom {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Pose = mtk::trafo<mtk::SO2<>>;
using testing::messageOf;

/// Points of the plane and numbers that are measured together, linearly.
struct Linear {
  std::mt19937 rng;
  Estimator est;
  std::vector<VarID<mtk::vect<2>>> points;
  std::vector<VarID<double>> numbers;

  double normal() { return std::normal_distribution<>()(rng); }
  int any(std::size_t n) { return std::uniform_int_distribution<int>(0, int(n) - 1)(rng); }

  Linear(unsigned seed, int size, bool has_priors) : rng(seed) {
    for (int i = 0; i < size; ++i) points.push_back(est.insertRV(mtk::vect<2>(normal(), normal())));
    for (int i = 0; i < size / 3; ++i) numbers.push_back(est.insertRV(normal()));
    for (int m = 0; m < 3 * size; ++m) {
      const auto a = points[std::size_t(any(points.size()))], b = points[std::size_t(any(points.size()))];
      if (a == b) continue;
      const double c = normal();
      est.insertMeasurement([c](const auto& x, const auto& y) { return (x - y) * c; }, a, b,
                            measured(mtk::vect<2>(normal(), normal())),
                            StandardDeviation(0.1 + std::abs(normal())));
      if (m % 2 == 0) {
        est.insertMeasurement([c](const auto& x, const auto& s) { return x[0] + c * x[1] - s; }, a,
                              numbers[std::size_t(any(numbers.size()))], measured(normal()),
                              StandardDeviation(0.3));
      }
    }
    if (!has_priors) return;
    for (int i = 0; i < size; i += 4) est.prior(points[std::size_t(i)], mtk::vect<2>(normal(), normal()), 1.);
    for (const auto& number : numbers) est.prior(number, normal(), 2.);
  }
};

TEST(Marginalize, LeavesTheOptimumOfALinearProblem) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Linear whole(seed, 12, true), less(seed, 12, true);
    std::vector<AnyVarID> gone;
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < less.points.size(); ++i) {
      if (less.any(2) == 0) {
        gone.emplace_back(less.points[i]);
      } else {
        kept.push_back(i);
      }
    }
    gone.emplace_back(less.numbers[1]);
    less.est.marginalize(gone);  // not at the optimum
    ASSERT_TRUE(whole.est.optimize().converged);
    ASSERT_TRUE(less.est.optimize().converged);
    const auto agree = [&](const auto& a, const auto& b) {
      EXPECT_LT((whole.est.covariance(a) - less.est.covariance(b)).norm(),
                1e-11 * whole.est.covariance(a).norm());
    };
    for (const std::size_t i : kept) {
      EXPECT_LT((*whole.points[i] - *less.points[i]).norm(), 1e-11) << seed;
      agree(whole.points[i], less.points[i]);
      const MatrixXd a = whole.est.jointCovariance(whole.points[i], whole.numbers[0]);
      EXPECT_LT((a - less.est.jointCovariance(less.points[i], less.numbers[0])).norm(), 1e-11 * a.norm());
    }
    EXPECT_NEAR(*whole.numbers[0], *less.numbers[0], 1e-11);
  }
}

TEST(Marginalize, TakesOneVariableAfterTheOtherAsAllTogether) {
  Linear at_once(7, 15, true), in_turn(7, 15, true);
  std::vector<AnyVarID> gone;
  for (std::size_t i = 0; i < 10; ++i) {
    gone.emplace_back(at_once.points[i]);
    in_turn.est.marginalize({in_turn.points[i]});
  }
  at_once.est.marginalize(gone);
  at_once.est.optimize();
  in_turn.est.optimize();
  for (std::size_t i = 10; i < 15; ++i) EXPECT_LT((*at_once.points[i] - *in_turn.points[i]).norm(), 1e-11);
}

/// A loop of poses in the plane with an odometer and closures. Some closures are wrong if `loss` is given.
struct ClosedLoop {
  Estimator est;
  std::vector<VarID<Pose>> poses;

  explicit ClosedLoop(int n, const Loss& loss = {}) {
    std::mt19937 rng(3);
    const auto noise = [&](double s) { return std::normal_distribution<>(0, s)(rng); };
    const double turn = 2 * M_PI / n;
    for (int i = 0; i < n; ++i) {
      const double at = turn * i;
      poses.push_back(est.insertRV(
          Pose({std::sin(at) + noise(0.02), 1 - std::cos(at) + noise(0.02)}, mtk::SO2<>(at + noise(0.02))),
          "pose " + std::to_string(i)));
    }
    const auto relative = [&](int a, int b) {
      const auto exact = [&](int i) {
        return Pose({std::sin(turn * i), 1 - std::cos(turn * i)}, mtk::SO2<>(turn * i));
      };
      Pose step = exact(a).inverse() * exact(b);
      step.pos += mtk::vect<2>(noise(0.01), noise(0.01));
      step.orient = step.orient * mtk::SO2<>(noise(0.01));
      return step;
    };
    const auto measure = [&](int a, int b, Pose step) {
      est.insertMeasurement(RelativePose(), poses[std::size_t(a)], poses[std::size_t(b)], measured(step),
                            StandardDeviation(0.01), loss);
    };
    for (int i = 0; i < n; ++i) measure(i, (i + 1) % n, relative(i, (i + 1) % n));
    for (int i = 0; i + n / 2 < n; i += 2) measure(i, i + n / 2, relative(i, i + n / 2));
    Pose wrong = relative(1, n / 2);
    wrong.pos.x() += 0.1;
    measure(1, n / 2, wrong);
  }
};

/// H of some variables after the others are eliminated, densely.
MatrixXd schurComplement(const MatrixXd& H, int first, int count) {
  const int n = int(H.rows()), last = first + count;
  std::vector<int> kept, gone;
  for (int i = 0; i < n; ++i) (i >= first && i < last ? gone : kept).push_back(i);
  const MatrixXd right = H(gone, kept);
  return H(kept, kept) - right.transpose() * H(gone, gone).ldlt().solve(right);
}

TEST(Marginalize, IsTheSchurComplementOfThePlane) {
  for (const bool has_loss : {false, true}) {
    ClosedLoop loop(12, has_loss ? Cauchy(1) : Loss());
    loop.est.fix(loop.poses[0]);
    ASSERT_TRUE(loop.est.optimize().converged);
    loop.est.free(loop.poses[0]);
    const auto jacobian = [&] {
      auto solver = std::make_unique<DenseQR>();
      DenseQR* const dense = solver.get();
      loop.est.changeSolver(std::move(solver));
      try {
        loop.est.optimizeStep();
      } catch (const mtk::Error&) {  // the gauge is free
      }
      return dense->jacobian();
    };
    const MatrixXd before = jacobian();
    const MatrixXd expected = schurComplement(before.transpose() * before, 3 * 4, 3 * 5);
    const std::vector<AnyVarID> gone(loop.poses.begin() + 4, loop.poses.begin() + 9);
    const auto priors = loop.est.marginalize(gone);
    EXPECT_EQ(priors.size(), 1u);
    const MatrixXd after = jacobian();
    ASSERT_EQ(after.cols(), expected.cols());
    EXPECT_LT((after.transpose() * after - expected).norm(), 1e-8 * expected.norm());
    EXPECT_EQ(diagnose(loop.est).rank, 3 * 7 - 3);  // as before: the plane's three motions are free
  }
}

TEST(Marginalize, LeavesNothingOfWhatSharesNothing) {
  Estimator est;
  const auto a = est.insertRV(1.0, "a"), b = est.insertRV(2.0, "b");
  est.prior(a, 0.0, 1.);
  est.prior(b, 3.0, 1.);
  EXPECT_TRUE(est.marginalize({a, a}).empty());
  EXPECT_FALSE(a.isValid());
  EXPECT_EQ(est.getM(), 1);
  EXPECT_TRUE(est.marginalize({}).empty());
  const auto c = est.insertRV(5.0);  // without measurements
  EXPECT_TRUE(est.marginalize({c}).empty());
  // One that is seen by a difference alone says nothing of the other.
  const auto d = est.insertRV(5.0);
  est.insertMeasurement([](const auto& x, const auto& y) { return x - y; }, b, d, measured(1.0));
  EXPECT_TRUE(est.marginalize({d}).empty());
  EXPECT_EQ(est.getM(), 1);
  ASSERT_TRUE(est.optimize().converged);
  EXPECT_EQ(*b, 3.0);
}

TEST(Marginalize, TakesVariablesOfSeveralTypes) {
  Estimator est;
  const auto pose = est.insertRV(Pose({0, 0}, mtk::SO2<>(0.1))),
             old_pose = est.insertRV(Pose({1, 0}, mtk::SO2<>(0.2)));
  const auto landmark = est.insertRV(mtk::vect<2>(3, 1)), old_landmark = est.insertRV(mtk::vect<2>(2, 1));
  est.fix(pose);
  const auto see = [&](const auto& from, const auto& what, const mtk::vect<2>& datum) {
    est.insertMeasurement([](const auto& p, const auto& l) { return p.inverse() * l; }, from, what,
                          measured(datum), StandardDeviation(0.1));
  };
  est.insertMeasurement(RelativePose(), pose, old_pose, measured(Pose({1, 0.1}, mtk::SO2<>(0.1))),
                        StandardDeviation(0.05));
  see(pose, old_landmark, {2.1, 0.9});
  see(old_pose, old_landmark, {1.1, 0.8});
  see(old_pose, landmark, {2.2, 0.6});
  see(pose, landmark, {3, 0.8});
  ASSERT_TRUE(est.optimize().converged);
  const mtk::vect<2> value = *landmark;
  const MatrixXd C = est.covariance(landmark);
  est.marginalize({old_pose, old_landmark});
  ASSERT_TRUE(est.optimize().converged);
  EXPECT_LT((*landmark - value).norm(), 1e-6);
  EXPECT_LT((est.covariance(landmark) - C).norm(), 1e-9 * C.norm());
  EXPECT_EQ(est.getM(), 4);
}

TEST(Marginalize, KnowsWhatIsFixed) {
  Estimator est;
  const auto known = est.insertRV(2.0, false), a = est.insertRV(0.0);
  const auto b = est.insertRV(mtk::vect<2>(0, 7));
  est.fix(b, "y");
  est.insertMeasurement([](const auto& x, const auto& y) { return x * y; }, known, a, measured(6.0),
                        StandardDeviation(0.5));
  est.insertMeasurement([](const auto& x, const auto& y) { return x + y[0] + y[1]; }, a, b, measured(12.0),
                        StandardDeviation(0.25));
  est.insertMeasurement([](const auto& x, const auto& y) { return x + y[0]; }, known, b, measured(5.0));
  const auto priors = est.marginalize({known, a});
  EXPECT_EQ(priors.size(), 1u);
  ASSERT_TRUE(est.optimize().converged);
  // a = 3 +- 0.25; b_0 = 12 - 7 - 3 = 2, of variance 1/8, and 3 +- 1.
  EXPECT_NEAR((*b)[0], (2 * 8 + 3) / 9., 1e-12);
  EXPECT_EQ((*b)[1], 7);
  EXPECT_NEAR(est.covariance(b)(0, 0), 1 / 9., 1e-12);
}

TEST(Marginalize, PriorsAreMeasurementsAsOthersAre) {
  ClosedLoop loop(12);
  loop.est.fix(loop.poses[0]);
  ASSERT_TRUE(loop.est.optimize().converged);
  const MatrixXd C = loop.est.covariance(loop.poses[2]);
  const auto priors = loop.est.marginalize({loop.poses[5], loop.poses[9]});
  ASSERT_FALSE(priors.empty());
  const Summary again = loop.est.optimize();
  EXPECT_TRUE(again.converged);
  EXPECT_LT((loop.est.covariance(loop.poses[2]) - C).norm(), 1e-8 * C.norm());
  const int residuals = loop.est.getM();
  loop.est.removeMeasurement(priors[0]);
  EXPECT_LT(loop.est.getM(), residuals);
  EXPECT_EQ(
      messageOf([&] { loop.est.covariance(loop.poses[5]); }),
      "[slom.stale-handle] the VarID<trafo<SO2>> refers to a variable that has been removed; keep the VarID that insertRV "
      "returned last");
}

TEST(Marginalize, ChangesNothingWhereItCannotBe) {
  Estimator est, other;
  const auto a = est.insertRV(1.0, "a"), b = est.insertRV(2.0, "b");
  const auto foreign = other.insertRV(1.0);
  est.insertMeasurement([](const auto& x, const auto& y) { return x / (y - 2); }, a, b, measured(1.0));
  EXPECT_EQ(messageOf([&] { est.marginalize({a}); }).substr(0, 17), "[slom.not-finite]");
  EXPECT_EQ(
      messageOf([&] {
        est.marginalize({a, foreign});
      }),
      "[slom.foreign-handle] the VarID<double> belongs to another estimator; use it only with the estimator whose "
      "insertRV returned it");
  EXPECT_TRUE(a.isValid());
  EXPECT_EQ(est.getM(), 1);
  VarID<double> none;
  EXPECT_EQ(messageOf([&] { est.marginalize({none}); }).substr(0, 19), "[slom.stale-handle]");
  est.reinitRV(b, 1.0);
  est.marginalize({a});
  EXPECT_EQ(messageOf([&] { est.marginalize({a}); }).substr(0, 19), "[slom.stale-handle]");
}

TEST(Marginalize, TakesALongChainAtOnce) {
  constexpr int n = 100000;
  Estimator est;
  std::vector<VarID<double>> x;
  for (int i = 0; i < n; ++i) x.push_back(est.insertRV(double(i)));
  for (int i = 0; i + 1 < n; ++i) {
    est.insertMeasurement([](const auto& p, const auto& q) { return q - p; }, x[std::size_t(i)],
                          x[std::size_t(i + 1)], measured(1.5), StandardDeviation(0.1));
  }
  const std::vector<AnyVarID> middle(x.begin() + 1, x.end() - 1);
  const auto priors = est.marginalize(middle);
  ASSERT_EQ(priors.size(), 1u);
  est.fix(x.front());
  ASSERT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*x.back(), 1.5 * (n - 1), 1e-6);
  EXPECT_NEAR(est.standardDeviation(x.back())[0], 0.1 * std::sqrt(n - 1.), 1e-9);
}

/// A window over a chain of equal poses, as of a robot at rest: the rank does not change.
TEST(Marginalize, WindowOfARobotThatStandsStill) {
  Estimator est;
  std::vector<VarID<Pose>> window{est.insertRV(Pose())};
  for (int step = 0; step < 300; ++step) {
    window.push_back(est.insertRV(Pose()));
    est.insertMeasurement(RelativePose(), window[window.size() - 2], window.back(), measured(Pose()),
                          StandardDeviation(0.1));
    if (window.size() > 3) {
      est.insertMeasurement(RelativePose(), window[window.size() - 4], window.back(), measured(Pose()),
                            StandardDeviation(0.2));
    }
    est.setFreeGauge(FreeGauge::inner_constraints);
    if (window.size() > 8) {
      est.marginalize({window.front()});
      window.erase(window.begin());
    }
    const Diagnosis diagnosis = diagnose(est);
    ASSERT_EQ(diagnosis.rank, 3 * int(window.size()) - 3) << step;
  }
}

}  // namespace
}  // namespace slom
