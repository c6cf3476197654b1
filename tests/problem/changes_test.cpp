// Following the changes of a problem gives the same result as examining all of it: the same structure and, bit by bit,
// the same steps and fits, after any sequence of insertions, removals, fixing, bounds and moves.
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements/gaussian_prior.hpp>
#include <slom/optimize/evaluator.hpp>
#include <slom/optimize/optimizer.hpp>
#include <slom/slom.hpp>
#include <slom/solve/block_solver.hpp>

#include "support/slow_with_sanitizers.hpp"

namespace {

using slom::Change;
using slom::MeasID;
using slom::Problem;
using slom::VarID;
using Point = mtk::vect<2>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct At {
  auto operator()(const auto& p, const Point& z) const { return mtk::vector(p[0] - z[0], p[1] - z[1]); }
};
struct Between {
  auto operator()(const auto& a, const auto& b, const Point& z) const {
    return mtk::vector(b[0] - a[0] - z[0], (b[1] - a[1] - z[1]) + 0.1 * sin(a[0] * b[1]));
  }
};
/// A measurement whose length is known at run time.
struct Scaled {
  Eigen::VectorXd operator()(const Point& a, double scale, const Point& b, int length) const {
    return Eigen::VectorXd::Constant(length, 0.3 * (scale * a[0] - b[1] - 1));
  }
};
using AtPoint = slom::CallableMeasurement<At, VarID<Point>, Point>;
using BetweenPoints = slom::CallableMeasurement<Between, VarID<Point>, VarID<Point>, Point>;
using ScaledPoints = slom::CallableMeasurement<Scaled, VarID<Point>, VarID<double>, VarID<Point>, int>;

/// A problem with random operations, and the operations left to do.
class Play {
 public:
  explicit Play(unsigned seed) : engine_(seed) {}

  Problem problem;

  struct Values {
    std::vector<Point> points;
    std::vector<double> numbers;
  };
  Values values() const {
    Values all;
    for (const auto& id : points_) all.points.push_back(*id);
    for (const auto& id : numbers_) all.numbers.push_back(*id);
    return all;
  }
  void restore(const Values& all) {
    for (std::size_t i = 0; i < points_.size(); ++i)
      problem.overwrite(problem.indexOf(points_[i]), &all.points[i]);
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      problem.overwrite(problem.indexOf(numbers_[i]), &all.numbers[i]);
  }

  void operate() {
    const int what = below(100);
    if (what < 18)
      insertVariable();
    else if (what < 45)
      insertMeasurement();
    else if (what < 60)
      removeMeasurement();
    else if (what < 70)
      removeVariable();
    else if (what < 77)
      problem.setOptimized(anyVariable(), below(3) > 0);
    else if (what < 84)
      problem.setFixed(anyVariable(), {0}, below(2) == 0);
    else if (what < 90)
      bound();
    else
      move();
  }

 private:
  int below(std::size_t n) { return static_cast<int>(engine_() % n); }
  double random() { return std::uniform_real_distribution<double>(-2, 2)(engine_); }
  Point randomPoint() {
    const double x = random();
    return Point(x, random());
  }
  const VarID<Point>& anyPoint() { return points_[std::size_t(below(points_.size()))]; }
  int anyVariable() {
    while (points_.size() < 2 || numbers_.empty()) insertVariable();
    return below(4) > 0 ? problem.indexOf(anyPoint())
                        : problem.indexOf(numbers_[std::size_t(below(numbers_.size()))]);
  }

