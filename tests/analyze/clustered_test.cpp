// Clustered covariances against their textbook formulas with dense matrices, and against fits without a group.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/analyze/clustered.hpp>
#include <slom/analyze/student.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using slom::ClusterCorrection;
using slom::testing::messageOf;
using vec2 = mtk::vect<2>;

/// y = line_0 + line_1 t + level of the group.
struct RegressionLine {
  auto operator()(const auto& line, double t) const { return line[0] + line[1] * t; }
};
struct LevelledLine {
  auto operator()(const auto& line, const auto& level, double t) const {
    return line[0] + line[1] * t + level;
  }
};

/// A linear problem: its estimator, and its whitened Jacobian and residuals, dense.
struct Regression {
  slom::Estimator est;
  slom::VarID<vec2> line = est.insertRV(vec2(0, 0), "line");
  std::vector<slom::VarID<double>> levels;
  MatrixXd J;
  VectorXd r;
  std::vector<int> group, other;  // by row; -1: none

  MatrixXd C() const { return (J.transpose() * J).inverse(); }
};

struct Shape {
  int groups = 7;
  bool has_levels = false;
  int without_group = 0;  // measurements without any
  double sigma = 0.5;
  int left_out = -1;
};

/// Inserts groups of 2 to 6 measurements with a shared error.
void fill(Regression& fit, const Shape& shape) {
  std::mt19937 engine(11);
  std::normal_distribution<double> normal;
  std::vector<Eigen::RowVectorXd> rows;
  std::vector<double> data;
  const int columns = 2 + (shape.has_levels ? shape.groups : 0);
  if (shape.has_levels) {
    for (int g = 0; g < shape.groups; ++g) {
      fit.levels.push_back(fit.est.insertRV(0.0, "level"));
      if (g > 2) continue;
      fit.est.prior(fit.levels.back(), 0.1, shape.sigma);
      Eigen::RowVectorXd prior = Eigen::RowVectorXd::Zero(columns);
      prior[2 + g] = 1 / shape.sigma;
      rows.push_back(prior);
      data.push_back(0.1 / shape.sigma);
      fit.group.push_back(-1);
      fit.other.push_back(-1);
    }
  }
  for (int g = 0; g < shape.groups; ++g) {
    const double common = normal(engine);
    for (int i = 0; i < 2 + g % 5; ++i) {
      const double t = normal(engine) + 0.3 * g, y = 1 + 2 * t + 0.5 * (common + normal(engine));
      if (g == shape.left_out) continue;
      Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(columns);
      row[0] = 1 / shape.sigma;
      row[1] = t / shape.sigma;
      const slom::StandardDeviation noise(shape.sigma);
      if (shape.has_levels) {
        row[2 + g] = 1 / shape.sigma;
        fit.est.insertMeasurement(LevelledLine(), fit.line, fit.levels[static_cast<std::size_t>(g)], t,
                                  slom::measured(y), noise, slom::group("set", 100 - g),
                                  slom::group("place", i));
      } else {
        fit.est.insertMeasurement(RegressionLine(), fit.line, t, slom::measured(y), noise,
                                  slom::group("set", 100 - g), slom::group("place", i));
      }
      rows.push_back(row);
      data.push_back(y / shape.sigma);
      fit.group.push_back(g);
      fit.other.push_back(i);
    }
  }
  for (int i = 0; i < shape.without_group; ++i) {
    const double t = normal(engine), y = 1 + 2 * t + 0.5 * normal(engine);
    fit.est.insertMeasurement(RegressionLine(), fit.line, t, slom::measured(y),
                              slom::StandardDeviation(shape.sigma));
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(columns);
    row[0] = 1 / shape.sigma;
    row[1] = t / shape.sigma;
    rows.push_back(row);
    data.push_back(y / shape.sigma);
    fit.group.push_back(-1);
    fit.other.push_back(-1);
  }
  if (shape.has_levels && shape.left_out >= 0)
    fit.est.fix(fit.levels[static_cast<std::size_t>(shape.left_out)]);
  ASSERT_TRUE(fit.est.optimize().converged);
  fit.J.resize(static_cast<Index>(rows.size()), columns);
  VectorXd y(fit.J.rows());
  for (Index i = 0; i < fit.J.rows(); ++i) {
    fit.J.row(i) = rows[static_cast<std::size_t>(i)];
    y[i] = data[static_cast<std::size_t>(i)];
  }
  fit.r = fit.J * fit.J.colPivHouseholderQr().solve(y) - y;
}

