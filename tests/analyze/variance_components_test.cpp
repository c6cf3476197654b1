// Variance components against the maximum of the restricted likelihood, found by dense algebra.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/variance_components.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using slom::testing::messageOf;
using vec2 = mtk::vect<2>;

const auto height = [](const auto& a) { return a; };
const auto rise = [](const auto& a, const auto& b) { return b - a; };

/// Heights of five points, measured by several instruments. The model as dense matrices, in stated standard deviations:
/// y = X x + e, Cov(e) = sum theta_k V_k.
struct Levelling {
  slom::Estimator est;
  std::vector<slom::VarID<double>> points;
  std::vector<Eigen::RowVectorXd> rows;
  std::vector<double> y;
  std::vector<int> kind, day;
  std::mt19937 engine;

  explicit Levelling(unsigned seed = 1) : engine(seed) {
    for (int i = 0; i < 5; ++i) points.push_back(est.insertRV(0.1 * i, "point"));
  }
  /// A measurement of kind k on a day; `to` -1: of the height itself. `error` in stated standard deviations.
  void add(int k, const char* name, int from, int to, double stated, double error, int on_day) {
    const auto a = static_cast<std::size_t>(from), b = static_cast<std::size_t>(std::max(to, 0));
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(5);
    row[from] = (to < 0 ? 1 : -1) / stated;
    if (to >= 0) row[to] = 1 / stated;
    const double truth = to < 0 ? 0.1 * from : 0.1 * (to - from), z = truth + stated * error;
    const slom::StandardDeviation sigma(stated);
    if (to < 0) {
      est.insertMeasurement(height, points[a], slom::measured(z), sigma, slom::named(name),
                            slom::group("day", on_day), slom::group("hour", hourOf(y.size())));
    } else {
      est.insertMeasurement(rise, points[a], points[b], slom::measured(z), sigma, slom::named(name),
                            slom::group("day", on_day), slom::group("hour", hourOf(y.size())));
    }
    rows.push_back(row);
    y.push_back(z / stated);
    kind.push_back(k);
    day.push_back(on_day);
  }
  /// When measurement i of all was made; some at the same time.
  static int hourOf(std::size_t i) { return static_cast<int>(i % 23); }
  double normal() { return std::normal_distribution<double>()(engine); }
  MatrixXd V(int k) const {
    MatrixXd result = MatrixXd::Zero(Index(y.size()), Index(y.size()));
    for (std::size_t i = 0; i < y.size(); ++i) result(Index(i), Index(i)) = kind[i] == k ? 1 : 0;
    return result;
  }
  /// Returns V of an error that kind k shares on each day, with a correlation that falls with the time between.
  MatrixXd sharedV(int k, double length = 1e300) const {
    MatrixXd result = MatrixXd::Zero(Index(y.size()), Index(y.size()));
    for (std::size_t i = 0; i < y.size(); ++i) {
      for (std::size_t j = 0; j < y.size(); ++j)
        result(Index(i), Index(j)) = kind[i] == k && kind[j] == k && day[i] == day[j]
                                         ? std::exp(-std::abs(hourOf(i) - hourOf(j)) / length)
                                         : 0;
    }
    return result;
  }
};

/// Inserts points by GPS, and rises by two levels. `shared`: error that rises of the first level share on each of 8
/// days.
void level(Levelling& all, const std::vector<double>& sigma, double shared = 0) {
  for (int day = 0; day < 8; ++day) {
    const double common = shared * all.normal();
    for (int i = 0; i < 5; ++i) all.add(0, "gps", i, -1, 0.05, sigma[0] * all.normal(), day);
    for (int i = 0; i < 4; ++i) {
      all.add(1, "level", i, i + 1, 0.01, sigma[1] * all.normal() + common, day);
      if (sigma.size() > 2) all.add(2, "laser", i, (i + 2) % 5, 0.02, sigma[2] * all.normal(), day);
    }
  }
  ASSERT_TRUE(all.est.optimize().converged);
}

/// The restricted likelihood and its maximum over log theta.
struct DenseLikelihood {
  MatrixXd X;
  VectorXd y;
  std::vector<MatrixXd> V;
  MatrixXd fixed;  // the part of the covariance that is not estimated