  void insertVariable() {
    const bool is_optimized = below(10) > 0;
    if (below(4) > 0) {
      points_.push_back(problem.insertVariable(randomPoint(), is_optimized, ""));
    } else {
      numbers_.push_back(problem.insertVariable(random(), is_optimized, ""));
    }
  }
  void insertMeasurement() {
    anyVariable();
    const slom::StandardDeviation deviation(1.0 + below(3));
    const slom::NoiseView noise = slom::viewNoise(deviation);
    const VarID<Point> a = anyPoint(), b = anyPoint();
    const std::string label = below(8) == 0 ? "other" : "";
    const slom::Loss loss = below(4) == 0   ? slom::Loss(slom::Huber(0.5 + below(2)))
                            : below(6) == 0 ? slom::Loss(slom::Cauchy(1))
                                            : slom::Loss();
    const int kind = below(8);
    if (kind < 2)
      at_.push_back(problem.insertMeasurement(AtPoint(At(), a, randomPoint()), noise, label, loss));
    else if (kind < 6)
      between_.push_back(
          problem.insertMeasurement(BetweenPoints(Between(), a, b, randomPoint()), noise, label, loss));
    else if (kind == 6)
      insertPrior(label);
    else
      scaled_.push_back(problem.insertMeasurement(
          ScaledPoints(Scaled(), a, numbers_[std::size_t(below(numbers_.size()))], b, 1 + below(3)), noise,
          label));
  }
  /// Over a number of variables that is known at run time; one may be there twice.
  void insertPrior(const std::string& label) {
    std::vector<slom::AnyVarID> ids;
    int dof = 0;
    for (int k = below(3); k >= 0; --k) {
      const bool is_number = below(3) == 0;
      if (is_number) {
        ids.emplace_back(numbers_[std::size_t(below(numbers_.size()))]);
      } else {
        ids.emplace_back(anyPoint());
      }
      dof += is_number ? 1 : 2;
    }
    Eigen::MatrixXd R(1 + below(4), dof);
    for (double& x : R.reshaped()) x = random();
    Eigen::VectorXd b(R.rows());
    for (double& x : b) x = random();
    priors_.push_back(
        problem.insertMeasurement(slom::GaussianPrior(ids, R, b), slom::NoiseView(), label, slom::Loss()));
  }
  template <class M>
  void removeOne(std::vector<MeasID<M>>& all) {
    if (all.empty()) return;
    const auto which = all.begin() + below(all.size());
    const auto [pool, i] = problem.locate(*which);
    problem.removeMeasurement(*pool, i);
    all.erase(which);
  }
  void removeMeasurement() {
    const int kind = below(5);
    if (kind == 0)
      removeOne(at_);
    else if (kind == 4)
      removeOne(priors_);
    else if (kind == 1)
      removeOne(scaled_);
    else
      removeOne(between_);
  }
  template <class T>
  void removeUnused(std::vector<VarID<T>>& all) {
    for (auto id = all.begin(); id != all.end(); ++id) {
      const int variable = problem.indexOf(*id);
      if (problem.variables()[std::size_t(variable)].uses > 0) continue;
      problem.removeVariable(variable);
      all.erase(id);
      return;
    }
  }
  void removeVariable() { below(3) == 0 ? removeUnused(numbers_) : removeUnused(points_); }
  void bound() {
    anyVariable();
    const VarID<Point> point = anyPoint();
    const bool is_free = below(2) == 0;
    const double x = (*point)[1];
    problem.setBound(problem.indexOf(point), {1}, is_free ? -kInfinity : x - 0.1,
                     is_free ? kInfinity : x + below(2));
  }
  void move() {
    anyVariable();
    const VarID<Point> point = anyPoint();
    const auto& bounds = problem.activeSet().bounds(problem.indexOf(point));
    problem.setValue(point, Point(random(), bounds.empty() ? random() : (*point)[1]));
  }

  std::mt19937 engine_;
  std::vector<VarID<Point>> points_;
  std::vector<VarID<double>> numbers_;
  std::vector<MeasID<AtPoint>> at_;
  std::vector<MeasID<BetweenPoints>> between_;
  std::vector<MeasID<ScaledPoints>> scaled_;
  std::vector<MeasID<slom::GaussianPrior>> priors_;
};

/// Equal to the last bit, NaN included.
::testing::AssertionResult areSameBits(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return ::testing::AssertionFailure() << a.size() << " numbers, not " << b.size();
  if (std::memcmp(a.data(), b.data(), sizeof(double) * std::size_t(a.size())) != 0)
    return ::testing::AssertionFailure() << a.transpose() << "\nis not\n" << b.transpose();
  return ::testing::AssertionSuccess();
}

Eigen::VectorXd coordinatesOf(const Problem& problem) {
  std::vector<double> all;
  for (const slom::VariableRecord& record : problem.variables()) {
    if (record.store == nullptr) continue;
    std::vector<double> x(std::size_t(record.dof));
    record.store->coordinates(record.store->valueAt(record.slot), x.data());
    all.insert(all.end(), x.begin(), x.end());
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), Eigen::Index(all.size()));
}

/// A fit with all its results.
struct Fit {
  explicit Fit(Problem& p) : problem(p) { evaluator.setSolver(solver); }

