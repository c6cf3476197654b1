// After any sequence of operations, an estimator equals one that is built directly from what remains: the same RSS, in
// total and for each variable, the same numbers of unknowns and residuals, the same fit.
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <slom/measurements/landmark.hpp>
#include <slom/measurements/prior.hpp>
#include <slom/measurements/relative_pose.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace {

using slom::Estimator;
using slom::testing::messageOf;
using Point = mtk::vect<2>;
using Pose = mtk::trafo<mtk::SO2<>>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class Type { number, point, pose };

/// Expected state of a variable: its handle in the estimator under test, its value there, and its fixed or bounded
/// components.
struct Variable {
  Type type;
  slom::VarID<double> number;
  slom::VarID<Point> point;
  slom::VarID<Pose> pose;
  bool is_optimized = true;
  std::vector<char> fixed;
  std::vector<std::pair<double, double>> bounds;  // bounds of each component
  int uses = 0;

  int dof() const { return type == Type::number ? 1 : type == Type::point ? 2 : 3; }
  template <class F>
  decltype(auto) visit(const F& f) const {
    return type == Type::number ? f(number) : type == Type::point ? f(point) : f(pose);
  }
  std::string path(int c) const {
    const char* const names[] = {"x", "y", "pos.x", "pos.y", "orient.angle"};
    return type == Type::number ? "" : names[(type == Type::pose ? 2 : 0) + c];
  }
  double coordinate(int c) const {
    return type == Type::number  ? *number
           : type == Type::point ? (*point)[c]
           : c < 2               ? pose->pos[c]
                                 : pose->orient.angle();
  }
};

struct Slope {
  auto operator()(const auto& p, const auto& s) const { return p[0] + 2.0 * p[1] - s; }
};
struct Way {
  auto operator()(const auto& a, const auto& b) const { return mtk::vector(b[0] - a[0], b[1] - a[1]); }
};

/// Expected state of a measurement, and its handle.
struct Measurement {
  int a, b;  // numbers of variables; b = -1 for a prior
  double z[3], sigma;
  bool is_robust;
  std::function<void(Estimator&)> remove;
  std::function<double(Estimator&)> rss;

  void insert(Estimator& est, const std::vector<Variable>& all) {
    const auto with = [&](auto f, const auto&... arguments) {
      const slom::StandardDeviation noise(sigma);
      const auto id = is_robust ? est.insertMeasurement(f, arguments..., noise, slom::Huber(1.345))
                                : est.insertMeasurement(f, arguments..., noise);
      remove = [id](Estimator& e) { e.removeMeasurement(id); };
      rss = [id](Estimator& e) { return e.getRSS(id); };
    };
    const Pose pose(mtk::SO2<>(z[2]), Point(z[0], z[1]));
    const Variable& x = all[std::size_t(a)];
    if (b < 0) {
      if (x.type == Type::number) return with(slom::Prior(), x.number, slom::measured(z[0]));
      if (x.type == Type::point) return with(slom::Prior(), x.point, slom::measured(Point(z[0], z[1])));
      return with(slom::Prior(), x.pose, slom::measured(pose));
    }
    const Variable& y = all[std::size_t(b)];
    if (x.type == Type::pose && y.type == Type::pose)
      return with(slom::RelativePose(), x.pose, y.pose, slom::measured(pose));
    if (x.type == Type::pose && y.type == Type::point)
      return with(slom::Landmark(), x.pose, y.point, slom::measured(Point(z[0], z[1])));
    if (x.type == Type::point && y.type == Type::point)
      return with(Way(), x.point, y.point, slom::measured(Point(z[0], z[1])));
    with(Slope(), x.point, y.number, slom::measured(z[0]));
  }
};

class Sequence {
 public:
  explicit Sequence(unsigned seed) : engine_(seed) {
    est_.setThreads(1);
    for (int i = 0; i < 3; ++i) insertVariable();
  }

  void run() {
    for (int i = 0; i < 12 && !::testing::Test::HasFailure(); ++i) {
      operate();
      if (i % 4 == 3) compare();
    }
  }

 private:
  double random(double size = 1) { return size * std::uniform_real_distribution<double>(-1, 1)(engine_); }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
  Variable& anyVariable() { return variables_[std::size_t(below(static_cast<int>(variables_.size())))]; }

