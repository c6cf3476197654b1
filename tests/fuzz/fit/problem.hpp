// A small problem made of arbitrary bytes, in plain numbers, for the library and for the judge of its fit.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "fuzz/fit/bytes.hpp"

namespace slom::fuzz::fit {

enum class Type { number, point2, point3, rotation, pose2, pose3 };
constexpr int kTypes = 6;
inline int dofOf(Type type) { return std::array{1, 2, 3, 3, 3, 6}[std::size_t(type)]; }
/// Coordinates of a vector, or of the position of a pose, with which a value begins.
inline int positionOf(Type type) { return std::array{1, 2, 3, 0, 2, 3}[std::size_t(type)]; }

/// A value: the position, then an angle or a quaternion (x, y, z, w).
using Value = std::array<double, 7>;

struct Bound {
  int component;
  double lower, upper;
};

struct Variable {
  Type type;
  Value start{};
  bool is_fixed = false;
  std::vector<int> fixed;  ///< components
  std::vector<Bound> bounds;
};

enum class Kind {
  prior,     ///< a [-] z
  scalar,    ///< model(...) - z of numbers and vectors
  numeric,   ///< the same of two numbers, with derivatives by differences
  range,     ///< |b - a| - z
  relative,  ///< relative poses or rotations
  landmark,  ///< a^-1 b - z
};

inline bool isScalar(Kind kind) { return kind == Kind::scalar || kind == Kind::numeric; }

struct Measurement {
  Kind kind;
  int a, b;     ///< variables; b is a where there is one alone
  int formula;  ///< formula of `model`
  std::array<double, 3> c{};
  Value z{};
  double sigma = 1;
  int loss = 0;  ///< 0: none
  double scale = 1, shape = 0;
};

constexpr int kFormulas = 7;

/// A function of up to three unknowns.
template <class T>
T model(int formula, const std::array<double, 3>& c, const T& u, const T& v, const T& w) {
  using std::exp;
  using std::sin;
  switch (formula) {
    case 0:
      return T(c[0] * u + c[1] * v + c[2] * w);
    case 1:
      return T(c[0] * u * v + c[2] * w);
    case 2:
      return T(u * exp(c[0] * v) + c[2] * w);
    case 3:
      return T(c[0] * u * u + c[1] * v * v * v + c[2] * w);
    case 4:
      return T(c[0] * u / (v + c[1]) + c[2] * w);
    case 5:
      return T(u * sin(c[0] * v + w) + c[1]);
    default:
      return T((u - c[0]) * (v - c[1]) * (u - v) + c[2] * w);
  }
}

struct Problem {
  std::vector<Variable> variables;
  std::vector<Measurement> measurements;
  int algorithm = 0;  ///< default, Gauss-Newton without fall back, Levenberg-Marquardt, dog leg
  int solver = 0;     ///< default, BlockQR, DenseQR, conjugate gradients
  int max_iterations = 200;
  bool is_graduated = false, has_estimated_sigma = false;
};

/// Whether there is such a measurement of these.
inline bool fits(Kind kind, Type a, Type b) {
  switch (kind) {
    case Kind::prior:
      return true;
    case Kind::scalar:
      return (a <= Type::point2 && b == Type::number) || (a == Type::point3 && b == Type::point3);
    case Kind::numeric:
      return a == Type::number && b == Type::number;
    case Kind::range:
      return positionOf(a) > 1 && a == b;
    case Kind::relative:
      return a >= Type::rotation && a == b;
    default:
      return (a == Type::pose2 && b == Type::point2) || (a == Type::pose3 && b == Type::point3);
  }
}

inline Value anyValue(Bytes& bytes, Type type) {
  Value value{};
  const int n = positionOf(type);
  for (int i = 0; i < n; ++i) value[std::size_t(i)] = bytes.number();
  if (type == Type::pose2) value[2] = bytes.number();
  if (type == Type::rotation || type == Type::pose3) {
    for (int i = 0; i < 4; ++i) value[std::size_t(n + i)] = bytes.number();
  }
  return value;
}

inline Variable anyVariable(Bytes& bytes) {
  Variable variable{Type(bytes.below(kTypes)), {}, false, {}, {}};
  variable.start = anyValue(bytes, variable.type);
  const int fixed = bytes.byte();
  variable.is_fixed = fixed >= 0xF0;
  if (fixed % 8 == 7) variable.fixed.push_back(bytes.below(dofOf(variable.type)));
  if (fixed % 16 >= 13 && positionOf(variable.type) > 0) {
    const int component = bytes.below(positionOf(variable.type));
    const double x = variable.start[std::size_t(component)], width = std::abs(bytes.number());
    constexpr double infinity = std::numeric_limits<double>::infinity();
    variable.bounds.push_back(
        {component, fixed % 16 == 13 ? -infinity : x - width, fixed % 16 == 14 ? infinity : x + width / 2});
  }
  return variable;
}

inline Problem anyProblem(std::string_view input) {
  Bytes bytes(input);
  Problem problem;
  problem.algorithm = bytes.below(4);
  problem.solver = bytes.below(4);
  const int options = bytes.byte();
  problem.max_iterations = options % 8 == 7 ? options / 8 : 200;
  problem.is_graduated = options % 16 == 14;
  problem.has_estimated_sigma = options % 16 == 13;
  for (int n = 1 + bytes.below(6); n > 0; --n) problem.variables.push_back(anyVariable(bytes));
  while (!bytes.isEmpty() && problem.measurements.size() < 24) {
    Measurement m{};
    m.kind = Kind(bytes.below(6));
    const int n = int(problem.variables.size());
    m.a = bytes.below(n);
    m.b = m.kind == Kind::prior ? m.a : bytes.below(n);
    const Type a = problem.variables[std::size_t(m.a)].type;
    // A second variable that does not fit is looked for.
    for (int k = 0; k < n && !fits(m.kind, a, problem.variables[std::size_t(m.b)].type); ++k)
      m.b = (m.b + 1) % n;
    // The two derivatives of `numeric` by one variable could cancel, and their noise be all that is left.
    const bool is_noise = m.kind == Kind::numeric && m.a == m.b;
    if (is_noise || !fits(m.kind, a, problem.variables[std::size_t(m.b)].type))
      m = {Kind::prior, m.a, m.a, 0, {}, {}, 1, 0, 1, 0};
    if (m.kind == Kind::scalar && a == Type::point3) m.b = m.a;  // it has three numbers
    if (isScalar(m.kind)) {
      m.formula = bytes.below(kFormulas);
      // Nor where exact ones cancel: of huge ones J^T J would be rounding error, of either sign.
      if (m.formula == 6 && m.a == m.b && a == Type::number) m.formula = 0;
      for (double& c : m.c) c = bytes.number();
    }
    if (m.kind == Kind::prior || m.kind == Kind::relative) {
      m.z = anyValue(bytes, a);
    } else {
      for (int i = 0; i < (m.kind == Kind::landmark ? positionOf(a) : 1); ++i)
        m.z[std::size_t(i)] = bytes.number();
    }
    const int noise = bytes.byte();
    m.sigma = noise < 0x80 ? 1 : noise < 0xC0 ? 0.1 : noise < 0xF0 ? 0.01 * (noise - 0xB0) : bytes.number();
    if (noise % 8 == 7) {
      m.loss = 1 + bytes.below(6);
      m.scale = bytes.oneIn(4) ? bytes.number() : 1.5;
      m.shape = bytes.below(8) - 6;
    }
    problem.measurements.push_back(m);
  }
  return problem;
}

}  // namespace slom::fuzz::fit
