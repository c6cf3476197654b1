// The estimator's tables: handles, removal, fixing, residuals, statistics, threads.
// Pages show code of this file as it stands.
// clang-format off
#include <slom/slom.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;

using Eigen::MatrixXd;
using Eigen::VectorXd;

typedef mtk::vect<2> vec2;
typedef mtk::vect<3> vec3;
typedef mtk::trafo<mtk::SO2<>> SE2;

SLOM_BUILD_MEASUREMENT(Odometry, 3, ((SE2, a)) ((SE2, b)), ((SE2, z)))
SLOM_IMPLEMENT_MEASUREMENT(Odometry, ret) { ret = mtk::difference(a->inverse() * *b, z); }

SLOM_BUILD_MEASUREMENT(Origin, 3, ((SE2, pose)), )
SLOM_IMPLEMENT_MEASUREMENT(Origin, ret) { ret << pose->pos, pose->orient.angle(); }

SLOM_BUILD_MEASUREMENT(Forgetful, 2, ((vec2, x)), )
SLOM_IMPLEMENT_MEASUREMENT(Forgetful, ret) { ret[0] = (*x)[0]; }

SLOM_BUILD_MEASUREMENT(Samples, slom::Dynamic, ((vec2, line)), ((VectorXd, y)))
SLOM_IMPLEMENT_MEASUREMENT(Samples, ret) {
  ret.resize(y.size());
  for (int i = 0; i < ret.size(); ++i) ret[i] = (*line)[0] + (*line)[1] * i - y[i];
}

TEST(Table, SaysWhatHasChangedAndMoved) {
  slom::Estimator est;
  const auto a = est.insertRV(vec2(1, 2), "a");
  const slom::Problem& table = est.table();
  const auto structure = table.structureRevision(), values = table.valueRevision();
  const auto b = est.insertRV(vec2(3, 4), "b");
  est.reinitRV(a, vec2(1, 5));
  ASSERT_EQ(table.changesSince(structure)->size(), 1u);
  EXPECT_EQ(table.changesSince(structure)->front().kind, slom::Change::Kind::variable_inserted);
  EXPECT_EQ(table.changesSince(structure)->front().index, table.indexOf(b));
  ASSERT_TRUE(table.movedSince(values));
  EXPECT_EQ(table.movedSince(values)->back(), table.indexOf(a));
  EXPECT_EQ(table.travelled(table.indexOf(a)), 3);
}

