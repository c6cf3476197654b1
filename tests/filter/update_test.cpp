// The update of a filter against the estimator: one step is one Gauss-Newton step with a prior, an iterated update is the
// fit.
#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <slom/analyze/chi_square.hpp>
#include <slom/filter.hpp>
#include <slom/slom.hpp>

#include "random_matrices.hpp"
#include "support/fresh_seed.hpp"

namespace slom::testing {

using Pose = mtk::trafo<mtk::SO3<>>;
using Vec3 = mtk::vect<3>;

/// Two points of the world seen from a pose: a residual of 6 numbers that determines the pose up to one rotation.
struct TwoPoints {
  auto operator()(const auto& pose, const Vec3& a, const Vec3& b, const mtk::vect<6>& seen) const {
    const auto back = pose.orient.inverse();
    const auto p = back * (a - pose.pos), q = back * (b - pose.pos);
    return mtk::vector(p[0] - seen[0], p[1] - seen[1], p[2] - seen[2], q[0] - seen[3], q[1] - seen[4],
                       q[2] - seen[5]);
  }
};

struct PoseUpdate : ::testing::Test {
  PoseUpdate() : random(freshSeed()) {
    mean = Pose(mtk::SO3<>::exp(random.vector<3>()), random.vector<3>());
    P = random.covariance<6>(0.2);
    R = random.covariance<6>(0.1);
    const mtk::vect<6> d = random.sample<6>(P);
    const Pose truth = mtk::moved<Pose>(mean, d);
    a = random.vector<3>(2);
    b = random.vector<3>(2);
    seen = TwoPoints()(truth, a, b, random.sample<6>(R));
    prior = est.insertRV(mean);
    est.insertMeasurement(Prior(), prior, measured(mean), Covariance(P));
  }
  RandomMatrices random;
  Pose mean;
  Eigen::Matrix<double, 6, 6> P, R;
  Vec3 a, b;
  mtk::vect<6> seen;
  Estimator est;
  VarID<Pose> prior;
};

template <class Filter>
void expectOneStep(Filter filter, PoseUpdate& t) {
  t.est.reinitRV(t.prior, t.mean);
  t.est.changeAlgorithm(new GaussNewton);
  t.est.optimizeStep();
  ASSERT_TRUE(filter.update(TwoPoints(), t.a, t.b, t.seen, Covariance(t.R)));
  EXPECT_LT(mtk::difference(filter.state(), *t.prior).norm(), 1e-11);
}

TEST_F(PoseUpdate, IsOneGaussNewtonStepWithAPrior) {
  est.insertMeasurement(TwoPoints(), prior, a, b, seen, Covariance(R));
  expectOneStep(ErrorStateFilter(mean, Covariance(P)), *this);
  expectOneStep(ErrorStateFilter(mean, Covariance(P), square_root), *this);
}

template <class Filter, class... Options>
void expectFit(Filter filter, PoseUpdate& t, const Options&... options) {
  const auto update =
      filter.update(TwoPoints(), t.a, t.b, t.seen, Covariance(t.R), Iterations(100), options...);
  ASSERT_TRUE(update);
  EXPECT_LT(mtk::difference(filter.state(), *t.prior).norm(), 1e-7);
  if constexpr (sizeof...(options) == 0) {
    const Eigen::MatrixXd C = t.est.covariance(t.prior);
    EXPECT_LT((filter.covariance() - C).norm(), 1e-6 * C.norm());
  }
}

TEST_F(PoseUpdate, IteratedIsTheFit) {
  est.insertMeasurement(TwoPoints(), prior, a, b, seen, Covariance(R));
  ASSERT_TRUE(est.optimize().converged);
  expectFit(ErrorStateFilter(mean, Covariance(P)), *this);
  expectFit(ErrorStateFilter(mean, Covariance(P), square_root), *this);
}

TEST_F(PoseUpdate, WithALossIsTheFitWithTheLoss) {
  seen[0] += 0.5;  // an outlier of some standard deviations
  est.insertMeasurement(TwoPoints(), prior, a, b, seen, Covariance(R), Huber(1.345));
  ASSERT_TRUE(est.optimize().converged);
  expectFit(ErrorStateFilter(mean, Covariance(P)), *this, Huber(1.345));
  expectFit(ErrorStateFilter(mean, Covariance(P), square_root), *this, Huber(1.345));
}

TEST_F(PoseUpdate, OfADatumOnAManifoldIsThatOfItsDifference) {
  const mtk::SO3<> z = mtk::moved<mtk::SO3<>>(mean.orient, random.vector<3>(0.3));
  ErrorStateFilter by_datum(mean, Covariance(P)), by_residual = by_datum;
  const auto orientation = [](const auto& x) { return x.orient; };
  ASSERT_TRUE(by_datum.update(orientation, measured(z), StandardDeviation(0.1)));
  ASSERT_TRUE(by_residual.update(
      [&](const auto& x) {
        const auto from_z = z.inverse() * x.orient;
        return decltype(z.inverse() * x.orient)::log(from_z);
      },
      StandardDeviation(0.1)));
  EXPECT_LT(mtk::difference(by_datum.state(), by_residual.state()).norm(), 1e-13);
  EXPECT_LT((by_datum.covariance() - by_residual.covariance()).norm(), 1e-13);
}

TEST_F(PoseUpdate, OfAPlainStructHasExtrapolatedDerivatives) {
  struct Plain {  // no template: its functions take doubles
    Pose pose;
    double scale;
  };
  Eigen::Matrix<double, 7, 7> P0 = Eigen::Matrix<double, 7, 7>::Identity();
  P0.topLeftCorner<6, 6>() = P;
  ErrorStateFilter plain(Plain{mean, 1}, Covariance(P0));
  ErrorStateFilter exact(mean, Covariance(P));
  ASSERT_TRUE(
      plain.update([&](const Plain& x) { return TwoPoints()(x.pose, a, b, seen).eval(); }, Covariance(R)));
  ASSERT_TRUE(exact.update(TwoPoints(), a, b, seen, Covariance(R)));
  EXPECT_LT(mtk::difference(plain.state().pose, exact.state()).norm(), 1e-8);
  EXPECT_LT((plain.covariance().topLeftCorner<6, 6>() - exact.covariance()).norm(), 1e-8);
}

TEST_F(PoseUpdate, GateRejectsByChiSquare) {
  ErrorStateFilter filter(mean, Covariance(P));
  auto other = filter;
  const auto place = [](const auto& x) { return x.pos; };
  const auto reading = measured(Vec3(mean.pos + Vec3(0.5, 0, 0)));
  const auto update = other.update(place, reading, StandardDeviation(0.3));
  const double p = chiSquareProbability(update.nis, 3);
  const auto rejected = filter.update(place, reading, StandardDeviation(0.3), Gate(0.99 * (1 - p)));
  EXPECT_EQ(rejected.status, FilterStatus::gated);
  EXPECT_EQ(rejected.nis, update.nis);
  EXPECT_EQ(filter.covariance(), ErrorStateFilter(mean, Covariance(P)).covariance());
  EXPECT_TRUE(filter.update(place, reading, StandardDeviation(0.3), Gate(1 - 0.99 * p)));
}

using Vec2 = mtk::vect<2>;

/// The cost of a position: distances to the prior mean, and the residual of a measurement.
template <class H>
double costOf(const Vec2& x, const Vec2& mean, double sigma, const H& h, double residual_sigma) {
  return (x - mean).squaredNorm() / (sigma * sigma) + std::pow(h(x) / residual_sigma, 2);
}

/// Updates by an accurate measurement around a wide prior; returns how many updates converged.
template <class H>
int expectNoWorseThanOneStep(RandomMatrices& random, const H& measurement, double sigma,
                             double residual_sigma) {
  int converged = 0;
  for (int run = 0; run < 300; ++run) {
    const Vec2 mean(random.vector<2>(2)), truth(mean + random.vector<2>(sigma));
    const auto h = measurement(truth);
    const ErrorStateFilter start(mean, StandardDeviation(sigma));
    auto once = start, iterated = start;
    EXPECT_TRUE(once.update(h, StandardDeviation(residual_sigma)));
    const auto result = iterated.update(h, StandardDeviation(residual_sigma), Iterations(50));
    EXPECT_TRUE(result);
    const auto cost = [&](const Vec2& x) { return costOf(x, mean, sigma, h, residual_sigma); };
    const double least = cost(iterated.state());
    EXPECT_LE(least, cost(once.state()) * (1 + 1e-9)) << run;
    EXPECT_LE(least, cost(mean) * (1 + 1e-9)) << run;
    if (!result.converged) {
      EXPECT_NE(std::string(result.message()).find("did not converge"), std::string::npos);
      continue;
    }
    ++converged;
    for (const Vec2& d : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)}) {  // a minimum
      EXPECT_GE(cost(Vec2(iterated.state() + 0.03 * residual_sigma * d)), least * (1 - 1e-9)) << run;
    }
  }
  return converged;
}