  void insertVariable() {
    Variable v;
    v.type = static_cast<Type>(below(3));
    if (v.type == Type::number) v.number = est_.insertRV(random(3));
    if (v.type == Type::point) v.point = est_.insertRV(Point(random(3), random(3)));
    if (v.type == Type::pose) v.pose = est_.insertRV(Pose(mtk::SO2<>(random()), Point(random(3), random(3))));
    v.fixed.assign(std::size_t(v.dof()), 0);
    v.bounds.assign(std::size_t(v.dof()), {-kInfinity, kInfinity});
    variables_.push_back(v);
    if (below(20) > 0) insertMeasurement(static_cast<int>(variables_.size()) - 1, -1);
  }
  void insertMeasurement(int a, int b) {
    Measurement m{a, b, {random(3), random(3), random()}, 0.1 + std::abs(random()), below(4) == 0, {}, {}};
    m.insert(est_, variables_);
    measurements_.push_back(m);
    ++variables_[std::size_t(a)].uses;
    if (b >= 0) ++variables_[std::size_t(b)].uses;
  }
  void insertBetween() {
    const int a = below(static_cast<int>(variables_.size())), b = below(static_cast<int>(variables_.size()));
    const Type x = variables_[std::size_t(a)].type, y = variables_[std::size_t(b)].type;
    const bool fits = x == Type::pose ? y != Type::number : x == Type::point && y != Type::pose;
    if (a != b && fits) insertMeasurement(a, b);
  }
  void removeMeasurement() {
    if (measurements_.empty()) return;
    const auto at = measurements_.begin() + below(static_cast<int>(measurements_.size()));
    at->remove(est_);
    EXPECT_NE(messageOf([&] { at->rss(est_); }).find("[slom.stale-handle]"), std::string::npos);
    --variables_[std::size_t(at->a)].uses;
    if (at->b >= 0) --variables_[std::size_t(at->b)].uses;
    measurements_.erase(at);
  }
  void removeVariable() {
    const int i = below(static_cast<int>(variables_.size()));
    const std::string message =
        messageOf([&] { variables_[std::size_t(i)].visit([&](const auto& id) { est_.removeRV(id); }); });
    if (variables_[std::size_t(i)].uses > 0) {
      EXPECT_NE(message.find("[slom.variable-in-use]"), std::string::npos) << message;
      return;
    }
    EXPECT_EQ(message, "no error");
    variables_.erase(variables_.begin() + i);
    for (Measurement& m : measurements_) {
      m.a -= m.a > i ? 1 : 0;
      m.b -= m.b > i ? 1 : 0;
    }
    if (variables_.empty()) insertVariable();
  }
  void fixOrFree() {
    Variable& v = anyVariable();
    const int c = below(v.dof());
    const bool is_fixed = below(2) == 0;
    if (v.type == Type::number || below(3) == 0) {
      v.visit([&](const auto& id) { is_fixed ? est_.fix(id) : est_.free(id); });
      v.is_optimized = !is_fixed;
      if (!is_fixed) v.fixed.assign(std::size_t(v.dof()), 0);
    } else {
      v.visit([&](const auto& id) { is_fixed ? est_.fix(id, v.path(c)) : est_.free(id, v.path(c)); });
      v.fixed[std::size_t(c)] = is_fixed ? 1 : 0;
    }
  }
  void bound() {
    Variable& v = anyVariable();
    const int c = below(v.dof());
    if (v.type == Type::pose && c == 2) return;  // an angle has no coordinate
    const double x = v.coordinate(c), width = std::abs(random(2));
    const bool is_open = below(3) == 0;
    const double lower = is_open ? -kInfinity : x - width,
                 upper = is_open && below(2) == 0 ? kInfinity : x + std::abs(random());
    v.visit([&](const auto& id) {
      v.type == Type::number ? est_.bound(id, lower, upper) : est_.bound(id, v.path(c), lower, upper);
    });
    v.bounds[std::size_t(c)] = {lower, upper};
    EXPECT_NE(messageOf([&] {
                v.visit([&](const auto& id) { est_.bound(id, v.path(c), x + 1, x + 2); });
              }).find("[slom.outside-bound]"),
              std::string::npos);
  }
  void setValue() {
    Variable& v = anyVariable();
    for (const auto& [lower, upper] : v.bounds) {
      if (std::isfinite(lower) || std::isfinite(upper)) return;
    }
    if (v.type == Type::number) est_.reinitRV(v.number, random(3));
    if (v.type == Type::point) est_.reinitRV(v.point, Point(random(3), random(3)));
    if (v.type == Type::pose) est_.reinitRV(v.pose, Pose(mtk::SO2<>(random()), Point(random(3), random(3))));
  }
  void query() {
    Variable& v = anyVariable();
    (void)messageOf([&] { v.visit([&](const auto& id) { est_.covariance(id); }); });
    (void)messageOf([&] { slom::diagnose(est_); });
    (void)messageOf([&] { slom::outliers(est_); });
    est_.warnings();
    v.visit([&](const auto& id) { return est_.getRSS(id); });
  }
  void move() {
    Estimator other = std::move(est_);
    est_ = std::move(other);
  }
  void operate() {
    switch (below(12)) {
      case 0:
        return insertVariable();
      case 1:
      case 2:
      case 3:
        return insertBetween();
      case 4:
        return removeMeasurement();
      case 5:
        return removeVariable();
      case 6:
        return fixOrFree();
      case 7:
        return bound();
      case 8:
        return setValue();
      case 9:
        return query();
      case 10:
        return move();
      default:
        est_.optimize();
    }
  }