  struct Result {
    Eigen::VectorXd gradient, diagonal, step, end;
    std::string description;
    double rss;
    int iterations;
  };
  Result run() {
    Result result;
    evaluator.linearize();
    result.gradient = solver.gradient();
    result.diagonal = solver.diagonal();
    static_cast<void>(
        evaluator.solveDamped(Eigen::VectorXd::Constant(result.diagonal.size(), 0.1), result.step));
    slom::LevenbergMarquardt algorithm;
    slom::RankAtEnd rank;
    const slom::Summary summary =
        slom::runAlgorithm(evaluator, algorithm, {.max_iterations = 5}, false, rank, {});
    result.end = coordinatesOf(problem);
    result.rss = summary.final_rss;
    result.iterations = summary.iterations;
    result.description = solver.description();
    return result;
  }

  Problem& problem;
  slom::Linearizer linearizer;
  slom::Evaluator evaluator{problem, linearizer};
  slom::BlockSolver solver;
};

void expectToFollow(unsigned seed, int operations) {
  Play play(seed);
  slom::ProblemStructure each = slom::makeStructure(play.problem), some = each;
  std::uint64_t each_at = play.problem.structureRevision(), some_at = each_at;
  std::mt19937 pauses(seed);
  for (int i = 0; i < operations; ++i) {
    play.operate();
    const slom::ProblemStructure whole = slom::makeStructure(play.problem);
    const slom::ProblemStructure before = each;
    const auto changes = play.problem.changesSince(each_at);
    ASSERT_TRUE(changes);
    const slom::StructureChanges said = slom::updateStructure(play.problem, *changes, each);
    each_at = play.problem.structureRevision();
    ASSERT_EQ(each, whole) << "seed " << seed << ", operation " << i;
    ASSERT_TRUE(said.any() || each.system == before.system);
    ASSERT_TRUE(said.blocks || each.system.unknowns() == before.system.unknowns());
    if (pauses() % 50 != 0) continue;  // many changes at once
    slom::updateStructure(play.problem, *play.problem.changesSince(some_at), some);
    some_at = play.problem.structureRevision();
    ASSERT_EQ(some, whole) << "seed " << seed << ", operation " << i;
  }
}

TEST(Changes, LeadToTheStructureThatIsMadeFromScratch) {
  const int operations = slom::testing::hasSanitizers() ? 2000 : 10'000;
  for (unsigned seed = 1; seed <= 3 && !HasFailure(); ++seed) expectToFollow(seed, operations);
  // Small problems, in which what there is goes away again.
  const unsigned last = slom::testing::hasSanitizers() ? 100 : 1000;
  for (unsigned seed = 4; seed <= last && !HasFailure(); ++seed) expectToFollow(seed, 60);
}

TEST(Changes, LeadToTheFitsThatAreMadeFromScratchBitByBit) {
  const int operations = slom::testing::hasSanitizers() ? 1000 : 10'000;
  Play play(4);
  Fit follows(play.problem);
  long kept = 0, fits = 0;
  for (int i = 0; i < operations; ++i) {
    play.operate();
    if (i % 64 > 3 || play.problem.freeCount() == 0) continue;  // after many changes, and after one
    ++fits;
    const long before = follows.solver.counts().analyses;
    const Play::Values values = play.values();
    const Fit::Result a = follows.run();
    kept += follows.solver.counts().analyses == before ? 1 : 0;
    play.restore(values);
    Fit scratch(play.problem);
    const Fit::Result b = scratch.run();
    ASSERT_EQ(a.description, b.description);
    ASSERT_TRUE(areSameBits(a.gradient, b.gradient)) << "operation " << i;
    ASSERT_TRUE(areSameBits(a.diagonal, b.diagonal)) << "operation " << i;
    ASSERT_TRUE(areSameBits(a.step, b.step)) << "operation " << i;
    ASSERT_TRUE(areSameBits(a.end, b.end)) << "operation " << i;
    ASSERT_EQ(a.iterations, b.iterations);
    ASSERT_EQ(a.rss, b.rss);
  }
  EXPECT_GT(kept, fits / 20);  // both ways were taken
  EXPECT_LT(kept, fits);
}

std::vector<Change> changesSince(const Problem& problem, std::uint64_t revision) {
  const auto changes = problem.changesSince(revision);
  EXPECT_TRUE(changes);
  return changes ? std::vector<Change>(changes->begin(), changes->end()) : std::vector<Change>();
}