/// The rows of each group.
std::vector<std::vector<int>> rowsOf(const std::vector<int>& group) {
  std::vector<std::vector<int>> result;
  for (std::size_t i = 0; i < group.size(); ++i) {
    if (group[i] < 0) continue;
    if (group[i] >= static_cast<int>(result.size())) result.resize(static_cast<std::size_t>(group[i]) + 1);
    result[static_cast<std::size_t>(group[i])].push_back(static_cast<int>(i));
  }
  std::erase_if(result, [](const auto& rows) { return rows.empty(); });
  return result;
}

struct DenseClustered {
  MatrixXd C;
  VectorXd dof;
};

/// Returns the sandwich, with the symmetric roots of the dense I - H_gg. Directions in which I - H_gg is 0, and rows
/// without a group, contribute the stated covariance.
DenseClustered denseClustered(const Regression& fit, const std::vector<int>& group,
                              ClusterCorrection correction) {
  const MatrixXd C = fit.C(), H = fit.J * C * fit.J.transpose();
  const std::vector<std::vector<int>> groups = rowsOf(group);
  const auto G = static_cast<double>(groups.size()), N = static_cast<double>(fit.J.rows()),
             K = static_cast<double>(fit.J.cols());
  double factor = 1;
  if (correction == ClusterCorrection::cr1) factor = G / (G - 1) * (N - 1) / (N - K);
  if (correction == ClusterCorrection::cr3) factor = (G - 1) / G;
  MatrixXd meat = MatrixXd::Zero(fit.J.cols(), fit.J.cols()), stated = meat;
  std::vector<MatrixXd> corrected_rows;  // A_g J_g, in all rows
  for (const std::vector<int>& rows : groups) {
    const MatrixXd Jg = fit.J(rows, Eigen::all);
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(H(rows, rows));
    VectorXd f(eigen.eigenvalues().size());
    for (Index k = 0; k < f.size(); ++k) {
      const double left = 1 - eigen.eigenvalues()[k];
      f[k] = correction == ClusterCorrection::cr2   ? 1 / std::sqrt(left)
             : correction == ClusterCorrection::cr3 ? 1 / left
                                                    : 1;
      if (left > 1e-8) continue;
      f[k] = 0;
      const VectorXd alone = Jg.transpose() * eigen.eigenvectors().col(k);
      stated += alone * alone.transpose();
    }
    const MatrixXd A = eigen.eigenvectors() * f.asDiagonal() * eigen.eigenvectors().transpose();
    const VectorXd score = Jg.transpose() * A * fit.r(rows);
    meat += score * score.transpose();
    MatrixXd all = MatrixXd::Zero(fit.J.rows(), fit.J.cols());
    all(rows, Eigen::all) = A * Jg;
    corrected_rows.push_back(all);
  }
  for (Index i = 0; i < fit.J.rows(); ++i) {
    if (group[static_cast<std::size_t>(i)] < 0) stated += fit.J.row(i).transpose() * fit.J.row(i);
  }
  DenseClustered result{C * (factor * meat + stated) * C, VectorXd(fit.J.cols())};
  for (Index c = 0; c < fit.J.cols(); ++c) {
    MatrixXd P(fit.J.rows(), static_cast<Index>(groups.size()));
    for (std::size_t g = 0; g < groups.size(); ++g)
      P.col(static_cast<Index>(g)) =
          (MatrixXd::Identity(H.rows(), H.rows()) - H) * corrected_rows[g] * C.col(c);
    const MatrixXd B = factor * P.transpose() * P;
    const double mean = B.trace() + (C * stated * C)(c, c);
    result.dof[c] = mean * mean / B.squaredNorm();
  }
  return result;
}

double relative(const MatrixXd& a, const MatrixXd& b) { return (a - b).norm() / b.norm(); }

const ClusterCorrection kCorrections[] = {ClusterCorrection::cr0, ClusterCorrection::cr1,
                                          ClusterCorrection::cr2, ClusterCorrection::cr3};

