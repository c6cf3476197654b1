// Fits of small problems with arbitrary numbers: they end, and their claims about the end hold.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <variant>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>
#include <slom/solve/block_qr.hpp>
#include <slom/solve/block_solver.hpp>
#include <slom/solve/dense_qr.hpp>

#include "fuzz/fit/judge.hpp"
#include "fuzz/target.hpp"

namespace slom::fuzz {
namespace {

using namespace fit;
using Point2 = mtk::vect<2>;
using Point3 = mtk::vect<3>;
using Rotation = mtk::SO3<>;
using Pose2 = mtk::trafo<mtk::SO2<>>;
using Pose3 = mtk::trafo<mtk::SO3<>>;
using Handle =
    std::variant<VarID<double>, VarID<Point2>, VarID<Point3>, VarID<Rotation>, VarID<Pose2>, VarID<Pose3>>;

// ---- values
// ---------------------------------------------------------------------------------------------------

Rotation rotationOf(const double* c) { return Rotation(c[3], c[0], c[1], c[2]); }

template <class T>
T valueAs(const Value& v) {
  if constexpr (std::is_same_v<T, double>) {
    return v[0];
  } else if constexpr (std::is_same_v<T, Point2>) {
    return Point2(v[0], v[1]);
  } else if constexpr (std::is_same_v<T, Point3>) {
    return Point3(v[0], v[1], v[2]);
  } else if constexpr (std::is_same_v<T, Rotation>) {
    return rotationOf(v.data());
  } else if constexpr (std::is_same_v<T, Pose2>) {
    return Pose2(mtk::SO2<>(v[2]), Point2(v[0], v[1]));
  } else {
    return Pose3(rotationOf(v.data() + 3), Point3(v[0], v[1], v[2]));
  }
}

Value numbersOf(double x) { return {x}; }
Value numbersOf(const Point2& x) { return {x[0], x[1]}; }
Value numbersOf(const Point3& x) { return {x[0], x[1], x[2]}; }
Value numbersOf(const Rotation& x) { return {x.x(), x.y(), x.z(), x.w()}; }
Value numbersOf(const Pose2& x) { return {x.pos[0], x.pos[1], x.orient.angle()}; }
Value numbersOf(const Pose3& x) {
  return {x.pos[0], x.pos[1], x.pos[2], x.orient.x(), x.orient.y(), x.orient.z(), x.orient.w()};
}

std::vector<Value> valuesOf(const std::vector<Handle>& handles) {
  std::vector<Value> values;
  for (const Handle& handle : handles)
    values.push_back(std::visit([](const auto& id) { return numbersOf(*id); }, handle));
  return values;
}

bool areFinite(const Value& value) {
  return std::all_of(value.begin(), value.end(), [](double x) { return std::isfinite(x); });
}

// ---- the problem in the library
// -------------------------------------------------------------------------------

/// `model` of the numbers of its arguments.
struct ScalarOfPoint {
  int formula;
  std::array<double, 3> c;