  /// The same problem, inserted at once.
  Estimator batch(std::vector<Variable>& own) const {
    Estimator est;
    est.setThreads(1);
    for (Variable& v : own) {
      if (v.type == Type::number) v.number = est.insertRV(*v.number);
      if (v.type == Type::point) v.point = est.insertRV(Point(*v.point));
      if (v.type == Type::pose) v.pose = est.insertRV(Pose(*v.pose));
      v.visit([&](const auto& id) {
        for (int c = 0; c < v.dof(); ++c) {
          if (v.fixed[std::size_t(c)] != 0) est.fix(id, v.path(c));
          const auto [lower, upper] = v.bounds[std::size_t(c)];
          if (std::isfinite(lower) || std::isfinite(upper)) est.bound(id, v.path(c), lower, upper);
        }
        if (!v.is_optimized) est.fix(id);
      });
    }
    for (Measurement m : measurements_) m.insert(est, own);
    return est;
  }

  void compare() {
    std::vector<Variable> own = variables_;
    Estimator fresh = batch(own);
    const double rss = fresh.getRSS();
    EXPECT_NEAR(est_.getRSS(), rss, 1e-12 * (1 + rss));
    EXPECT_EQ(est_.getN(), fresh.getN());
    EXPECT_EQ(est_.getM(), fresh.getM());
    EXPECT_EQ(est_.warnings().size(), fresh.warnings().size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      const double expected = own[i].visit([&](const auto& id) { return fresh.getRSS(id); });
      EXPECT_NEAR(variables_[i].visit([&](const auto& id) { return est_.getRSS(id); }), expected,
                  1e-12 * (1 + expected));
    }
    const slom::Summary a = est_.optimize(), b = fresh.optimize();
    EXPECT_EQ(a.converged, b.converged) << a.message << "\n" << b.message;
    EXPECT_EQ(a.variables, b.variables);
    if (!a.converged || !b.converged) return;
    EXPECT_EQ(a.unknowns, b.unknowns);
    EXPECT_EQ(a.redundancy, b.redundancy);
    EXPECT_NEAR(a.final_rss, b.final_rss, 1e-8 * (1 + b.final_rss));
    EXPECT_NEAR(est_.getRSS(), a.final_rss, 1e-12 * (1 + a.final_rss));
    for (std::size_t i = 0; i < own.size(); ++i) {
      for (int c = 0; c < own[i].dof(); ++c) {
        const double gap = variables_[i].coordinate(c) - own[i].coordinate(c);
        EXPECT_NEAR(c == 2 ? std::remainder(gap, 2 * M_PI) : gap, 0, 1e-4) << "variable " << i;
      }
    }
  }

  std::mt19937 engine_;
  Estimator est_;
  std::vector<Variable> variables_;
  std::vector<Measurement> measurements_;
};

TEST(Sequences, OfAllOperationsEqualABatch) {
  const unsigned sequences = slom::testing::hasSanitizers() ? 1'000 : 2'500;  // 1000 take the same branches
  for (unsigned seed = 0; seed < sequences; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Sequence(seed).run();
    if (HasFailure()) break;
  }
}

}  // namespace