  DenseLikelihood(const Levelling& all, std::vector<MatrixXd> parts)
      : X(Index(all.y.size()), 5),
        y(Index(all.y.size())),
        V(std::move(parts)),
        fixed(MatrixXd::Zero(y.size(), y.size())) {
    for (Index i = 0; i < y.size(); ++i) {
      X.row(i) = all.rows[static_cast<std::size_t>(i)];
      y[i] = all.y[static_cast<std::size_t>(i)];
    }
  }
  MatrixXd covariance(const VectorXd& log_theta) const {
    MatrixXd sum = fixed;
    for (std::size_t k = 0; k < V.size(); ++k) sum += std::exp(log_theta[Index(k)]) * V[k];
    return sum;
  }
  double operator()(const VectorXd& log_theta) const {
    const Eigen::LLT<MatrixXd> L(covariance(log_theta));
    const MatrixXd A = X.transpose() * L.solve(X);
    const Eigen::LLT<MatrixXd> N(A);
    const VectorXd r = y - X * N.solve(X.transpose() * L.solve(y));
    return -(MatrixXd(L.matrixL()).diagonal().array().log().sum() +
             MatrixXd(N.matrixL()).diagonal().array().log().sum() + r.dot(L.solve(r)) / 2);
  }
  VectorXd gradient(const VectorXd& at) const {
    const double h = 1e-4;
    VectorXd g(at.size());
    for (Index k = 0; k < at.size(); ++k) {
      VectorXd step = VectorXd::Zero(at.size());
      step[k] = h;
      g[k] =
          (8 * ((*this)(at + step) - (*this)(at - step)) - (*this)(at + 2 * step) + (*this)(at - 2 * step)) /
          (12 * h);
    }
    return g;
  }
  /// Newton's method with differences.
  VectorXd maximum(VectorXd at) const {
    for (int i = 0; i < 30; ++i) {
      const double h = 1e-3;
      const VectorXd g = gradient(at);
      MatrixXd H(at.size(), at.size());
      for (Index k = 0; k < at.size(); ++k) {
        VectorXd step = VectorXd::Zero(at.size());
        step[k] = h;
        H.col(k) = (gradient(at + step) - gradient(at - step)) / (2 * h);
      }
      const VectorXd d = -((H + H.transpose()) / 2).ldlt().solve(g);
      at += d / std::max(1.0, d.norm());
      if (d.norm() < 1e-9) break;
    }
    return at;
  }
  /// tr(P V_k P V_l) / 2, of theta.
  MatrixXd information(const VectorXd& log_theta) const {
    const MatrixXd W = covariance(log_theta).inverse(),
                   P = W - W * X * (X.transpose() * W * X).inverse() * X.transpose() * W;
    MatrixXd result(Index(V.size()), Index(V.size()));
    for (std::size_t k = 0; k < V.size(); ++k) {
      for (std::size_t l = 0; l < V.size(); ++l)
        result(Index(k), Index(l)) = (P * V[k] * P * V[l]).trace() / 2;
    }
    return result;
  }
};

void expectMaximum(const slom::VarianceComponents& v, const DenseLikelihood& dense) {
  ASSERT_TRUE(v.converged) << v.report();
  VectorXd found(Index(v.components.size()));
  for (Index k = 0; k < found.size(); ++k)
    found[k] = 2 * std::log(v.components[static_cast<std::size_t>(k)].factor);
  const VectorXd best = dense.maximum(found + VectorXd::Constant(found.size(), 0.05));
  EXPECT_LT((best - found).cwiseAbs().maxCoeff(), 1e-6) << best.transpose() << " | " << found.transpose();
  const MatrixXd C = dense.information(found).inverse();
  for (Index k = 0; k < found.size(); ++k) {
    const slom::VarianceComponent& own = v.components[static_cast<std::size_t>(k)];
    const double theta = own.factor * own.factor;
    EXPECT_NEAR(own.standard_deviation, std::sqrt(C(k, k)) / (2 * own.factor), 1e-6 * own.factor);
    EXPECT_NEAR(own.dof, 2 * theta * theta / C(k, k), 1e-6 * own.dof);
    for (Index l = 0; l < found.size(); ++l)
      EXPECT_NEAR(v.correlation(int(k), int(l)), C(k, l) / std::sqrt(C(k, k) * C(l, l)), 1e-6);
  }
}