  auto operator()(const auto& a) const {
    using T = std::decay_t<decltype(a[0] * 1.0)>;
    return model<T>(formula, c, T(a[0]), T(a[1]), T(a[2]));
  }
};

struct ScalarOfNumbers {
  int formula;
  std::array<double, 3> c;
  auto operator()(const auto& a, const auto& b) const {
    using T = std::decay_t<decltype(a * b)>;
    return model<T>(formula, c, T(a), T(b), T(0.0));
  }
};

/// With derivatives by differences.
struct NumericScalar {
  int formula;
  std::array<double, 3> c;
  double operator()(const double& a, const double& b) const { return model<double>(formula, c, a, b, 0.0); }
};

struct ScalarOfPointAndNumber {
  int formula;
  std::array<double, 3> c;
  auto operator()(const auto& a, const auto& b) const {
    using T = std::decay_t<decltype(a[0] * b)>;
    return model<T>(formula, c, T(a[0]), T(a[1]), T(b));
  }
};

void insert(Estimator& est, const Measurement& m, const Handle& a, const Handle& b) {
  const auto with = [&](const auto& f, const auto& z, const auto&... variables) {
    const StandardDeviation noise(m.sigma);
    m.loss == 0 ? est.insertMeasurement(f, variables..., measured(z), noise)
                : est.insertMeasurement(f, variables..., measured(z), noise, lossOf(m));
  };
  std::visit(
      [&]<class A, class B>(const VarID<A>& x, const VarID<B>& y) {
        constexpr bool are_same = std::is_same_v<A, B>;
        constexpr bool are_positions = are_same && !std::is_same_v<A, double> && !std::is_same_v<A, Rotation>;
        constexpr bool are_poses = are_same && (std::is_same_v<A, Pose2> || std::is_same_v<A, Pose3>);
        if constexpr (are_same) {
          if (m.kind == Kind::prior) return with(Prior(), valueAs<A>(m.z), x);
        }
        if constexpr (std::is_same_v<A, double> && std::is_same_v<B, double>) {
          if (m.kind == Kind::scalar) return with(ScalarOfNumbers{m.formula, m.c}, m.z[0], x, y);
          if (m.kind == Kind::numeric) return with(NumericScalar{m.formula, m.c}, m.z[0], x, y);
        }
        if constexpr (std::is_same_v<A, Point2> && std::is_same_v<B, double>) {
          if (m.kind == Kind::scalar) return with(ScalarOfPointAndNumber{m.formula, m.c}, m.z[0], x, y);
        }
        if constexpr (std::is_same_v<A, Point3> && std::is_same_v<B, Point3>) {
          if (m.kind == Kind::scalar) return with(ScalarOfPoint{m.formula, m.c}, m.z[0], x);
        }
        if constexpr (are_positions) {
          if (m.kind == Kind::range) return with(Range(), m.z[0], x, y);
        }
        if constexpr (are_poses) {
          if (m.kind == Kind::relative) return with(RelativePose(), valueAs<A>(m.z), x, y);
        }
        if constexpr (are_same && std::is_same_v<A, Rotation>) {
          if (m.kind == Kind::relative) return with(RelativeRotation(), valueAs<A>(m.z), x, y);
        }
        if constexpr ((std::is_same_v<A, Pose2> && std::is_same_v<B, Point2>) ||
                      (std::is_same_v<A, Pose3> && std::is_same_v<B, Point3>)) {
          if (m.kind == Kind::landmark) return with(Landmark(), valueAs<B>(m.z), x, y);
        }
        require(false, "a measurement of variables that it is not for");
      },
      a, b);
}

Handle insert(Estimator& est, const Variable& variable) {
  const auto insertAs = [&]<class T>(std::type_identity<T>) -> Handle {
    const auto id = est.insertRV(valueAs<T>(variable.start));
    const std::vector<std::string> names = est.componentNames(id);
    const auto path = [&](int component) {
      const std::string own = est.nameOf(id), whole = names[std::size_t(component)];
      return whole.size() > own.size() ? whole.substr(own.size() + 1) : std::string();
    };
    for (const int c : variable.fixed) path(c).empty() ? est.fix(id) : est.fix(id, path(c));
    for (const Bound& bound : variable.bounds) est.bound(id, path(bound.component), bound.lower, bound.upper);
    if (variable.is_fixed) est.fix(id);
    return id;
  };
  switch (variable.type) {
    case Type::number:
      return insertAs(std::type_identity<double>());
    case Type::point2:
      return insertAs(std::type_identity<Point2>());
    case Type::point3:
      return insertAs(std::type_identity<Point3>());
    case Type::rotation:
      return insertAs(std::type_identity<Rotation>());
    case Type::pose2:
      return insertAs(std::type_identity<Pose2>());
    default:
      return insertAs(std::type_identity<Pose3>());
  }
}

void choose(Estimator& est, const Problem& problem) {
  est.setThreads(1);
  if (problem.algorithm == 1) est.changeAlgorithm(GaussNewton());
  if (problem.algorithm == 2) est.changeAlgorithm(LevenbergMarquardt());
  if (problem.algorithm == 3) est.changeAlgorithm(DogLeg());
  if (problem.solver == 1) est.changeSolver(std::make_unique<BlockQR>());
  if (problem.solver == 2) est.changeSolver(std::make_unique<DenseQR>());
  if (problem.solver == 3) {
    est.changeSolver(std::make_unique<BlockSolver>(
        BlockSolverOptions{.method = BlockSolverOptions::Method::conjugate_gradients}));
  }
  if (problem.has_estimated_sigma) est.setSigma(Sigma::estimated);
}

// ---- what must hold
// -------------------------------------------------------------------------------------------

void requireInside(const Problem& problem, const std::vector<Value>& start,
                   const std::vector<Value>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Variable& variable = problem.variables[i];
    if (!areFinite(start[i])) continue;  // no measurement depends on it
    require(areFinite(values[i]), "a value is not finite");
    if (variable.is_fixed) require(values[i] == start[i], "a fixed variable has moved");
    for (const int c : variable.fixed) {
      if (c < positionOf(variable.type))
        require(values[i][std::size_t(c)] == start[i][std::size_t(c)], "a fixed component has moved");
    }
    for (const Bound& bound : variable.bounds) {
      const double x = values[i][std::size_t(bound.component)];
      require(bound.lower <= x && x <= bound.upper, "a value is outside its bounds");
    }
  }
}

/// Returns whether sums of squares are equal up to rounding.
bool areNear(long double a, long double b, long double rounding) {
  return std::abs(std::sqrt(a) - std::sqrt(b)) <= 1e-11L * std::sqrt(a) + 16 * rounding;
}

void requireHonest(const Problem& problem, const Summary& summary, const Estimator& est,
                   const std::vector<Value>& values) {
  require(!summary.message.empty(), "no message");
  // Sums of squares of such values leave the range of numbers in one order of operations and not in another.
  for (const Value& value : values) {
    if (std::any_of(value.begin(), value.end(), [](double x) { return std::abs(x) > 1e99; })) return;
  }
  const Judgement truth = judge(problem, values);
  require(std::isfinite(summary.final_rss) && summary.final_rss >= 0, "the final RSS is no sum of squares");
  const bool may_rise = problem.algorithm == 1 || problem.is_graduated;
  // Where the RSS is rounding error, which may be up to 1e-8 of it, the gradient decides.
  require(
      may_rise || summary.final_rss <= summary.initial_rss * (1 + 1e-8) ||
          areNear(summary.initial_rss, summary.final_rss, truth.rounding),
      "the RSS has risen: " + std::to_string(summary.initial_rss) + ", " + std::to_string(summary.final_rss));
  require(areNear(summary.final_rss, est.getRSS(), truth.rounding),
          "the final RSS is not that of the values");
  if (!truth.is_smooth) return;
  require(areNear(truth.rss, summary.final_rss, truth.rounding),
          "the final RSS is " + std::to_string(summary.final_rss) + " instead of " +
              std::to_string(double(truth.rss)));
  require(!summary.converged || !truth.is_false, "has not converged: " + truth.text + "; " + summary.message);
}

void requireDeviations(const Estimator& est, const std::vector<Handle>& handles) {
  for (const Handle& handle : handles) {
    accepted([&] {
      const Eigen::VectorXd s = std::visit([&](const auto& id) { return est.standardDeviation(id); }, handle);
      for (const double x : s) require(x >= 0, "a standard deviation is " + std::to_string(x));
    });
  }
  accepted([&] { require(!diagnose(est).text().empty(), "a diagnosis without a word"); });
  accepted([&] { require(est.getM() == 0 || !outliers(est).text().empty(), "no table of outliers"); });
}

}  // namespace
}  // namespace slom::fuzz

SLOM_FUZZ_TARGET(fit) {
  const Problem problem = anyProblem(input);
  Estimator est;
  std::vector<Handle> handles;
  const auto build = [&] {
    choose(est, problem);
    for (const Variable& variable : problem.variables) handles.push_back(insert(est, variable));
    for (const Measurement& m : problem.measurements)
      insert(est, m, handles[std::size_t(m.a)], handles[std::size_t(m.b)]);
  };
  if (!accepted(build)) return;
  const std::vector<Value> start = valuesOf(handles);
  Options options;
  options.max_iterations = problem.max_iterations;
  options.fall_back = problem.algorithm != 1;
  options.graduated_non_convexity = problem.is_graduated;
  Summary summary;
  const bool is_fitted = accepted([&] { summary = est.optimize(options); });
  const std::vector<Value> values = valuesOf(handles);
  requireInside(problem, start, values);  // steps that were complete before an error stay
  if (is_fitted) {
    requireHonest(problem, summary, est, values);
    require(!summary.report().empty(), "no report");
  }
  requireDeviations(est, handles);
}