TEST(Handles, StayValidWhateverIsInsertedAndRemoved) {
  slom::Estimator est;
  std::mt19937 rng(3);
  std::vector<std::pair<slom::VarID<vec2>, vec2>> live;
  std::vector<slom::VarID<vec2>> dead;
  const vec2* first_address = nullptr;
  for (int round = 0; round < 3000; ++round) {
    if (live.empty() || rng() % 5 < 3) {
      const vec2 value(round, -round);
      live.emplace_back(est.insertRV(value), value);
      if (round == 0) first_address = &*live[0].first;
    } else if (live.size() > 1) {
      const std::size_t i = 1 + rng() % (live.size() - 1);
      est.removeRV(live[i].first);
      dead.push_back(live[i].first);
      live.erase(live.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  for (const auto& [id, value] : live) EXPECT_EQ(*id, value);
  EXPECT_EQ(&*live[0].first, first_address) << "values do not move";
  EXPECT_EQ(est.getN(), static_cast<int>(2 * live.size()));
  for (const auto& id : dead) {
    EXPECT_FALSE(id.isValid());
    EXPECT_THROW(*id, mtk::Error);
  }
}

TEST(Handles, MisuseIsNamed) {
  slom::Estimator est, other;
  const auto id = est.insertRV(vec2(1, 2));
  const auto foreign = other.insertRV(vec2());
  const auto m = est.insertMeasurement([](const vec2& v) { return v; }, id);
  const slom::VarID<vec2> none;
  EXPECT_EQ(messageOf([&] { *none; }),
            "[slom.stale-handle] the VarID<vect<2>> refers to no variable; assign it the result of insertRV first");
  EXPECT_EQ(messageOf([&] { est.optimizeRV(foreign, false); }),
            "[slom.foreign-handle] the VarID<vect<2>> belongs to another estimator; use it only with the estimator whose "
            "insertRV returned it");
  EXPECT_EQ(messageOf([&] { est.insertMeasurement([](const vec2& v) { return v; }, foreign); }),
            "[slom.foreign-handle] the VarID<vect<2>> belongs to another estimator; use it only with the estimator whose "
            "insertRV returned it");
  EXPECT_EQ(messageOf([&] { est.removeRV(id); }),
            "[slom.variable-in-use] variable vect<2> #1 cannot be removed: 1 measurement depends on it; remove it first");
  est.insertMeasurement([](const vec2& v) { return v; }, id);
  EXPECT_EQ(messageOf([&] { est.removeRV(id); }),
            "[slom.variable-in-use] variable vect<2> #1 cannot be removed: 2 measurements depend on it; remove them first");
  est.removeMeasurement(m);
  EXPECT_EQ(messageOf([&] { est.removeMeasurement(m); }),
            "[slom.stale-handle] the MeasID<lambda> refers to a measurement that has been removed; keep the MeasID that "
            "insertMeasurement returned last");
  EXPECT_EQ(messageOf([&] { est.getRSS(decltype(m)()); }),
            "[slom.stale-handle] the MeasID refers to no measurement; assign it the result of insertMeasurement");
  EXPECT_EQ(messageOf([&] { other.residual(m); }),
            "[slom.foreign-handle] the MeasID belongs to another estimator; use it only with the estimator whose "
            "insertMeasurement returned it");
  const auto gone = est.insertRV(vec2());
  est.removeRV(gone);
  EXPECT_EQ(messageOf([&] { *gone; }),
            "[slom.stale-handle] the VarID<vect<2>> refers to a variable that has been removed; keep the VarID that insertRV "
            "returned last");
  EXPECT_EQ(messageOf([&] { est.reinitRV(gone, vec2()); }),
            "[slom.stale-handle] the VarID<vect<2>> refers to a variable that has been removed; keep the VarID that insertRV "
            "returned last");
  const auto dynamic = est.insertRV(VectorXd(VectorXd::Zero(3)), "coefficients");
  EXPECT_EQ(messageOf([&] { est.reinitRV(dynamic, VectorXd(VectorXd::Zero(2))); }),
            "[slom.size-change] variable coefficients has 3 degrees of freedom, the new value has 2; insert a new variable "
            "instead");
}

TEST(Handles, OutliveTheEstimator) {
  slom::VarID<vec2> id;
  {
    slom::Estimator est;
    id = est.insertRV(vec2(3, 4));
  }
  EXPECT_EQ(*id, vec2(3, 4));
  slom::Estimator a;
  id = a.insertRV(vec2(5, 6));
  slom::Estimator b = std::move(a);
  b.insertMeasurement([](const vec2& v) { return v; }, id);
  EXPECT_EQ(b.getRSS(), 61);
}

TEST(Estimator, AcceptsAnyManifoldAsAVariable) {
  struct Plain {
    vec2 p;
    double q;
  };
  slom::Estimator est;
  const auto number = est.insertRV(2, "number");  // an integer becomes a double
  static_assert(std::is_same_v<decltype(number), const slom::VarID<double>>);
  const auto expression = est.insertRV(vec3::UnitZ() * 2.0);
  static_assert(std::is_same_v<decltype(expression), const slom::VarID<Eigen::Vector3d>>);
  const auto plain = est.insertRV(Plain{vec2(1, 2), 3}, true, "plain");
  EXPECT_EQ(est.nameOf(number), "number");
  EXPECT_EQ(est.nameOf(plain), "plain");
  EXPECT_EQ(est.nameOf(est.insertRV(SE2())), "trafo<SO2> #4");
#if MTK_HAS_MEMBER_NAMES
  EXPECT_EQ(est.componentNames(plain), (std::vector<std::string>{"plain.p.x", "plain.p.y", "plain.q"}));
#endif
  est.insertMeasurement([](const Plain& x, double y) { return Eigen::Vector4d(x.p[0], x.p[1], x.q - y, y); }, plain, number);
  EXPECT_TRUE(est.getN() == 1 + 3 + 3 + 3);
}

TEST(Estimator, CallsEverythingCallable) {
  struct Functor {
    double offset;
    double operator()(double x) const { return x - offset; }
    double member(double x, double y) const { return x + y - offset; }
  };
  slom::Estimator est;
  const auto x = est.insertRV(1.0), y = est.insertRV(2.0);
  const double captured = 5;
  const auto a = est.insertMeasurement(Functor{3}, x);
  const auto b = est.insertMeasurement([captured](double u, double v) { return std::array<double, 2>{u, v - captured}; }, x, y);
  const auto c = est.insertMeasurement(&Functor::member, Functor{10}, x, y, slom::StandardDeviation(2));
  EXPECT_EQ(est.residual(a)[0], -2);
  EXPECT_EQ(est.residual(b), Eigen::Vector2d(1, -3));
  EXPECT_EQ(est.residual(c)[0], -7);
  EXPECT_EQ(est.whitenedResidual(c)[0], -3.5);
  EXPECT_EQ(est.getRSS(c), 12.25);
  std::vector<std::string> names;
  for (const auto& group : est.optimize().groups) names.push_back(group.name);
  EXPECT_EQ(names, (std::vector<std::string>{"Functor", "lambda", "function"}));
  est.reinitRV(x, 1.0);
  est.reinitRV(y, 2.0);
  EXPECT_EQ(est.residuals(), (VectorXd(4) << -2, 1, -3, -3.5).finished());
}

TEST(Estimator, FormsTheResidualOfAMeasuredManifoldValue) {
  slom::Estimator est;
  const SE2 a(mtk::SO2<>(3), vec2(1, 2)), b(mtk::SO2<>(-3), vec2(2, 1)), z(mtk::SO2<>(0.2), vec2(0.1, 0.2));
  const auto ida = est.insertRV(a), idb = est.insertRV(b);
  const auto m = est.insertMeasurement([](const SE2& p, const SE2& q) { return p.inverse() * q; }, ida, idb, slom::measured(z),
                                       slom::StandardDeviation(0.5));
  EXPECT_LT((est.residual(m) - mtk::difference(a.inverse() * b, z)).norm(), 1e-15);
}

/// Poses on a circle, odometry around it, the first pose fixed.
struct Loop {
  slom::Estimator est;
  std::vector<slom::VarID<SE2>> poses;
  std::vector<slom::MeasID<Odometry>> steps;
  explicit Loop(int n, unsigned seed = 1) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> noise(0, 0.05);
    const SE2 step(mtk::SO2<>(2 * M_PI / n), vec2(1, 0));
    SE2 pose;
    for (int i = 0; i < n; ++i) {
      poses.push_back(est.insertRV(pose, i > 0, "pose" + std::to_string(i)));
      pose = pose * mtk::moved(step, vec3(noise(rng), noise(rng), noise(rng)));
    }
    for (int i = 0; i < n; ++i) {
      const SE2 z = mtk::moved(step, vec3(noise(rng), noise(rng), noise(rng)));
      steps.push_back(est.insertMeasurement(Odometry(poses[i], poses[(i + 1) % n], z), slom::StandardDeviation(0.05)));
    }
  }
};

TEST(Estimator, TakesTheRssApart) {
  Loop loop(20);
  loop.est.insertMeasurement(Origin(loop.poses[3]), slom::Covariance(4));
  const double all = loop.est.getRSS();
  double sum = 0;
  for (const auto& m : loop.steps) sum += loop.est.getRSS(m);
  EXPECT_NEAR(loop.est.getRSS<Odometry>(), sum, 1e-10 * sum);
  EXPECT_NEAR(loop.est.getRSS<Odometry>() + loop.est.getRSS<Origin>(), all, 1e-12 * all);
  EXPECT_EQ(loop.est.getRSS<Samples>(), 0);
  EXPECT_NEAR(loop.est.getRSS(loop.poses[3]),
              loop.est.getRSS(loop.steps[2]) + loop.est.getRSS(loop.steps[3]) + loop.est.getRSS<Origin>(), 1e-10 * all);
  EXPECT_NEAR(loop.est.residuals().squaredNorm(), all, 1e-10 * all);
  EXPECT_EQ(loop.est.getM(), 63);
  EXPECT_EQ(loop.est.getN(), 57);
  EXPECT_NEAR(loop.est.getRMS(), std::sqrt(all / 63), 1e-12);
  const slom::Summary summary = loop.est.optimize();
  ASSERT_EQ(summary.groups.size(), 2u);
  EXPECT_EQ(summary.groups[0].name, "Odometry");
  EXPECT_EQ(summary.groups[0].measurements, 20);
  EXPECT_EQ(summary.groups[1].residuals, 3);
  EXPECT_NEAR(summary.groups[0].initial_rss + summary.groups[1].initial_rss, all, 1e-10 * all);
  EXPECT_NEAR(summary.groups[0].final_rss + summary.groups[1].final_rss, summary.final_rss, 1e-10 * all);
  EXPECT_NEAR(summary.chi2PerDof(), summary.final_rss / 6, 1e-12);
}

TEST(Estimator, RemovingAndFixingEqualsNeverHavingInserted) {
  Loop changed(15), plain(15);
  changed.est.optimize();
  // A detour: more poses and measurements, then away with them in odd order.
  std::vector<slom::VarID<SE2>> extra;
  std::vector<slom::MeasID<Odometry>> more;
  for (int i = 0; i < 100; ++i) {
    extra.push_back(changed.est.insertRV(SE2()));
    more.push_back(changed.est.insertMeasurement(Odometry(changed.poses[2], extra.back(), SE2(vec2(i, 0))),
                                                 slom::StandardDeviation(vec3(1 + i, 1, 2))));
  }
  changed.est.optimizeStep();
  for (int i = 0; i < 100; ++i) changed.est.removeMeasurement(more[(i * 37) % 100]);
  for (int i = 0; i < 100; ++i) changed.est.removeRV(extra[(i * 61) % 100]);
  changed.est.optimizeRV(changed.poses[5], false);
  changed.est.reinitRV(changed.poses[5], *plain.poses[5]);
  plain.est.optimizeRV(plain.poses[5], false);
  EXPECT_EQ(changed.est.getN(), plain.est.getN());
  EXPECT_EQ(changed.est.getM(), plain.est.getM());
  changed.est.optimize();
  plain.est.optimize();
  EXPECT_NEAR(changed.est.getRSS(), plain.est.getRSS(), 1e-9 * plain.est.getRSS());
  for (int i = 0; i < 15; ++i) EXPECT_LT(mtk::difference(*changed.poses[i], *plain.poses[i]).norm(), 1e-7);
  for (int i = 0; i < 15; ++i) EXPECT_NEAR(changed.est.getRSS(changed.steps[i]), plain.est.getRSS(plain.steps[i]), 1e-6);
  EXPECT_EQ(mtk::difference(*changed.poses[5], *plain.poses[5]).norm(), 0);
}

TEST(Estimator, GivesTheSameBitsOnAnyNumberOfThreads) {
  std::vector<double> rss;
  std::vector<SE2> values;
  for (const int threads : {1, 2, 5}) {
    Loop loop(1000);
    for (const int i : {10, 500, 990}) loop.est.fix(loop.poses[i], "orient");
    loop.est.bound(loop.poses[700], "pos.x", -1e3, (*loop.poses[700]).pos[0]);
    loop.est.setThreads(threads);
    rss.push_back(loop.est.optimize().final_rss);
    values.push_back(*loop.poses[321]);
  }
  for (std::size_t i = 1; i < rss.size(); ++i) {
    EXPECT_EQ(rss[i], rss[0]);
    EXPECT_EQ(values[i].pos, values[0].pos);
    EXPECT_EQ(values[i].orient.angle(), values[0].orient.angle());
  }
}

TEST(Estimator, AgreesWithDenseQrInValuesAndCovariances) {
  Loop sparse(40, 7), dense(40, 7);
  dense.est.changeSolver(std::make_unique<slom::DenseQR>());
  const slom::Summary a = sparse.est.optimize(), b = dense.est.optimize();
  EXPECT_NEAR(a.final_rss, b.final_rss, 1e-10 * b.final_rss);
  for (int i = 0; i < 40; i += 13) {
    EXPECT_LT(mtk::difference(*sparse.poses[i], *dense.poses[i]).norm(), 1e-7);
    const MatrixXd P = sparse.est.covariance(sparse.poses[i]), Q = dense.est.covariance(dense.poses[i]);
    EXPECT_LE((P - Q).norm(), 1e-6 * Q.norm());
    EXPECT_LE((sparse.est.standardDeviation(sparse.poses[i]) - Q.diagonal().cwiseSqrt()).norm(), 1e-6 * Q.norm() + 1e-12);
  }
  EXPECT_LT((sparse.est.covariance(sparse.poses[3], sparse.poses[9]) - dense.est.covariance(dense.poses[3], dense.poses[9])).norm(),
            1e-6);
  EXPECT_EQ(sparse.est.covariance(sparse.poses[0]), MatrixXd(MatrixXd::Zero(3, 3))) << "a fixed variable is certain";
  EXPECT_EQ(sparse.est.covariance(sparse.poses[0], sparse.poses[4]), MatrixXd(MatrixXd::Zero(3, 3)));
}

TEST(Estimator, StandardDeviationsAreThoseOfResimulatedFits) {
  // A line fitted to 20 points, 2000 times: the scatter of the estimates is what the estimator says.
  std::mt19937 rng(8);
  std::normal_distribution<double> noise(0, 0.3);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
  const int n = 2000;
  VectorXd stated;
  for (int k = 0; k < n; ++k) {
    slom::Estimator est;
    const auto line = est.insertRV(vec2());
    VectorXd y(20);
    for (int i = 0; i < 20; ++i) y[i] = 1 + 2 * i + noise(rng);
    est.insertMeasurement(Samples(line, y), slom::StandardDeviation(0.3));
    est.optimizeStep();
    stated = est.standardDeviation(line);
    const Eigen::Vector2d z = (*line - vec2(1, 2)).cwiseQuotient(stated);
    sum += z;
    squares += z.cwiseAbs2();
  }
  // Mean of z within 5/sqrt(n) of 0, mean square within 5 sqrt(2/n) of 1.
  EXPECT_LT((sum / n).cwiseAbs().maxCoeff(), 5 / std::sqrt(n));
  EXPECT_LT((squares / n - Eigen::Vector2d::Ones()).cwiseAbs().maxCoeff(), 5 * std::sqrt(2.0 / n));
}

TEST(Residuals, OfRunTimeLengthMayDifferFromMeasurementToMeasurement) {
  slom::Estimator est;
  const auto line = est.insertRV(vec2(0, 0));
  std::vector<slom::MeasID<Samples>> ids;
  for (int n = 0; n < 5; ++n) ids.push_back(est.insertMeasurement(Samples(line, VectorXd::LinSpaced(n, 3, 3 + 2.0 * (n - 1)))));
  EXPECT_EQ(est.getM(), 10);
  est.removeMeasurement(ids[1]);
  EXPECT_EQ(est.getM(), 9);
  EXPECT_EQ(est.residual(ids[4]).size(), 4);
  est.optimizeStep();
  EXPECT_LT((*line - vec2(3, 2)).norm(), 1e-9);
  EXPECT_EQ(messageOf([&] { est.insertMeasurement(Samples(line, VectorXd::Zero(3)), slom::Covariance(VectorXd(VectorXd::Ones(2)))); }),
            "[slom.noise-size] covariance of measurement Samples #6 has 2 entries but the residual has 3; pass a number, a "
            "vector of 3, or a 3 x 3 matrix");
  EXPECT_EQ(est.getM(), 9);
}

TEST(Residuals, ThatChangeTheirLengthAreRefused) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement([](double v) -> VectorXd { return VectorXd::Constant(v > 2 ? 3 : 2, v); }, x);
  est.reinitRV(x, 5.0);
  EXPECT_EQ(messageOf([&] { est.optimize(); }),
            "[slom.residual-length] measurement lambda #1 returned a residual of length 3 but had length 2 when it was "
            "inserted; return the same length for all values of the variables");
  EXPECT_EQ(*x, 5);
}

TEST(Residuals, ThatAreForgottenAreFound) {
  slom::Estimator est;
  est.insertMeasurement(Forgetful(est.insertRV(vec2(1, 2), "x")));
  EXPECT_EQ(messageOf([&] { est.optimize(); }),
            "[slom.not-finite] the residual of measurement Forgetful #1 is not finite at x = (1 2); check its data, the "
            "function where it divides, takes roots or logarithms or leaves an entry of its result unset, and the start "
            "values");
}

/// Runs f and rethrows the exception nested in its exception.
template <class F>
void rethrowNested(const F& f) {
  try {
    f();
  } catch (const slom::Error& e) {
    std::rethrow_if_nested(e);
  }
}

TEST(Exceptions, ThatCarryTextAreQuoted) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x"), y = est.insertRV(2.0, "y");
  const auto f = [](double a, double b) -> VectorXd {
    if (a < b) throw std::domain_error("log of a negative number");
    return VectorXd::Zero(2);
  };
  EXPECT_EQ(messageOf([&] { est.insertMeasurement(f, x, y, slom::named("growth")); }),
            "[slom.measurement-threw] the function of measurement growth #1 threw an exception (log of a negative number) "
            "at x = (1), y = (2); let it return NaN if it has no value, and the step is taken back");
  EXPECT_EQ(est.getM(), 0);
  est.reinitRV(x, 3.0);
  const auto id = est.insertMeasurement(f, x, y, slom::named("growth"));
  est.reinitRV(x, 0.0);
  const std::string text =
      "[slom.measurement-threw] the function of measurement growth #1 threw an exception (log of a negative number) at x = "
      "(0), y = (2); let it return NaN if it has no value, and the step is taken back";
  EXPECT_EQ(messageOf([&] { est.getRSS(); }), text);
  EXPECT_EQ(messageOf([&] { est.residual(id); }), text);
  EXPECT_EQ(messageOf([&] { est.residuals(); }), text);
  EXPECT_EQ(messageOf([&] { est.optimize(); }), text);
}