TEST(VarianceComponents, AreTheMaximumOfTheRestrictedLikelihood) {
  Levelling two, three;
  level(two, {2, 0.5});
  level(three, {2, 0.5, 7});
  expectMaximum(slom::varianceComponents(two.est), {two, {two.V(0), two.V(1)}});
  expectMaximum(slom::varianceComponents(three.est), {three, {three.V(0), three.V(1), three.V(2)}});
}

TEST(VarianceComponents, WithASharedError) {
  Levelling all;
  level(all, {1, 1, 1}, 3);
  const slom::VarianceComponents v = slom::varianceComponents(all.est, {.shared = {{"level", "day"}}});
  expectMaximum(v, {all, {all.V(0), all.V(1), all.V(2), all.sharedV(1)}});
  EXPECT_EQ(v.components[3].name, "level, shared by day");
  EXPECT_TRUE(v.components[3].is_shared);
  EXPECT_EQ(v.components[3].measurements, 8);
  EXPECT_GT(v.at("level, shared by day").factor, 1.5);
  // Without it the first level's own error takes the blame.
  EXPECT_GT(slom::varianceComponents(all.est).at("level").factor, 1.5 * v.at("level").factor);
}

TEST(VarianceComponents, WithAnErrorThatChangesAlongGroups) {
  const auto hour = [](const slom::ClusterItem& item) { return static_cast<double>(*item.key("hour")); };
  for (const double length : {10.0, 60.0}) {
    Levelling all;
    level(all, {1, 1, 1}, 3);
    const auto components = [&](double L) {
      return slom::varianceComponents(
          all.est, {.shared = {{.kind = "level", .by = "day", .place = hour, .length = L}}});
    };
    const slom::VarianceComponents v = components(length);
    SLOM_SKIP_WITH_SANITIZERS();  // the dense likelihood below
    expectMaximum(v, {all, {all.V(0), all.V(1), all.V(2), all.sharedV(1, length)}});
    VectorXd at(4);
    for (Index k = 0; k < 4; ++k) at[k] = 2 * std::log(v.components[static_cast<std::size_t>(k)].factor);
    const auto likelihood = [&](double log_length) {
      return DenseLikelihood(all, {all.V(0), all.V(1), all.V(2), all.sharedV(1, std::exp(log_length))})(at);
    };
    const double h = 1e-3, x = std::log(length), slope = (likelihood(x + h) - likelihood(x - h)) / (2 * h);
    EXPECT_NEAR(v.components[3].length_slope, slope, 1e-5 * std::max(1.0, std::abs(slope)));
    EXPECT_GT(std::abs(slope), 1e-3);
    EXPECT_EQ(v.components[0].length_slope, 0);
  }
}

TEST(VarianceComponents, OfSomeKindsWhileOthersAreAsStated) {
  Levelling all;
  level(all, {1, 3, 1});
  DenseLikelihood dense(all, {all.V(1)});
  dense.fixed = all.V(0) + all.V(2);
  const slom::VarianceComponents v = slom::varianceComponents(all.est, {.kinds = {"level"}});
  expectMaximum(v, dense);
  EXPECT_EQ(v.notes, (std::vector<std::string>{"taken as stated: gps and laser"}));
}

TEST(VarianceComponents, OfOneKindIsChiSquarePerDof) {
  Levelling all;
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 6; ++k) all.add(0, "gps", i, -1, 0.05, 3 * all.normal(), k);
  }
  const slom::Summary summary = all.est.optimize();
  const slom::VarianceComponents v = slom::varianceComponents(all.est);
  EXPECT_NEAR(v.components[0].factor, std::sqrt(summary.chi2PerDof()), 1e-9);
  EXPECT_NEAR(v.components[0].redundancy, 25, 1e-9);
  EXPECT_NEAR(v.components[0].dof, 25, 1e-9);
  EXPECT_NEAR(v.components[0].standard_deviation, v.components[0].factor / std::sqrt(50), 1e-9);
  // The interval of a variance by chi-square: 25 s^2 / 40.646 and / 13.120.
  const auto [lower, upper] = v.components[0].interval(0.95);
  EXPECT_NEAR(lower, v.components[0].factor * std::sqrt(25 / 40.646469), 1e-6);
  EXPECT_NEAR(upper, v.components[0].factor * std::sqrt(25 / 13.119720), 1e-6);
}