TEST(IteratedUpdate, OfARangeNearItsBeaconIsNoWorseThanOneStep) {
  RandomMatrices random(freshSeed());
  const auto range = [](const Vec2& truth) {
    return [z = truth.norm()](const auto& x) { return x.norm() - z; };
  };
  EXPECT_GE(expectNoWorseThanOneStep(random, range, 3, 0.05), 290);
}

TEST(IteratedUpdate, OfABearingNearItsBeaconIsNoWorseThanOneStep) {
  RandomMatrices random(freshSeed());
  const auto bearing = [](const Vec2& truth) {
    return [z = Vec2(truth / truth.norm())](const auto& x) {  // the angle, without a jump
      using std::atan2;
      return atan2(x[1] * z[0] - x[0] * z[1], x[0] * z[0] + x[1] * z[1]);
    };
  };
  EXPECT_GE(expectNoWorseThanOneStep(random, bearing, 1, 0.01), 250);
}

TEST(IteratedUpdate, SaysThatItDidNotConverge) {
  ErrorStateFilter filter(Vec2(0.5, 0), StandardDeviation(1));
  const auto bearing = [](const auto& x, double z) {
    using std::atan2;
    return atan2(x[1], x[0]) - z;
  };
  const auto update = filter.update(bearing, 2., StandardDeviation(1e-3), Iterations(2));
  EXPECT_TRUE(update);  // it was used
  EXPECT_FALSE(update.converged);
  EXPECT_STREQ(
      update.message(),
      "the measurement was used, but its iterated update did not converge; allow more iterations, and check that the "
      "state is known well enough for this measurement");
  EXPECT_TRUE(filter.update(bearing, 2., StandardDeviation(1e-3)).converged);  // not iterated
}

TEST(ChiSquareTail, IsTheDistribution) {
  for (int dof = 1; dof < 30; ++dof) {
    for (const double x : {1e-8, 0.1, 1.0, 3.7, 20.0, 100.0}) {
      const double p = chiSquareProbability(x, dof);
      EXPECT_NEAR(detail::chiSquareTail(x, dof), p, 1e-12 + 1e-9 * p) << x << ' ' << dof;
    }
  }
}

}  // namespace slom::testing