TEST(Clustered, IsTheTextbookFormula) {
  for (const int without_group : {0, 3}) {
    Regression fit;
    fill(fit, {.without_group = without_group});
    for (const ClusterCorrection correction : kCorrections) {
      const slom::Clustered c = slom::clustered(fit.est, {.by = {"set"}, .correction = correction});
      const DenseClustered dense = denseClustered(fit, fit.group, correction);
      EXPECT_LT(relative(c.covariance(fit.line), dense.C), 1e-9) << static_cast<int>(correction);
      EXPECT_LT(relative(c.degreesOfFreedom(fit.line), dense.dof), 1e-9) << static_cast<int>(correction);
      EXPECT_LT(relative(c.standardDeviation(fit.line), dense.C.diagonal().cwiseSqrt()), 1e-9);
      const VectorXd share = c.statedShare(fit.line);
      EXPECT_EQ(share.maxCoeff() > 0, without_group > 0);
    }
  }
}

TEST(Clustered, OfAVariableThatOneGroupAloneSees) {
  Regression fit;
  fill(fit, {.has_levels = true});
  for (const ClusterCorrection correction : kCorrections) {
    const slom::Clustered c = slom::clustered(fit.est, {.by = {"set"}, .correction = correction});
    const DenseClustered dense = denseClustered(fit, fit.group, correction);
    EXPECT_LT(relative(c.covariance(fit.line), dense.C.topLeftCorner(2, 2)), 1e-9);
    EXPECT_LT(relative(c.degreesOfFreedom(fit.line), dense.dof.head(2)), 1e-9);
    for (int g = 0; g < 7; ++g) {
      const auto& level = fit.levels[static_cast<std::size_t>(g)];
      EXPECT_LT(relative(c.covariance(level), dense.C.block(2 + g, 2 + g, 1, 1)), 1e-9) << g;
      EXPECT_LT(relative(c.covariance(fit.line, level), dense.C.block(0, 2 + g, 2, 1)), 1e-9) << g;
      EXPECT_LT(relative(c.covariance(level, fit.line), dense.C.block(2 + g, 0, 1, 2)), 1e-9) << g;
      EXPECT_LT(relative(c.degreesOfFreedom(level), dense.dof.segment(2 + g, 1)), 1e-8) << g;
      EXPECT_GT(c.statedShare(level)[0], 0.05);
    }
    EXPECT_LT(relative(c.covariance(fit.levels[2], fit.levels[4]), dense.C.block(4, 6, 1, 1)), 1e-9);
    EXPECT_LT(relative(c.jointCovariance(fit.line, fit.levels[0]), dense.C.topLeftCorner(3, 3)), 1e-9);
  }
}

TEST(Clustered, ByTwoWays) {
  Regression fit;
  fill(fit, {.groups = 12, .without_group = 1});
  std::vector<int> both(fit.group.size());
  for (std::size_t i = 0; i < both.size(); ++i)
    both[i] = fit.group[i] < 0 ? -1 : 10 * fit.group[i] + fit.other[i];
  const slom::Clustered c = slom::clustered(fit.est, {.by = {"set", "place"}});
  const MatrixXd by_set = denseClustered(fit, fit.group, ClusterCorrection::cr2).C,
                 by_place = denseClustered(fit, fit.other, ClusterCorrection::cr2).C;
  MatrixXd dense = by_set + by_place - denseClustered(fit, both, ClusterCorrection::cr2).C;
  ASSERT_GT(Eigen::SelfAdjointEigenSolver<MatrixXd>(dense).eigenvalues()[0], 0);
  dense.diagonal() = dense.diagonal().cwiseMax(by_set.diagonal()).cwiseMax(by_place.diagonal()).eval();
  EXPECT_LT(relative(c.covariance(fit.line), dense), 1e-9);
  EXPECT_EQ(c.degreesOfFreedom(fit.line)[0],
            std::min(slom::clustered(fit.est, {.by = {"set"}}).degreesOfFreedom(fit.line)[0],
                     slom::clustered(fit.est, {.by = {"place"}}).degreesOfFreedom(fit.line)[0]));
}

/// Errors that are opposite in the groups of one way and of the other: inclusion and exclusion lead below zero.
TEST(Clustered, ByTwoWaysThatContradictEachOther) {
  slom::Estimator est;
  const auto level = est.insertRV(0.0, "level");
  const auto is = [](const auto& x) { return x; };
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b)
      est.insertMeasurement(is, level, slom::measured((a + b) % 2 == 0 ? 1.0 : -1.0), slom::group("a", a),
                            slom::group("b", b));
  }
  est.optimize();
  const slom::Clustered c = slom::clustered(est, {.by = {"a", "b"}});
  const double s = c.standardDeviation(level)[0];
  EXPECT_GE(s, 0);
  EXPECT_FALSE(std::isnan(s));
  const std::vector<std::string> notes = c.notes(level);
  ASSERT_EQ(notes.size(), 3U);
  EXPECT_EQ(notes[2],
            "the covariance by several groupings had negative eigenvalues, which count as 0: level");
}