TEST(VarianceComponents, ChangeNothingUntilTheyAreApplied) {
  Levelling all;
  level(all, {2, 0.5, 7});
  const double rss = all.est.getRSS(), deviation = all.est.standardDeviation(all.points[2])[0];
  const auto structure = all.est.table().structureRevision(), values = all.est.table().valueRevision();
  const slom::VarianceComponents v = slom::varianceComponents(all.est);
  EXPECT_EQ(all.est.getRSS(), rss);
  EXPECT_EQ(all.est.standardDeviation(all.points[2])[0], deviation);
  EXPECT_EQ(all.est.table().structureRevision(), structure);
  EXPECT_EQ(all.est.table().valueRevision(), values);

  all.est.update();
  const slom::VarianceComponents again = slom::varianceComponents(all.est);
  slom::apply(again, all.est);
  all.est.update();  // follows the new weights
  const double followed = *all.points[2];
  const slom::Summary summary = all.est.optimize();
  EXPECT_NEAR(*all.points[2], followed, 1e-6 * deviation);
  for (const slom::GroupSummary& group : summary.groups) EXPECT_NEAR(group.final_rss, group.redundancy, 1e-5);
  const slom::VarianceComponents after = slom::varianceComponents(all.est);
  for (const slom::VarianceComponent& own : after.components) EXPECT_NEAR(own.factor, 1, 1e-6) << own.name;
  EXPECT_LT(after.largest_move, 1e-5);

  Levelling other;  // the same with the right standard deviations from the start
  for (std::size_t i = 0; i < all.y.size(); ++i) {
    const auto k = static_cast<std::size_t>(all.kind[i]);
    const double factor = again.components[k].factor;
    const int from =
        all.rows[i].minCoeff() < 0
            ? int((all.rows[i].array() < 0).cast<int>().matrix().dot(Eigen::RowVectorXi::LinSpaced(5, 0, 4)))
            : -1;
    const int to =
        int((all.rows[i].array() > 0).cast<int>().matrix().dot(Eigen::RowVectorXi::LinSpaced(5, 0, 4)));
    const double stated = 1 / all.rows[i].maxCoeff();
    const slom::StandardDeviation sigma(factor * stated);
    if (from < 0) {
      other.est.insertMeasurement(height, other.points[std::size_t(to)], slom::measured(stated * all.y[i]),
                                  sigma);
    } else {
      other.est.insertMeasurement(rise, other.points[std::size_t(from)], other.points[std::size_t(to)],
                                  slom::measured(stated * all.y[i]), sigma);
    }
  }
  ASSERT_TRUE(other.est.optimize().converged);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(*all.points[i], *other.points[i], 1e-9);
    EXPECT_NEAR(all.est.standardDeviation(all.points[i])[0], other.est.standardDeviation(other.points[i])[0],
                1e-9);
  }
}

TEST(VarianceComponents, OfAKindThatNothingChecks) {
  Levelling all;
  level(all, {2, 0.5});
  const auto far = all.est.insertRV(0.0, "far");
  all.est.insertMeasurement(rise, all.points[0], far, slom::measured(3.0), slom::named("radar"));
  ASSERT_TRUE(all.est.optimize().converged);
  const slom::VarianceComponents v = slom::varianceComponents(all.est);
  const slom::VarianceComponent& radar = v.at("radar");
  EXPECT_FALSE(radar.is_estimated);
  EXPECT_EQ(radar.factor, 1);
  EXPECT_EQ(radar.reason, "its redundancy is 0: no other measurement checks it");
  EXPECT_EQ(v.notes, (std::vector<std::string>{
                         "radar: its redundancy is 0: no other measurement checks it; its standard "
                         "deviations are taken as stated"}));
  EXPECT_TRUE(std::isnan(radar.standard_deviation));
  EXPECT_TRUE(v.converged);
  EXPECT_GT(v.at("gps").factor, 1.5);
  EXPECT_EQ(v.at("radar").interval().first, 0);
}