TEST(Changes, AreSaidOneByOne) {
  using Kind = Change::Kind;
  Problem problem;
  const slom::NoiseView unit;
  const auto a = problem.insertVariable(Point(1, 2), true, "a");
  const std::uint64_t start = problem.structureRevision();
  const auto b = problem.insertVariable(Point(3, 4), false, "b");
  const auto first = problem.insertMeasurement(AtPoint(At(), a, Point()), unit);
  problem.insertMeasurement(BetweenPoints(Between(), a, b, Point()), unit);
  problem.insertMeasurement(AtPoint(At(), b, Point()), unit);
  problem.setOptimized(problem.indexOf(b), true);
  problem.setOptimized(problem.indexOf(b), true);  // is already
  problem.setFixed(problem.indexOf(a), {0}, true);
  problem.setBound(problem.indexOf(b), {1}, 0, 9);
  const auto [pool, i] = problem.locate(first);
  problem.removeMeasurement(*pool, i);
  problem.setValue(a, Point(5, 6));  // does not change the structure
  const std::vector<Change> expected{{Kind::variable_inserted, 1, -1},   {Kind::measurement_inserted, 0, 0},
                                     {Kind::measurement_inserted, 0, 1}, {Kind::measurement_inserted, 1, 0},
                                     {Kind::variable_freed, 1, -1},      {Kind::constraint, 0, -1},
                                     {Kind::constraint, 1, -1},          {Kind::measurement_removed, 0, 0}};
  EXPECT_EQ(changesSince(problem, start), expected);
  EXPECT_TRUE(changesSince(problem, problem.structureRevision()).empty());
  EXPECT_FALSE(problem.changesSince(problem.structureRevision() + 1));
}

TEST(Changes, AreForgottenWhereTheyAreManyForTheProblem) {
  Problem problem;
  const auto a = problem.insertVariable(Point(1, 2), true, "a");
  const std::uint64_t start = problem.structureRevision();
  for (int i = 0; i < 1000; ++i) problem.setOptimized(problem.indexOf(a), i % 2 == 1);
  EXPECT_EQ(changesSince(problem, start).size(), 1000u);
  for (int i = 0; i < 1000; ++i) problem.setOptimized(problem.indexOf(a), i % 2 == 1);
  EXPECT_FALSE(problem.changesSince(start));
  EXPECT_EQ(problem.structureRevision(), start + 2000);
  EXPECT_EQ(changesSince(problem, start + 1990).size(), 10u);
}

TEST(Changes, OfValuesSayWhichAndHowFar) {
  Problem problem;
  const auto a = problem.insertVariable(Point(1, 2), true, "a");
  const auto b = problem.insertVariable(mtk::SO3<>(), true, "b");
  const int ia = problem.indexOf(a), ib = problem.indexOf(b);
  const std::uint64_t start = problem.valueRevision();
  problem.setValue(b, mtk::SO3<>::exp(mtk::vect<3>(0, -0.5, 0.25)));
  problem.setValue(a, Point(1, 5));
  problem.setValue(a, Point(0, 5));
  ASSERT_TRUE(problem.movedSince(start));
  EXPECT_EQ(std::vector<int>(problem.movedSince(start)->begin(), problem.movedSince(start)->end()),
            (std::vector<int>{ib, ia, ia}));
  EXPECT_DOUBLE_EQ(problem.travelled(ia), 4);
  EXPECT_NEAR(problem.travelled(ib), 0.5, 1e-12);

  const std::uint64_t before_step = problem.valueRevision();
  const double step[] = {0.5, -2, 0, 0, 0.125};
  problem.save();
  problem.applyStep(slom::makeStructure(problem).system.offset, step);
  EXPECT_DOUBLE_EQ(problem.travelled(ia), 6);
  EXPECT_NEAR(problem.travelled(ib), 0.625, 1e-12);
  ASSERT_EQ(problem.movedSince(before_step)->size(), 1u);
  EXPECT_EQ(problem.movedSince(before_step)->front(), Problem::kAll);
  problem.restore();
  EXPECT_DOUBLE_EQ(problem.travelled(ia), 4);
  EXPECT_NEAR(problem.travelled(ib), 0.5, 1e-12);

  problem.setValue(a, Point(std::nan(""), 0));
  EXPECT_EQ(problem.travelled(ia), kInfinity);
}

}  // namespace