/// A second way of grouping with few groups and no shared errors. Its random contributions do not make variances
/// smaller.
TEST(Clustered, ByTwoWaysIsNoLessThanByOne) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  int smaller = 0;
  for (int repetition = 0; repetition < 20; ++repetition) {
    slom::Estimator est;
    const auto level = est.insertRV(0.0, "level");
    const auto is = [](const auto& x) { return x; };
    for (int day = 0; day < 12; ++day) {
      const double shared = normal(engine);
      for (int station = 0; station < 4; ++station)
        est.insertMeasurement(is, level, slom::measured(shared + 0.3 * normal(engine)),
                              slom::group("day", day), slom::group("station", station));
    }
    est.optimize();
    const slom::Clustered both = slom::clustered(est, {.by = {"day", "station"}});
    const double by_day = slom::clustered(est, {.by = {"day"}}).standardDeviation(level)[0];
    EXPECT_GE(both.standardDeviation(level)[0], by_day * (1 - 1e-8));
    const std::string note =
        "one grouping alone gave a larger variance than all groupings together, and is taken: level";
    const std::vector<std::string> notes = both.notes(level);
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) continue;
    ++smaller;
    EXPECT_NE(both.report().find("  note: " + note + "\n"), std::string::npos);
  }
  EXPECT_GT(smaller, 2);
}

TEST(Clustered, ChangesAreThoseOfFitsWithoutAGroup) {
  for (const bool has_levels : {false, true}) {
    Regression fit;
    fill(fit, {.has_levels = has_levels});
    const slom::Clustered c = slom::clustered(fit.est, {.by = {"set"}, .correction = ClusterCorrection::cr3});
    const MatrixXd change = c.change(fit.line);
    MatrixXd sum = MatrixXd::Zero(2, 2);
    ASSERT_EQ(change.rows(), 7);
    for (int g = 0; g < 7; ++g) {
      Regression without;
      fill(without, {.has_levels = has_levels, .left_out = g});
      const VectorXd moved = *without.line - *fit.line;
      EXPECT_LT(relative(change.row(6 - g).transpose(), moved), 1e-8) << g;  // keys fall
      sum += moved * moved.transpose();
    }
    if (!has_levels) {
      EXPECT_LT(relative(c.covariance(fit.line), 6.0 / 7 * sum), 1e-8);
      const MatrixXd influence = c.influence(fit.line);
      EXPECT_NEAR(influence(3, 1), change(3, 1) / c.standardDeviation(fit.line)[1], 1e-12);
    }
  }
}

TEST(Clustered, ChangesOfWhatOneGroupAloneSees) {
  Regression fit;
  fill(fit, {.has_levels = true});
  const slom::Clustered c = slom::clustered(fit.est, {.by = {"set"}});
  EXPECT_EQ(c.groups()[0], "set 94");
  EXPECT_EQ(c.groups()[6], "set 100");
  const MatrixXd change = c.change(fit.levels[4]);
  for (int g = 0; g < 7; ++g) EXPECT_EQ(std::isnan(change(g, 0)), g == 2) << g;
}

TEST(Clustered, DoesNotDependOnTheStatedSigma) {
  Regression a, b;
  fill(a, {});
  fill(b, {.sigma = 0.05});
  EXPECT_LT(relative(slom::clustered(a.est, {.by = {"set"}}).covariance(a.line),
                     slom::clustered(b.est, {.by = {"set"}}).covariance(b.line)),
            1e-9);
  // Where variances are estimated, what is taken as stated is, too.
  Regression c, d;
  fill(c, {.has_levels = true, .without_group = 2});
  fill(d, {.has_levels = true, .without_group = 2, .sigma = 0.05});
  c.est.setSigma(slom::Sigma::estimated);
  d.est.setSigma(slom::Sigma::estimated);
  EXPECT_LT(relative(slom::clustered(c.est, {.by = {"set"}}).jointCovariance(c.line, c.levels[3]),
                     slom::clustered(d.est, {.by = {"set"}}).jointCovariance(d.line, d.levels[3])),
            1e-9);
}