TEST(VarianceComponents, OfAKindWithoutResiduals) {
  Levelling all;
  level(all, {2, 0.5});
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 4; ++k)
      all.est.insertMeasurement(rise, all.points[0], all.points[static_cast<std::size_t>(i + 1)],
                                slom::measured(0.1 * (i + 1)), slom::StandardDeviation(0.01),
                                slom::named("ruler"));
  }
  ASSERT_TRUE(all.est.optimize().converged);
  const slom::VarianceComponents v = slom::varianceComponents(all.est);
  EXPECT_FALSE(v.at("ruler").is_estimated);
  EXPECT_EQ(v.at("ruler").reason, "the estimate is 0: its residuals are 0, or too few");
  EXPECT_EQ(v.at("ruler").factor, 1);
  EXPECT_TRUE(v.converged);

  slom::Estimator exact;
  const auto level = exact.insertRV(0.0, "level");
  for (int i = 0; i < 5; ++i) exact.insertMeasurement(height, level, slom::measured(1.0), slom::named("gps"));
  ASSERT_TRUE(exact.optimize().converged);
  const slom::VarianceComponents none = slom::varianceComponents(exact);
  EXPECT_FALSE(none.converged);
  EXPECT_EQ(none.message, "no component can be estimated");
}

/// Each point by one measurement of either kind: only the sum of their variances shows in residuals.
TEST(VarianceComponents, OfKindsThatCannotBeToldApart) {
  slom::Estimator est;
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  double rss = 0;
  for (int i = 0; i < 30; ++i) {
    const auto x = est.insertRV(0.0);
    const double a = normal(engine), b = 2 * normal(engine);
    est.insertMeasurement(height, x, slom::measured(a), slom::named("a"));
    est.insertMeasurement(height, x, slom::measured(b), slom::named("b"));
    rss += (a - b) * (a - b) / 2;
  }
  ASSERT_TRUE(est.optimize().converged);
  const slom::VarianceComponents v = slom::varianceComponents(est);
  EXPECT_EQ(v.notes, (std::vector<std::string>{
                         "the residuals cannot tell apart the errors of a and b; they get one factor"}));
  EXPECT_NEAR(v.at("a").factor, std::sqrt(rss / 30), 1e-9);
  EXPECT_EQ(v.at("b").factor, v.at("a").factor);
  EXPECT_NEAR(v.at("a").dof, 30, 1e-9);
  EXPECT_NEAR(v.correlation(0, 1), 1, 1e-12);
}

/// A shared error of groups with one measurement each is that measurement's own.
TEST(VarianceComponents, OfASharedErrorThatIsNone) {
  Levelling all;
  for (int i = 0; i < 40; ++i) all.add(0, "gps", i % 5, -1, 0.05, all.normal(), i);
  ASSERT_TRUE(all.est.optimize().converged);
  const slom::VarianceComponents alone = slom::varianceComponents(all.est, {.shared = {{"gps", "day"}}});
  EXPECT_EQ(
      alone.notes,
      (std::vector<std::string>{
          "the residuals cannot tell apart the errors of gps and gps, shared by day; the last of them is left out",
          "gps, shared by day: it cannot be told apart from others"}));
  EXPECT_EQ(alone.components[1].factor, 0);
  EXPECT_NEAR(alone.components[0].factor, slom::varianceComponents(all.est).components[0].factor, 1e-9);

  // Errors that alternate within each group: less in common than by chance.
  Levelling opposite;
  for (int i = 0; i < 40; ++i)
    opposite.add(0, "gps", i % 5, -1, 0.05, (i % 2 == 0 ? 1 : -1) * (1 + 0.1 * opposite.normal()), i / 4);
  ASSERT_TRUE(opposite.est.optimize().converged);
  const slom::VarianceComponents none = slom::varianceComponents(opposite.est, {.shared = {{"gps", "day"}}});
  EXPECT_EQ(none.components[1].reason, "the estimate is 0: no shared error is seen");
  EXPECT_EQ(none.components[1].factor, 0);
}

