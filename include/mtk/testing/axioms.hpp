/// A test harness for manifolds, both of this library and of users. It depends on no test framework:
///
///     const auto report = mtk::testing::checkAxioms(MyType());
///     EXPECT_TRUE(report.ok()) << report.text();
///
/// checkAxioms checks at many points x, y and tangent vectors d, d1, d2 (Hertzberg et al. 2013, definition 1, and the
/// scale):
///     x [+] 0 = x
///     x [+] (y [-] x) = y                                   for every y, also for y as far from x as possible
///     (x [+] d) [-] x = d                                   for |d| < radius
///     |(x [+] d1) [-] (x [+] d2)| <= |d1 - d2|
///     boxplus(d, s) = boxplus(s d)
/// Points are random and reached from the given one by [+]. Tangent vectors are random and have hard lengths: 0, tiny,
/// just below, at and just above pi. A failing sample is printed with enough digits to repeat it.
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "mtk/manifold.hpp"
#include "mtk/stream.hpp"

namespace mtk::testing {

/// Where and how strictly checkAxioms checks.
struct AxiomOptions {
  unsigned seed = 1;
  int points = 40;  ///< random points x
  /// Limit of the check (x [+] d) [-] x = d, for |d| < radius: pi for rotations and directions, infinite for vectors.
  /// The default suits both and every compound of them.
  double radius = 3.14159265358979;
  double spread = 2;  ///< standard deviation of the random steps that lead to the points
  /// Allowed error in units of the scalar's epsilon, times (1 + the size of the numbers involved).
  double tolerance = 64;
};

/// Number of checks and the failed ones.
class AxiomReport {
 public:
  /// Returns whether no check failed.
  bool ok() const { return failures_.empty(); }
  /// Returns the number of checks, including failed ones.
  int checks() const { return checks_; }
  /// Returns the first failures in words; empty if there are none.
  std::string text() const {
    std::string all;
    for (const std::string& failure : failures_) all += failure + "\n";
    return all;
  }
  /// Counts a check. If it has failed, `describe` makes the text.
  template <class Describe>
  void check(bool good, Describe&& describe) {
    ++checks_;
    if (!good && failures_.size() < 10) failures_.push_back(describe());
  }

 private:
  int checks_ = 0;
  std::vector<std::string> failures_;
};

namespace detail {

template <Manifold M>
class AxiomCheck {
  using S = scalar_t<M>;
  using Tangent = tangent_t<M>;

 public:
  AxiomCheck(const M& start, const AxiomOptions& options)
      : start_(start), options_(options), rng_(options.seed), n_(dof(start)) {}

  AxiomReport run() {
    for (int i = 0; i < options_.points; ++i) {
      const M x = i == 0 ? start_ : moved(start_, randomTangent(options_.spread));
      for (const double length : lengths()) atPoint(x, randomDirection() * S(length));
      for (int c = 0; c < n_; ++c) {
        for (const double length : lengths()) atPoint(x, Tangent::Unit(n_, c) * S(length));
      }
      atPoint(x, randomTangent(1));
    }
    return report_;
  }

 private:
  static std::vector<double> lengths() {
    const double pi = 3.14159265358979323846;
    const double eps = std::numeric_limits<S>::epsilon();
    const double least = std::numeric_limits<S>::min();
    return {0,   least,     std::sqrt(least), eps, std::sqrt(eps), 1e-3,      0.5, 1.5,
            3.0, pi - 1e-3, pi - 16 * eps,    pi,  pi + 16 * eps,  pi + 1e-3, 4.0, 2 * pi};
  }

  Tangent randomTangent(double sigma) {
    std::normal_distribution<double> normal(0, sigma);
    Tangent d(n_);
    for (int i = 0; i < n_; ++i) d[i] = S(normal(rng_));
    return d;
  }
  Tangent randomDirection() {
    Tangent d = randomTangent(1);
    return d / d.norm();
  }

  S allowed(const M& x, const Tangent& d) const {
    Tangent size(n_);
    typicalSizes<M>(size, x);
    return S(options_.tolerance) * std::numeric_limits<S>::epsilon() * (S(1) + d.norm() + size.norm());
  }

  void atPoint(const M& x, const Tangent& d) {
    const Tangent zero = Tangent::Zero(n_);
    expectSmall("x [+] 0 = x", difference(moved(x, zero), x), allowed(x, zero), x, zero);
    const M y = moved(x, d);
    const S limit = allowed(x, d);
    const Tangent way = difference(y, x);
    expectSmall("x [+] (y [-] x) = y", difference(moved(x, way), y), limit, x, d);
    const double length = double(d.norm());
    if (length < options_.radius) {
      // The inverse is discontinuous at the radius, so rounding of y counts more the nearer it is.
      const S nearness = S(1 / (1 - length / options_.radius));
      expectSmall("(x [+] d) [-] x = d", way - d, limit * std::max(S(1), S(nearness * S(0.01))), x, d);
    }
    const Tangent other = randomTangent(1);
    const S apart = difference(y, moved(x, other)).norm();
    report_.check(apart <= (d - other).norm() + limit + allowed(x, other), [&] {
      return describe("|(x [+] d1) [-] (x [+] d2)| <= |d1 - d2|", double(apart - (d - other).norm()), x, d);
    });
    expectSmall("boxplus(d, s) = boxplus(s d)",
                difference(moved(x, d, S(-0.5)), moved(x, Tangent(S(-0.5) * d))), limit, x, d);
  }

  void expectSmall(const char* axiom, const Tangent& error, S limit, const M& x, const Tangent& d) {
    report_.check(error.norm() <= limit, [&] { return describe(axiom, double(error.norm()), x, d); });
  }

  std::string describe(const char* axiom, double error, const M& x, const Tangent& d) const {
    std::ostringstream text;
    text.precision(std::numeric_limits<S>::max_digits10);
    text << axiom << " is off by " << error << " at x = (";
    if constexpr (isWritable<M>()) write(text, x);
    text << "), d = (" << d.transpose() << ")";
    return text.str();
  }

  M start_;
  AxiomOptions options_;
  std::mt19937 rng_;
  int n_;
  AxiomReport report_;
};

}  // namespace detail

/// Checks the axioms at points reached from `start`. Failing values of types with operator<< are printed.
template <class M>
AxiomReport checkAxioms(const M& start, const AxiomOptions& options = {}) {
  requireManifold<M>();
  return detail::AxiomCheck<M>(start, options).run();
}

}  // namespace mtk::testing
