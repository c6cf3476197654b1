// rho, rho' and rho'' of the losses against textbook formulas in long double, differentiated numerically.
#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using Real = long double;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A loss, and rho as its authors write it, as a function of the residual x = sqrt(s) in units of the scale, for c = 1.
/// `terms` is the size of the subtracted terms, including the condition of powers. rho has the roundoff of these terms.
struct Case {
  slom::Loss loss;
  std::function<Real(Real)> rho;
  Real terms = 2;
};

Real barron(Real x, Real alpha) {
  const Real b = std::fabs(alpha - 2);
  return 2 * (b / alpha * (std::pow(x * x / b + 1, alpha / 2) - 1));
}

std::vector<Case> cases(double c) {
  std::vector<Case> result{
      {slom::Huber(c), [](Real x) { return x <= 1 ? x * x : 2 * x - 1; }},
      {slom::PseudoHuber(c), [](Real x) { return 2 * (std::sqrt(1 + x * x) - 1); }},
      {slom::Cauchy(c), [](Real x) { return std::log(1 + x * x); }},
      {slom::Tukey(c), [](Real x) { return x <= 1 ? (1 - std::pow(1 - x * x, 3)) / 3 : Real(1) / 3; }},
      {slom::GemanMcClure(c), [](Real x) { return x * x / (1 + x * x); }},
      {slom::Barron(2, c), [](Real x) { return x * x; }},
      {slom::Barron(0, c), [](Real x) { return 2 * std::log(x * x / 2 + 1); }},
      {slom::Barron(-kInfinity, c), [](Real x) { return 2 * (1 - std::exp(-x * x / 2)); }},
  };
  for (const double alpha :
       {2 - 1e-15, 2 - 1e-9, 1.9, 1.5, 1.0, 0.99, 0.5, 1e-3, -1e-3, -0.7, -2.0, -9.0, -1e3}) {
    result.push_back({slom::Barron(alpha, c), [alpha](Real x) { return barron(x, alpha); },
                      (2 + std::fabs(Real(alpha))) * (2 - Real(alpha)) / std::fabs(Real(alpha))});
  }
  return result;
}

TEST(Loss, AndItsDerivativesAreThoseOfTheTextbook) {
  for (const double c : {1.0, 0.003, 700.0}) {
    for (const Case& one : cases(c)) {
      for (const double t : {1e-5, 1e-3, 0.3, 0.999, 1.001, 1.7, 10.0, 300.0, 1e6, 1e12}) {
        const double s = t * c * c;
        const slom::LossValue value = one.loss.evaluate(s);
        const auto rho = [&](Real by) { return one.rho(std::sqrt(t * (1 + by))) * c * c; };  // at s (1 + by)
        const Real h = 2e-4L;
        const Real first = (8 * (rho(h) - rho(-h)) - (rho(2 * h) - rho(-2 * h))) / (12 * h) / s;
        const Real second =
            (16 * (rho(h) + rho(-h)) - (rho(2 * h) + rho(-2 * h)) - 30 * rho(0)) / (12 * h * h) / s / s;
        const std::string where = one.loss.text() + " at t = " + std::to_string(t);
        // Tolerances: double precision, the truncation error of the differences, and the roundoff of the oracle.
        const Real noise = 8e-19L * (one.terms * c * c + rho(0));
        EXPECT_NEAR(value.rho, rho(0), 2e-14 * rho(0) + noise) << where;
        EXPECT_NEAR(value.first, first, 1e-13 * first + noise / h / s) << where;
        EXPECT_NEAR(value.second, second, 1e-12 * std::fabs(second) + noise / h / h / s / s) << where;
      }
    }
  }
}

TEST(Loss, IsTheSquareNearZeroAndConcaveAndMonotone) {
  for (const double c : {1.0, 0.003, 700.0}) {
    for (const Case& one : cases(c)) {
      const slom::LossValue zero = one.loss.evaluate(0);
      EXPECT_EQ(zero.rho, 0) << one.loss.text();
      EXPECT_EQ(zero.first, 1) << one.loss.text();
      slom::LossValue before = zero;
      double s_before = 0;
      for (double t = 1e-300; t < 1e290; t *= 3) {
        const double s = t * c * c;
        const slom::LossValue value = one.loss.evaluate(s);
        const std::string where = one.loss.text() + " at t = " + std::to_string(t);
        if (t < 1e-9) {
          EXPECT_NEAR(value.rho, s, (2 * t + 4e-16) * s) << where;
          EXPECT_NEAR(value.first, 1, 2 * t + 4e-16) << where;
        }
        EXPECT_GE(value.rho, before.rho * (1 - 1e-15)) << where;
        EXPECT_LE(value.rho - before.rho, (s - s_before) * (1 + 1e-9)) << where;
        EXPECT_LE(value.first, before.first) << where;
        EXPECT_GE(value.first, 0) << where;
        EXPECT_LE(value.second, 0) << where;
        ASSERT_TRUE(std::isfinite(value.rho) && std::isfinite(value.second)) << where;
        before = value;
        s_before = s;
      }
    }
  }
}

