// Growth of the cost of calls on one variable: the time should be proportional to what a call touches, at any size.
//
//   bench_growth [MOST]      problems of 10^3, 10^4, ... up to MOST variables, 10^6 by default
//
// A first table is for chains of points, each measured from its neighbour. It shows nanoseconds per call for each size,
// and the cost of diagnose() in iterations of the fit, all in processor time. The program ends with status 1 if a call
// takes more than 8 times as long in the largest problem as in one of 10^4 variables. Caches explain part of such a
// factor.
//
// A second table is for a walk to and fro over a square of points. Each point is measured from the one before and from
// its neighbour in the previous row. The table shows the time of setup (structure, order of elimination, layout) in the
// next step of the fit after one change.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <slom/archive.hpp>
#include <slom/measurements/prior.hpp>
#include <slom/slom.hpp>

namespace {

using Point = mtk::vect<2>;
using Id = slom::VarID<Point>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMostGrowth = 8;

struct Step {
  static constexpr bool is_vectorized = true;
  auto operator()(const auto& a, const auto& b) const { return mtk::vector(b[0] - a[0], b[1] - a[1]); }
};
using StepId = slom::MeasID<slom::CallableMeasurement<Step, Id, Id, slom::Measured<Point>>>;

struct Chain {
  slom::Estimator est;
  std::vector<Id> points;
  std::vector<StepId> steps;
  explicit Chain(int size) {
    for (int i = 0; i < size; ++i) points.push_back(est.insertRV(Point(i, 0), "p" + std::to_string(i)));
    est.prior(points[0], Point(), 1);
    for (int i = 1; i < size; ++i) {
      steps.push_back(est.insertMeasurement(Step(), points[std::size_t(i - 1)], points[std::size_t(i)],
                                            slom::measured(Point(1, 0.1))));
    }
  }
};

/// Returns the processor time of all threads [s]; other programs on the machine do not count.
template <class F>
double seconds(const F& f) {
  const std::clock_t start = std::clock();
  f();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

/// Returns nanoseconds per variable.
template <class F>
double perCall(const std::vector<Id>& points, const F& f) {
  return 1e9 * seconds([&] {
           for (const Id& point : points) f(point);
         }) /
         static_cast<double>(points.size());
}

/// Returns names and times of all calls at this size.
std::vector<std::pair<std::string, double>> measure(int size) {
  Chain chain(size);
  slom::Estimator& est = chain.est;
  std::vector<std::pair<std::string, double>> times;
  double sum = 0;
  const auto add = [&](const char* name, const auto& f) {
    times.emplace_back(name, perCall(chain.points, f));
  };
  add("fix(id, \"x\")", [&](const Id& id) { est.fix(id, "x"); });
  add("free(id, \"x\")", [&](const Id& id) { est.free(id, "x"); });
  add("fix(id)", [&](const Id& id) { est.fix(id); });
  add("free(id)", [&](const Id& id) { est.free(id); });
  add("bound(id, \"y\", -1, inf)", [&](const Id& id) { est.bound(id, "y", -1, kInfinity); });
  add("reinitRV", [&](const Id& id) { est.reinitRV(id, *id); });
  add("bound(id, \"y\", -inf, inf)", [&](const Id& id) { est.bound(id, "y", -kInfinity, kInfinity); });
  est.getRSS(chain.points[0]);  // makes the problem's table of uses
  add("getRSS(id)", [&](const Id& id) { sum += est.getRSS(id); });
  add("prior, getRSS(id), removed", [&](const Id& id) {
    const auto prior = est.prior(id, Point(), 1);
    sum += est.getRSS(id);
    est.removeMeasurement(prior);
  });
  add("insertRV, removeRV", [&](const Id& id) { est.removeRV(est.insertRV(Point(*id))); });

  slom::Archive archive;
  archive.measurement<slom::Prior, Id, slom::Measured<Point>>();
  archive.measurement<Step, Id, Id, slom::Measured<Point>>();
  std::stringstream file;
  archive.save(est, file);
  const slom::StoredProblem stored = archive.load(file);
  int next = 0;
  add("variable(name)",
      [&](const Id&) { sum += (*stored.variable<Point>("p" + std::to_string(next++)))[0]; });
  if (!(sum < kInfinity)) std::printf("a sum is not finite\n");
  return times;
}

/// Returns the times of an iteration and of diagnose() [s].
std::pair<double, double> diagnosis(int size) {
  Chain chain(size);
  slom::Options options;
  options.max_iterations = 1;
  chain.est.optimize(options);
  const double iteration = seconds([&] {
    chain.est.reinitRV(chain.points[0], Point(1, 1));
    chain.est.optimizeStep();
  });
  return {iteration, seconds([&] { slom::diagnose(chain.est); })};
}

/// A walk to and fro over a square of about this many points.
class Walk {
 public:
  explicit Walk(int size) : width_(static_cast<int>(std::sqrt(size))) {
    while (static_cast<int>(points_.size()) < size) insertPoint();
    est_.prior(points_[0], Point(), 1);
    step();
  }

  void insertPoint() {
    const int i = static_cast<int>(points_.size()), row = i / width_, column = i % width_;
    points_.push_back(est_.insertRV(Point(row, column)));
    if (i > 0) insertStep(i - 1, i);
    if (row > 0 && column > 0) insertStep(row * width_ - 1 - column, i);
  }
  StepId insertStep(int from, int to) {
    return est_.insertMeasurement(Step(), points_[std::size_t(from)], points_[std::size_t(to)],
                                  slom::measured(Point(1, 0.1)));
  }
  slom::Estimator& est() { return est_; }
  const std::vector<Id>& points() const { return points_; }

  struct Seconds {
    double setup, rest;
  };
  Seconds step() {
    slom::Options options;
    options.max_iterations = 1;
    const slom::PhaseSeconds phases = est_.optimize(options).phases;
    return {phases.setup, phases.linearize + phases.factorize + phases.solve};
  }

 private:
  int width_;
  slom::Estimator est_;
  std::vector<Id> points_;
};

/// Returns milliseconds of setup in the step after a change, the least of some, and its ratio to the rest of the step.
std::vector<std::pair<std::string, std::string>> setups(int size) {
  Walk walk(size);
  slom::Estimator& est = walk.est();
  std::vector<std::pair<std::string, std::string>> result;
  const auto add = [&](const char* name, const auto& change) {
    Walk::Seconds best{1e300, 0};
    for (int i = 0; i < 5; ++i) {
      change(i);
      const Walk::Seconds now = walk.step();
      if (now.setup < best.setup) best = now;
    }
    char text[64];
    std::snprintf(text, sizeof text, "%.3g (%.2g)", 1e3 * best.setup, best.setup / best.rest);
    result.emplace_back(name, text);
  };
  const int middle = size / 2;
  const StepId extra = walk.insertStep(middle, middle + 1);
  add("a value is set", [&](int i) { est.reinitRV(walk.points()[1], Point(i, 1)); });
  add("one more prior", [&](int) { est.prior(walk.points()[std::size_t(middle)], Point(), 1); });
  add("one more step between neighbours", [&](int) { walk.insertStep(middle, middle + 1); });
  add("a step removed, another left", [&](int i) {
    if (i == 0)
      est.removeMeasurement(extra);
    else
      est.removeMeasurement(walk.insertStep(middle, middle + 1));
  });
  add("fix(id, \"x\")", [&](int i) { est.fix(walk.points()[std::size_t(i)], "x"); });
  add("the next point, two steps", [&](int) { walk.insertPoint(); });
  add("fix(id)", [&](int i) { est.fix(walk.points()[std::size_t(i + 10)]); });
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 1'000'000;
  std::vector<int> sizes;
  for (long size = 1000; size <= most; size *= 10) sizes.push_back(static_cast<int>(size));
  std::vector<std::vector<std::pair<std::string, double>>> columns;
  std::printf("| ns a call |");
  for (const int size : sizes) {
    columns.push_back(measure(size));
    std::printf(" %d |", size);
  }
  std::printf("\n| --- |");
  for (std::size_t i = 0; i < sizes.size(); ++i) std::printf(" --- |");
  bool grows = false;
  for (std::size_t row = 0; !columns.empty() && row < columns[0].size(); ++row) {
    std::printf("\n| %s |", columns[0][row].first.c_str());
    for (const auto& column : columns) std::printf(" %.0f |", column[row].second);
    if (columns.size() > 2 && columns.back()[row].second > kMostGrowth * columns[1][row].second) {
      std::printf(" grows");
      grows = true;
    }
  }
  std::printf("\n| slom::diagnose, in iterations |");
  for (const int size : sizes) {
    const auto [iteration, diagnose] = diagnosis(size);
    std::printf(" %.1f (of %.3g s) |", diagnose / iteration, iteration);
  }
  std::printf("\n\n| setup in ms after (of the rest of the step) |");
  std::vector<std::vector<std::pair<std::string, std::string>>> steps;
  for (const int size : sizes) {
    steps.push_back(setups(size));
    std::printf(" %d |", size);
  }
  std::printf("\n| --- |");
  for (std::size_t i = 0; i < sizes.size(); ++i) std::printf(" --- |");
  for (std::size_t row = 0; !steps.empty() && row < steps[0].size(); ++row) {
    std::printf("\n| %s |", steps[0][row].first.c_str());
    for (const auto& column : steps) std::printf(" %s |", column[row].second.c_str());
  }
  std::printf("\n");
  return grows ? 1 : 0;
}