TEST(Clustered, TestsGroups) {
  Regression fit;
  fill(fit, {});
  const std::vector<slom::ClusterCheck> checks = slom::clustered(fit.est, {.by = {"set"}}).check();
  const MatrixXd H = fit.J * fit.C() * fit.J.transpose();
  const auto groups = rowsOf(fit.group);
  for (std::size_t g = 0; g < 7; ++g) {
    const std::vector<int>& rows = groups[g];
    const slom::ClusterCheck& check = checks[6 - g];
    const MatrixXd Jg = fit.J(rows, Eigen::all), Q = MatrixXd::Identity(Jg.rows(), Jg.rows()) - H(rows, rows);
    // Its residuals as far as J_g sees them, over their own covariance.
    const MatrixXd E = Jg.householderQr().householderQ() * MatrixXd::Identity(Jg.rows(), 2);
    const VectorXd part = E.transpose() * fit.r(rows);
    EXPECT_NEAR(check.statistic, part.dot((E.transpose() * Q * E).inverse() * part), 1e-9);
    EXPECT_EQ(check.dof, 2);
    EXPECT_EQ(check.measurements, static_cast<int>(rows.size()));
    EXPECT_NEAR(check.probability, std::exp(-check.statistic / 2), 1e-12);
  }
}

TEST(Clustered, OfWhatIsFixedOrAtABound) {
  Regression fit;
  fill(fit, {});
  fit.est.fix(fit.line, "x");
  ASSERT_TRUE(fit.est.optimize().converged);
  const slom::Clustered c = slom::clustered(fit.est, {.by = {"set"}});
  const MatrixXd C = c.covariance(fit.line);
  EXPECT_EQ(C(0, 0), 0);
  EXPECT_EQ(C(0, 1), 0);
  EXPECT_GT(C(1, 1), 0);
  EXPECT_TRUE(std::isinf(c.degreesOfFreedom(fit.line)[0]));
  EXPECT_EQ(c.interval(fit.line)[0], 0);
  EXPECT_EQ(c.change(fit.line).col(0).norm(), 0);

  Regression bounded;
  fill(bounded, {});
  bounded.est.bound(bounded.line, "x", (*bounded.line)[0] - 10, (*bounded.line)[0]);
  const double best = (*bounded.line)[0];
  bounded.est.bound(bounded.line, "x", -10, best + 1e-9);
  bounded.est.reinitRV(bounded.line, vec2(best - 1, 0));
  bounded.est.bound(bounded.line, "x", best - 2, best - 0.1);
  ASSERT_TRUE(bounded.est.optimize().converged);
  EXPECT_EQ(slom::clustered(bounded.est, {.by = {"set"}}).covariance(bounded.line)(0, 0), 0);
}

/// Points measured by their differences, so that all of them can move together.
TEST(Clustered, OfAFreeNetwork) {
  const auto difference = [](const auto& a, const auto& b) { return b - a; };
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
      const vec2 z(normal(engine), normal(engine));
      free.insertMeasurement(difference, points[i], points[j], slom::measured(z), slom::group((i + j) % 5));
      fixed.insertMeasurement(difference, others[i], others[j], slom::measured(z), slom::group((i + j) % 5));
    }
  }
  free.changeAlgorithm(slom::LevenbergMarquardt());
  EXPECT_EQ(free.optimize().free_directions, 2);
  ASSERT_TRUE(fixed.optimize().converged);
  EXPECT_EQ(messageOf([&] { slom::clustered(free).covariance(points[0]); }).substr(0, 17),
            "[slom.free-gauge]");
  free.setFreeGauge(slom::FreeGauge::inner_constraints);
  const slom::Clustered a = slom::clustered(free), b = slom::clustered(fixed);
  // The covariance of a difference of points does not depend on the datum.
  for (std::size_t i = 2; i < 6; ++i) {
    const MatrixXd A = a.jointCovariance(points[i], points[1]), B = b.jointCovariance(others[i], others[1]);
    EXPECT_NEAR(A(0, 0) + A(2, 2) - 2 * A(0, 2), B(0, 0) + B(2, 2) - 2 * B(0, 2), 1e-9);
  }
  const MatrixXd all = a.jointCovariance(points[0], points[1], points[2], points[3], points[4], points[5]);
  for (Index row = 0; row < 12; ++row) {  // the mean is certain
    double sum = 0;
    for (Index k = 0; k < 12; k += 2) sum += all(row, k);
    EXPECT_NEAR(sum, 0, 1e-9);
  }
  EXPECT_GT(a.degreesOfFreedom(points[3])[0], 1);
}