TEST(Exceptions, OfUserCodeLeaveTheEstimatorAsItWas) {
  struct Trouble {};
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  bool armed = false;
  est.insertMeasurement([&armed](double v) {
    if (armed && v != 1.0) throw Trouble();
    return v * v - 2;
  }, x);
  for (const int threads : {1, 2}) {
    est.setThreads(threads);
    armed = true;
    const std::string text =
        "[slom.measurement-threw] the function of measurement lambda #1 threw something that is not a std::exception at x = "
        "(1); let it return NaN if it has no value, and the step is taken back";
    EXPECT_EQ(messageOf([&] { est.optimize(); }), text);
    EXPECT_EQ(messageOf([&] { est.optimizeStep(); }), text);
    EXPECT_THROW(rethrowNested([&] { est.optimize(); }), Trouble);
    EXPECT_EQ(*x, 1);
  }
  armed = false;
  EXPECT_TRUE(est.optimize().converged);
  EXPECT_NEAR(*x, std::sqrt(2.0), 1e-12);
}

TEST(Exceptions, NameTheFirstOfManyMeasurementsOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 5}) {
    slom::Estimator est;
    est.setThreads(threads);
    const auto x = est.insertRV(1.0, "x");
    for (int i = 1; i <= 4000; ++i) {
      est.insertMeasurement([](const auto& v, int number) {
        if (number == 3990 || number == 2345) throw std::domain_error("no value");
        return number == 3000 ? v / 0.0 : v - 1.0;
      }, x, i, slom::named("many"));
    }
    EXPECT_EQ(messageOf([&] { est.optimizeStep(); }),
              "[slom.measurement-threw] the function of measurement many #2345 threw an exception (no value) "
              "at x = (1); let it return NaN if it has no value, and the step is taken back");
  }
}