TEST(VarianceComponents, OfAFreeNetworkWithFixedComponentsAndBounds) {
  std::mt19937 engine(4);
  std::normal_distribution<double> normal;
  slom::Estimator free, fixed;
  std::vector<slom::VarID<vec2>> points, others;
  for (int i = 0; i < 6; ++i) {
    points.push_back(free.insertRV(vec2(0, 0)));
    others.push_back(fixed.insertRV(vec2(0, 0), i > 0));
  }
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const char* const name = (i + j) % 2 == 0 ? "even" : "odd";
      const double size = (i + j) % 2 == 0 ? 1 : 3;
      const double y = size * normal(engine), x = size * normal(engine);
      const vec2 z(x, y);
      free.insertMeasurement(rise, points[i], points[j], slom::measured(z), slom::named(name));
      fixed.insertMeasurement(rise, others[i], others[j], slom::measured(z), slom::named(name));
    }
  }
  free.changeAlgorithm(slom::LevenbergMarquardt());
  ASSERT_TRUE(free.optimize().converged);
  ASSERT_TRUE(fixed.optimize().converged);
  EXPECT_EQ(messageOf([&] { slom::varianceComponents(free); }).substr(0, 17), "[slom.free-gauge]");
  free.setFreeGauge(slom::FreeGauge::inner_constraints);
  const slom::VarianceComponents a = slom::varianceComponents(free), b = slom::varianceComponents(fixed);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(a.components[k].factor, b.components[k].factor, 1e-7);
    EXPECT_NEAR(a.components[k].standard_deviation, b.components[k].standard_deviation, 1e-7);
  }
  // Components that do not move count as known: by fixing and by a bound, away from the best value.
  fixed.reinitRV(others[1], vec2(*others[1] + vec2(0.5, 0)));
  fixed.fix(others[1], "x");
  ASSERT_TRUE(fixed.optimize().converged);
  const slom::VarianceComponents by_fixing = slom::varianceComponents(fixed);
  const double x = (*others[1])[0];
  fixed.free(others[1]);
  const double all = b.components[0].redundancy + b.components[1].redundancy;
  EXPECT_NEAR(by_fixing.components[0].redundancy + by_fixing.components[1].redundancy, all + 1, 1e-9);
  ASSERT_TRUE(fixed.optimize().converged);
  const double best = (*others[1])[0];
  fixed.reinitRV(others[1], vec2(x, 0));
  fixed.bound(others[1], "x", x < best ? x - 9 : x, x < best ? x : x + 9);
  ASSERT_TRUE(fixed.optimize().converged);
  const slom::VarianceComponents by_bound = slom::varianceComponents(fixed);
  EXPECT_NEAR(by_bound.components[0].factor, by_fixing.components[0].factor, 1e-6);
}

TEST(VarianceComponents, KindsByTypeAndByKey) {
  Levelling all;
  level(all, {2, 0.5});
  const slom::VarianceComponents by_label = slom::varianceComponents(all.est);
  const auto key = [](const slom::ClusterItem& item) -> std::optional<std::int64_t> {
    return item.label() == "gps" ? 0 : 1;
  };
  const slom::VarianceComponents by_key =
      slom::varianceComponents(all.est, {.by = slom::ClusterBy::function("kind", key)});
  EXPECT_EQ(by_key.components[1].name, "kind 1");
  EXPECT_NEAR(by_key.components[1].factor, by_label.components[1].factor, 1e-9);

  slom::Estimator est;
  const auto x = est.insertRV(0.0, "x");
  for (const double z : {1.0, 2.0, 4.0}) est.insertMeasurement(height, x, slom::measured(z));
  est.prior(x, 0.0, 1.0);
  ASSERT_TRUE(est.optimize().converged);
  const slom::VarianceComponents v = slom::varianceComponents(est);
  ASSERT_EQ(v.components.size(), 1U);
  EXPECT_EQ(v.components[0].measurements, 3);
  EXPECT_EQ(v.notes, (std::vector<std::string>{"taken as stated: prior"}));
}

TEST(VarianceComponents, Report) {
  Levelling all;
  level(all, {1, 1}, 2);
  const auto far = all.est.insertRV(0.0, "far");
  all.est.insertMeasurement(rise, all.points[0], far, slom::measured(3.0), slom::named("radar"));
  all.est.prior(far, 2.0, 10.0);
  ASSERT_TRUE(all.est.optimize().converged);
  EXPECT_EQ(
      slom::varianceComponents(all.est, {.shared = {{"level", "day"}}}).report(),
      "Converged: the variances changed by less than the tolerance\n"
      "  kind                 residuals  redundancy        dof  sigma over stated\n"
      "  gps                         40       38.55       38.3  1.162 +- 0.13\n"
      "  level                       32       21.86         21  1.008 +- 0.16\n"
      "  radar                        1     0.01952          0  1 as stated\n"
      "  level, shared by day         8       6.592       5.65  1.434 +- 0.43\n"
      "  note: radar: the estimate is 0: its residuals are 0, or too few; its standard deviations are taken as "
      "stated\n"
      "  note: taken as stated: prior\n");
}