TEST(Loss, HasNoJumpAtTheSwitch) {
  for (const slom::Loss& loss : {slom::Loss(slom::Huber(1)), slom::Loss(slom::Tukey(1))}) {
    const slom::LossValue below = loss.evaluate(1 - 1e-15), above = loss.evaluate(1 + 1e-15);
    EXPECT_NEAR(below.rho, above.rho, 1e-14) << loss.text();
    EXPECT_NEAR(below.first, above.first, 1e-14) << loss.text();
  }
}

void expectEqual(const slom::Loss& a, const slom::Loss& b, double tolerance) {
  for (const double s : {0.0, 1e-20, 1e-6, 0.1, 1.0, 4.0, 77.0, 1e5, 1e15}) {
    const slom::LossValue x = a.evaluate(s), y = b.evaluate(s);
    const std::string where = a.text() + " and " + b.text() + " at s = " + std::to_string(s);
    EXPECT_NEAR(x.rho, y.rho, tolerance * y.rho) << where;
    EXPECT_NEAR(x.first, y.first, tolerance * y.first) << where;
    EXPECT_NEAR(x.second, y.second, tolerance * std::abs(y.second)) << where;
  }
}

TEST(Barron, HoldsTheNamedLosses) {
  for (const double c : {1.0, 0.4, 30.0}) {
    expectEqual(slom::Barron(2, c), slom::Loss(), 0);
    expectEqual(slom::Barron(1, c), slom::PseudoHuber(c), 1e-14);
    expectEqual(slom::Barron(0, c), slom::Cauchy(std::sqrt(2.0) * c), 1e-14);
    expectEqual(slom::Barron(-2, c), slom::GemanMcClure(2 * c), 1e-14);
  }
}

TEST(Barron, IsSmoothInItsShape) {
  for (const double c : {1.0, 3.0}) {
    for (const double tiny : {1e-300, 1e-17, 1e-15}) {
      expectEqual(slom::Barron(tiny, c), slom::Barron(0, c), 1e-13);
      expectEqual(slom::Barron(-tiny, c), slom::Barron(0, c), 1e-13);
    }
    // To first order in alpha, rho(alpha) - rho(0) is the same on both sides.
    for (const double s : {0.1, 1.0, 20.0, 1e5}) {
      const double e = 1e-6, mid = slom::Barron(0, c).evaluate(s).rho;
      const double above = slom::Barron(e, c).evaluate(s).rho - mid,
                   below = slom::Barron(-e, c).evaluate(s).rho - mid;
      EXPECT_NEAR(above, -below, 1e-4 * std::abs(above)) << s;
    }
    // Around 1, where the formula changes, and where -infinity is taken.
    expectEqual(slom::Barron(std::nextafter(1.0, 0), c), slom::Barron(1, c), 1e-13);
    expectEqual(slom::Barron(-1e101, c), slom::Barron(-kInfinity, c), 0);
    for (const double s : {0.1, 1.0, 20.0}) {
      EXPECT_NEAR(slom::Barron(-1e99, c).evaluate(s).rho, slom::Barron(-kInfinity, c).evaluate(s).rho,
                  1e-14 * s);
    }
  }
}

TEST(Loss, IsScaledByGraduation) {
  for (const double graduation : {1.0, 4.0, 1e4}) {
    const slom::LossValue a = slom::GemanMcClure(3).evaluate(7, graduation);
    const slom::LossValue b = slom::GemanMcClure(3 * std::sqrt(graduation)).evaluate(7);
    EXPECT_NEAR(a.rho, b.rho, 1e-15 * b.rho);
    EXPECT_NEAR(a.first, b.first, 1e-15);
    // The surrogate of Yang et al. 2020, mu c^2 r^2 / (mu c^2 + r^2)
    EXPECT_NEAR(a.rho, graduation * 9 * 7 / (graduation * 9 + 7), 1e-14);
  }
}

TEST(Loss, IsCalledByItsNameInTheCode) {
  EXPECT_EQ(slom::Loss().text(), "none");
  EXPECT_EQ(slom::Huber(1.345).text(), "Huber(1.345)");
  EXPECT_EQ(slom::PseudoHuber(2).text(), "PseudoHuber(2)");
  EXPECT_EQ(slom::Cauchy(2.385).text(), "Cauchy(2.385)");
  EXPECT_EQ(slom::Tukey(4.685).text(), "Tukey(4.685)");
  EXPECT_EQ(slom::GemanMcClure(1e-3).text(), "GemanMcClure(0.001)");
  EXPECT_EQ(slom::Barron(-kInfinity, 1.5).text(), "Barron(-inf, 1.5)");
}

TEST(Loss, IsFoundByTheNameThatItHasAlone) {
  std::set<std::string> names, stored_names;
  for (const slom::LossKind* const kind : slom::losses()) {
    EXPECT_TRUE(names.insert(kind->name).second) << kind->name << " is there twice";
    EXPECT_TRUE(stored_names.insert(kind->stored_name).second) << kind->stored_name << " is there twice";
    EXPECT_EQ(slom::lossNamed(kind->stored_name), kind);
  }
  EXPECT_EQ(stored_names,
            (std::set<std::string>{"barron", "cauchy", "geman-mcclure", "huber", "pseudo-huber", "tukey"}));
  EXPECT_EQ(slom::lossNamed("Huber"), nullptr);
  EXPECT_EQ(slom::lossNamed("tukey"), slom::Tukey(1).kind());
}

}  // namespace