TEST(Clustered, WithoutResiduals) {
  slom::Estimator est;
  const auto level = est.insertRV(0.0, "level");
  for (int i = 0; i < 20; ++i)
    est.insertMeasurement([](const auto& x) { return x; }, level, slom::measured(1.0), slom::group(i / 2));
  est.optimize();
  const slom::Clustered c = slom::clustered(est);
  EXPECT_NEAR(c.standardDeviation(level)[0], 0, 1e-12);
  EXPECT_NEAR(c.degreesOfFreedom(level)[0], 9, 1e-9);  // G - 1 for equal groups
  EXPECT_EQ(c.check()[3].probability, 1);
}

TEST(Clustered, MeanOfEqualGroups) {
  slom::Estimator est;
  const auto level = est.insertRV(0.0, "level");
  std::vector<double> means(10);
  std::mt19937 engine(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 40; ++i) {
    const double y = normal(engine);
    means[static_cast<std::size_t>(i / 4)] += y / 4;
    est.insertMeasurement([](const auto& x) { return x; }, level, slom::measured(y), slom::group(i / 4));
  }
  est.optimize();
  double square = 0;
  for (const double mean : means) square += (mean - *level) * (mean - *level);
  // The variance of the mean of ten independent numbers, and Student's interval.
  const slom::Clustered c = slom::clustered(est);
  EXPECT_NEAR(c.covariance(level)(0, 0), square / 9 / 10, 1e-12);
  EXPECT_NEAR(c.interval(level, 0.95)[0], 2.2621571627409915 * std::sqrt(square / 90), 1e-9);
  EXPECT_NEAR(c.correlation(level, level)(0, 0), 1, 1e-12);
}

TEST(Clustered, FormsGroupsWithoutKeys) {
  Regression fit;
  fill(fit, {.has_levels = true});
  const MatrixXd C = slom::clustered(fit.est, {.by = {"set"}}).covariance(fit.line);
  const std::vector<slom::VarID<double>>& levels = fit.levels;
  const auto of = [&](const slom::ClusterBy& by) {
    return slom::clustered(fit.est, {.by = {by}}).covariance(fit.line);
  };
  // Priors of levels are in their groups, too.
  const MatrixXd with_priors = of(slom::ClusterBy::variables("level", levels));
  EXPECT_GT(relative(with_priors, C), 1e-6);
  EXPECT_LT(relative(of(slom::ClusterBy::variablesOf<double>()), with_priors), 1e-12);
  EXPECT_LT(relative(of(slom::ClusterBy::function(
                         "level",
                         [&](const slom::ClusterItem& item) -> std::optional<std::int64_t> {
                           for (std::size_t g = 0; g < levels.size(); ++g) {
                             if (item.label().empty() && item.dependsOn(levels[g]))
                               return static_cast<std::int64_t>(g);
                           }
                           return {};
                         })),
                     C),
            1e-9);
  EXPECT_LT(relative(of(slom::ClusterBy::blocks("set", 1)), C), 1e-9);
  const slom::Clustered pairs = slom::clustered(fit.est, {.by = {slom::ClusterBy::blocks("set", 2)}});
  EXPECT_EQ(pairs.groups().size(), 4U);  // 94 95, 96 97, 98 99, 100
  EXPECT_EQ(pairs.groups()[0], "set / 2 47");
}

TEST(Clustered, ByLabel) {
  slom::Estimator est;
  const auto level = est.insertRV(0.0, "level");
  const auto is = [](const auto& x) { return x; };
  for (const double z : {1.0, 2.0}) est.insertMeasurement(is, level, slom::measured(z), slom::named("tape"));
  for (const double z : {4.0, 3.0}) est.insertMeasurement(is, level, slom::measured(z), slom::named("laser"));
  est.optimize();
  const slom::Clustered c = slom::clustered(est, {.by = {slom::ClusterBy::label()}});
  EXPECT_EQ(c.groups(), (std::vector<std::string>{"tape", "laser"}));
  EXPECT_NEAR(c.covariance(level)(0, 0), 1, 1e-12);  // means 1.5 and 3.5
}

/// A level, measured by groups of two that follow each other.
struct Series {
  slom::Estimator est;
  slom::VarID<double> level = est.insertRV(0.0, "level");
  explicit Series(const std::vector<double>& common) {
    std::mt19937 engine(3);
    std::normal_distribution<double> normal(0, 0.1);
    for (std::size_t g = 0; g < common.size(); ++g) {
      for (int i = 0; i < 2; ++i)
        est.insertMeasurement([](const auto& x) { return x; }, level,
                              slom::measured(common[g] + normal(engine)), slom::group("image", g));
    }
    est.optimize();
  }
};