TEST(VarianceComponents, Errors) {
  Levelling all;
  level(all, {1, 1});
  const auto message = [&](const slom::VarianceOptions& options) {
    return messageOf([&] { slom::varianceComponents(all.est, options); });
  };
  EXPECT_EQ(
      message({.max_iterations = 0}),
      "[slom.bad-option] max_iterations is 0 and the tolerance 1e-09; pass positive numbers, such as 200 and 1e-9");
  EXPECT_EQ(message({.kinds = {"tape"}}),
            "[slom.no-component] no measurements are of the kind tape; there are gps and level");
  EXPECT_EQ(
      message({.shared = {{"tape", "day"}}}),
      "[slom.no-component] no measurements are of the kind tape, which a SharedError names; there are gps "
      "and level");
  EXPECT_EQ(
      message({.shared = {{"gps", slom::ClusterBy::function("odd",
                                                            [](const slom::ClusterItem&) {
                                                              return std::optional<std::int64_t>();
                                                            })}}}),
      "[slom.no-groups] no measurement of the kind gps is in a group by odd; pass slom::group to insertMeasurement");
  const auto nowhere = [](const slom::ClusterItem&) { return std::nan(""); };
  EXPECT_EQ(
      message({.shared = {{.kind = "gps", .by = "day", .place = nowhere, .length = 1}}}),
      "[slom.bad-option] the place of measurement gps #1 is nan; let SharedError::place return a finite time or distance");
  EXPECT_EQ(
      message({.shared = {{.kind = "gps", .by = "day", .place = nowhere}}}),
      "[slom.bad-option] an error of measurements gps changes along groups with the correlation length 0; pass a positive "
      "length in the units of SharedError::place");
  const slom::VarianceComponents v = slom::varianceComponents(all.est);
  EXPECT_EQ(messageOf([&] { v.at("tape"); }),
            "[slom.no-component] there is no variance component tape; there are gps and level");
  EXPECT_EQ(
      messageOf([&] { v.components[0].interval(1); }),
      "[slom.bad-option] the probability of an interval is 1; pass a number between 0 and 1, such as 0.95");
  const auto robust = all.est.insertMeasurement(height, all.points[0], slom::measured(0.0), slom::Huber(1.0),
                                                slom::named("gps"));
  EXPECT_EQ(
      messageOf([&] { slom::apply(v, all.est); }),
      "[slom.stale-components] the variance components belong to a problem that has changed, or to another "
      "problem; call slom::varianceComponents(est) again");
  all.est.optimize();
  EXPECT_EQ(
      message({}),
      "[slom.components-with-loss] measurements gps have losses, so their residuals do not show the variance "
      "of good measurements; remove the outliers and insert the others without a loss, or leave this kind "
      "out of "
      "VarianceOptions::kinds");
  EXPECT_GT(slom::varianceComponents(all.est, {.kinds = {"level"}}).components[0].factor, 0);
  all.est.removeMeasurement(robust);
  all.est.reinitRV(all.points[0], 3.0);
  EXPECT_EQ(
      message({}),
      "[slom.not-a-minimum] variance components need the values of a converged fit; call optimize() and "
      "check summary.converged");

  slom::Estimator priors;
  const auto x = priors.insertRV(0.0, "x");
  priors.prior(x, 1.0, 1.0);
  priors.optimize();
  EXPECT_EQ(messageOf([&] { slom::varianceComponents(priors); }),
            "[slom.no-component] there are no measurements whose variance can be estimated; to estimate the "
            "variance of priors, name them in VarianceOptions::kinds");

  slom::Estimator lengths;
  const auto p = lengths.insertRV(vec2(0, 0), "p");
  const auto both = [](const auto& q) { return q; };
  const auto first = [](const auto& q) { return q[0]; };
  lengths.insertMeasurement(both, p, slom::measured(vec2(1, 2)), slom::named("gps"), slom::group("day", 1));
  lengths.insertMeasurement(first, p, slom::measured(2.0), slom::named("gps"), slom::group("day", 1));
  lengths.optimize();
  const auto by_label = slom::ClusterBy::label();
  EXPECT_EQ(
      messageOf([&] {
        slom::varianceComponents(lengths, {.by = by_label, .shared = {{"gps", "day"}}});
      }),
      "[slom.bad-group] measurements gps share an error by day, but the residual of gps-2 #1 has the length "
      "1, and others have 2; name kinds with residuals of one length");
}

}  // namespace