TEST(Progress, IsSilentUnlessAskedAndThenATable) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  std::ostringstream table;
  int calls = 0;
  {
    Loop loop(10);
    loop.est.optimize();
  }
  Loop loop(10);
  slom::Options options;
  options.observer = slom::progressTable(table);
  const slom::Summary summary = loop.est.optimize(options);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  const std::string text = table.str();
  EXPECT_EQ(text.substr(0, 27), "iter              RSS    de");
  EXPECT_EQ(static_cast<int>(std::count(text.begin(), text.end(), '\n')), summary.iterations + 2);
  options.observer = [&](const slom::IterationRecord& r) { EXPECT_EQ(r.iteration, calls++); };
  const slom::Summary again = loop.est.optimize(options);
  EXPECT_EQ(calls, again.iterations + 1);
}

TEST(Report, SaysItAll) {
  slom::Estimator est;
  const auto line = est.insertRV(vec2(0, 0), "line");
  est.insertMeasurement(Samples(line, (VectorXd(4) << 1, 3, 5, 8).finished()), slom::StandardDeviation(0.5));
  slom::Summary summary = est.optimize();
  EXPECT_EQ(slom::report(summary),
            "Converged: " + summary.message + "\n"
            "  " + std::to_string(summary.iterations) + " iterations of Gauss-Newton; system 1 x 2, dense Cholesky\n"
            "  4 residuals - 2 unknowns (1 variables) = redundancy 2\n"
            "  measurement    count  residuals     RSS before      RSS after  derivatives\n"
            "  Samples            1          4            396            1.2  numeric\n"
            "  all                           4            396            1.2\n"
            "  chi-square / dof = 0.6; standard deviations are taken as stated\n"
            "  parameter          value   standard deviation\n"
            "  line.x               0.8                0.418\n"
            "  line.y               2.3                0.224\n");
  std::ostringstream os;
  os << summary;
  EXPECT_EQ(os.str(), slom::report(summary));
}

}  // namespace