TEST(ClusteredInOrder, ChoosesTheLengthOfBlocks) {
  std::mt19937 engine(9);
  std::normal_distribution<double> normal;
  std::vector<double> independent(128), in_eights(128), drifting(128), few(12);
  double sum = 0;
  for (std::size_t g = 0; g < 128; ++g) {
    independent[g] = normal(engine);
    in_eights[g] = g % 8 == 0 ? normal(engine) : in_eights[g - 1];
    drifting[g] = sum += normal(engine);
  }
  for (double& y : few) y = normal(engine);
  const auto of = [](const Series& series) { return slom::clustered(series.est, {.ordered = true}); };
  const auto alone = [](const Series& series) { return slom::clustered(series.est); };

  const Series a(independent);
  EXPECT_LE(of(a).blockLength(a.level), 4);
  EXPECT_NEAR(of(a).standardDeviation(a.level)[0] / alone(a).standardDeviation(a.level)[0], 1, 0.3);
  EXPECT_EQ(of(a).notes(a.level).size(), 0U);
  EXPECT_EQ(alone(a).blockLength(a.level), 1);

  const Series b(in_eights);  // eight groups are worth one
  EXPECT_EQ(of(b).blockLength(b.level), 16);
  EXPECT_NEAR(of(b).standardDeviation(b.level)[0] / alone(b).standardDeviation(b.level)[0], std::sqrt(8),
              0.8);
  EXPECT_DOUBLE_EQ(of(b).covariance(b.level)(0, 0), std::pow(of(b).standardDeviation(b.level)[0], 2));

  const Series c(drifting);
  EXPECT_EQ(
      of(c).notes(c.level).at(0),
      "the variance still grows at the longest blocks of which there are enough; errors are shared over "
      "longer series, for example by a drift, and the variance is extrapolated from the growth, which is rough: "
      "level with blocks of 16 groups");
  EXPECT_GT(of(c).standardDeviation(c.level)[0], 2 * alone(c).standardDeviation(c.level)[0]);

  const Series d(few);
  EXPECT_EQ(
      of(d).notes().at(0),
      "there are only 12 groups by image in order: if neighbours are much alike, intervals hold less often "
      "than stated; 60 are better");
  few.resize(5);
  const Series e(few);
  EXPECT_EQ(
      of(e).notes().at(1),
      "there are too few groups by image to see whether neighbours share errors; 6 are needed, better 60");
  EXPECT_EQ(of(e).standardDeviation(e.level), alone(e).standardDeviation(e.level));
}

TEST(Clustered, Notes) {
  Regression fit;
  fill(fit, {.has_levels = true});
  const slom::Clustered c = slom::clustered(fit.est, {.by = {"set"}});
  const std::vector<std::string> general = {
      "there are only 7 groups by set: the variances are estimated from as few numbers, and are as uncertain "
      "as their degrees of freedom say",
      "3 measurements are in no group by set; such errors count as independent, as stated"};
  EXPECT_EQ(c.notes(), general);
  const std::vector<std::string> notes = c.notes(fit.levels[3]);
  ASSERT_EQ(notes.size(), 4U);
  EXPECT_EQ(notes[3].substr(0, 52), "one group (in brackets) determines most of a value, ");
  EXPECT_EQ(
      notes[2].substr(0, notes[2].rfind(": ")) + ": level",
      "a part of the variance comes from one group alone, or from measurements without a group; this part is "
      "taken as stated: level");
}

TEST(Clustered, Faults) {
  slom::Estimator est;
  const auto level = est.insertRV(0.0, "level");
  const auto difference = est.insertRV(0.0, "difference");
  const auto is = [](const auto& x) { return x; };
  est.insertMeasurement(is, level, slom::measured(1.0), slom::named("a"));
  est.insertMeasurement([](const auto& a, const auto& b) { return a - b; }, level, difference,
                        slom::measured(0.0), slom::named("b"));
  est.optimize();
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est); }),
      "[slom.no-groups] no measurement is in a group without a name; pass slom::group(key) to insertMeasurement, or "
      "group by slom::ClusterBy::variables, label or function");
  est.insertMeasurement(is, level, slom::measured(1.5), slom::group("image", 1));
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est); }),
      "[slom.not-a-minimum] clustered covariances need the values of a converged fit; call optimize() and "
      "check summary.converged");
  est.optimize();
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est); }),
      "[slom.too-few-groups] clustered covariances compare groups, and by image there is one group; group measurements "
      "so that there are at least two, better ten");
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est, {.by = {"corner"}}); }),
      "[slom.no-groups] no measurement is in a group of \"corner\"; there are image, as in {.by = {\"image\"}}");
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est, {.by = {slom::ClusterBy::variablesOf<double>()}}); }),
      "[slom.bad-group] measurement b #1 depends on level and on difference, but can be grouped by only one "
      "of them; "
      "list the variables in slom::ClusterBy::variables, or pass slom::group to insertMeasurement");
  EXPECT_EQ(messageOf([&] { slom::ClusterBy::blocks("image", 0); }),
            "[slom.bad-option] the length of blocks of \"image\" is 0; pass a positive number of keys");
  EXPECT_EQ(messageOf([&] {
              slom::clustered(est, {.by = {"image", "image", "image", "image", "image"}});
            }),
            "[slom.bad-option] measurements are to be grouped in 5 ways at once; pass at most 4");
  EXPECT_EQ(
      messageOf([&] { slom::clustered(est, {.most_columns = -3}); }),
      "[slom.bad-option] most_columns is -3; pass the number of columns of H^-1 that may be computed, such as 5000");
  EXPECT_EQ(
      messageOf([&] { est.propagate(is, Eigen::MatrixXd(2, 2), level); }),
      "[slom.wrong-length] propagate got a covariance of 2 x 2, but its variables have 1 degree of freedom "
      "together; pass their joint covariance, 1 x 1");
  const auto second = est.insertMeasurement(is, level, slom::measured(1.7), slom::group("image", 2));
  est.optimize();
  const slom::Clustered c = slom::clustered(est);
  EXPECT_EQ(
      messageOf([&] { c.interval(level, 1.5); }),
      "[slom.bad-option] the probability of an interval is 1.5; pass a number between 0 and 1, such as 0.95");
  est.removeMeasurement(second);
  const std::string stale =
      "[slom.stale-clustered] the clustered covariances belong to a fit that has changed or is gone; call "
      "slom::clustered(est) again";
  EXPECT_EQ(messageOf([&] { c.covariance(level); }), stale);
  EXPECT_EQ(messageOf([&] { c.check(); }), stale);
  EXPECT_EQ(messageOf([&] { c.groups(); }), stale);
  EXPECT_EQ(messageOf([&] { c.notes(); }), stale);
  est.optimize();
  EXPECT_EQ(messageOf([&] { c.covariance(level); }), stale);
  std::optional<slom::Clustered> left;
  {
    slom::Estimator gone;
    const auto x = gone.insertRV(0.0);
    for (int i = 0; i < 3; ++i) gone.insertMeasurement(is, x, slom::measured(1.0 * i), slom::group(i));
    gone.optimize();
    left = slom::clustered(gone);
  }
  EXPECT_EQ(messageOf([&] { left->covariance(level); }), stale);
}

TEST(Student, IsThatOfTheTables) {
  // From tables of Student's t, two-sided 5 %, 1 %, 10 %.
  EXPECT_NEAR(slom::studentCritical(0.05, 1), 12.706204736432095, 1e-9);
  EXPECT_NEAR(slom::studentCritical(0.05, 9), 2.2621571627409915, 1e-10);
  EXPECT_NEAR(slom::studentCritical(0.01, 5), 4.032142983557536, 1e-9);
  EXPECT_NEAR(slom::studentCritical(0.10, 100), 1.6602343260657506, 1e-9);
  EXPECT_NEAR(slom::studentCritical(0.05, std::numeric_limits<double>::infinity()), 1.959963984540054, 1e-10);
  EXPECT_NEAR(slom::studentCritical(0.05, 1e7), 1.959963984540054, 1e-6);
  EXPECT_NEAR(slom::studentProbability(1, 1), 0.5, 1e-13);
  EXPECT_EQ(slom::studentProbability(0, 3), 1);
  // t with 2 degrees of freedom in closed form, 2.5 between its neighbours.
  for (const double t : {0.1, 1.0, 3.0, 30.0})
    EXPECT_NEAR(slom::studentProbability(t, 2), 1 - t / std::sqrt(2 + t * t), 1e-13);
  EXPECT_LT(slom::studentProbability(2, 2.5), slom::studentProbability(2, 2));
  EXPECT_GT(slom::studentProbability(2, 2.5), slom::studentProbability(2, 3));
}

}  // namespace
