// Recording: what is simplified, how derivatives of selections are guarded, what tells tapes apart, and errors.
#include <limits>
#include <random>

#include "tape/compare.hpp"

namespace slom::testing {
namespace {

using tape::Number;

/// A recording with one variable, a vector.
struct Recorded {
  tape::Recording recording;
  std::vector<Number> x;

  explicit Recorded(int size)
      : x(recording.variable({"x", {{tape::Part::Kind::vector, size}}}).coordinates) {}
  tape::Tape finish(const Number& y) { return recording.finish({y}); }
};
/// Returns value and derivatives of f(x, y) from its tape.
template <class F>
std::vector<double> atPoint(const F& f, double x, double y) {
  Recorded recorded(2);
  const tape::Tape tape = recorded.finish(f(recorded.x[0], recorded.x[1]));
  const double point[] = {x, y};
  const double* const variable = point;
  std::vector<double> result(3);
  tape.evaluate(1, {&variable, nullptr}, result.data(), result.data() + 1);
  return result;
}
/// Returns the same by dual numbers.
template <class F>
std::vector<double> byDuals(const F& f, double x, double y) {
  mtk::Dual<double, 2> a, b;
  a.seed(x, 0);
  b.seed(y, 1);
  const mtk::Dual<double, 2> z(f(a, b));
  return {z.value(), z.partial(0), z.partial(1)};
}

constexpr double kHard[] = {0, 1, -1, 0.3, -2.7, 1e-8, 1e-160, 1e-300, kPi, kPi / 2, -kPi, 7, 1e6};

/// Compares f with dual numbers, also where results are infinite or NaN.
template <class F>
void expectAsDuals(const char* name, const F& f) {
  for (const double x : kHard) {
    for (const double y : kHard) {
      const std::vector<double> got = atPoint(f, x, y), expected = byDuals(f, x, y);
      for (std::size_t i = 0; i < 3; ++i) {
        if (std::isnan(expected[i])) {
          EXPECT_TRUE(std::isnan(got[i]))
              << name << " at " << x << ", " << y << ": entry " << i << " is " << got[i];
        } else if (std::isinf(expected[i])) {
          EXPECT_EQ(got[i], expected[i]) << name << " at " << x << ", " << y;
        } else {
          EXPECT_NEAR(got[i], expected[i], 1e-14 * std::max(1.0, std::abs(expected[i])))
              << name << " at " << x << ", " << y << ": entry " << i;
        }
      }
    }
  }
}

TEST(Recording, FunctionsAreThoseOfDualNumbers) {
#define EXPECT_FUNCTION(expression)                             \
  expectAsDuals(#expression, [](const auto& x, const auto& y) { \
    (void)y;                                                    \
    using std::sqrt;                                            \
    using S = std::decay_t<decltype(x)>;                        \
    return S(expression);                                       \
  })
  EXPECT_FUNCTION(x + y);
  EXPECT_FUNCTION(x * y - 2.0 * x);
  EXPECT_FUNCTION(sqrt(x));
  EXPECT_FUNCTION(sqrt(x * x + y * y));
  EXPECT_FUNCTION(sin(x) * cos(x * y));
  EXPECT_FUNCTION(tan(x));
  EXPECT_FUNCTION(asin(x));
  EXPECT_FUNCTION(acos(x));
  EXPECT_FUNCTION(atan(x));
  EXPECT_FUNCTION(atan2(y, x));
  EXPECT_FUNCTION(hypot(x, y));
  EXPECT_FUNCTION(exp(-x * x));
  EXPECT_FUNCTION(expm1(sin(x)));
  EXPECT_FUNCTION(log(x));
  EXPECT_FUNCTION(log1p(x));
  EXPECT_FUNCTION(tanh(x));
  EXPECT_FUNCTION(sinh(sin(x)));
  EXPECT_FUNCTION(cosh(sin(x)));
  EXPECT_FUNCTION(asinh(x));
  EXPECT_FUNCTION(abs(x));
  EXPECT_FUNCTION(floor(x) + y);
  EXPECT_FUNCTION(pow(x, 3.0));
  EXPECT_FUNCTION(pow(x, 2.0));
  EXPECT_FUNCTION(pow(x, 1.5));
  EXPECT_FUNCTION(fmax(x, y));
  EXPECT_FUNCTION(fmin(x * y, y));
  EXPECT_FUNCTION(cbrt(x));
  EXPECT_FUNCTION(x / 3.0 + x / 0.25 - (-y) / (x * x + 2.0));
  EXPECT_FUNCTION(erf(x));
  EXPECT_FUNCTION(erfc(x));
#undef EXPECT_FUNCTION
}

TEST(Recording, QuotientsAndTheirDerivativesAreThoseOfNumbers) {
  const auto quotient = [](const Number& x, const Number& y) { return x / y; };
  for (const double x : kHard) {
    for (const double y : kHard) {
      if (y == 0) continue;
      const std::vector<double> got = atPoint(quotient, x, y), expected{x / y, 1 / y, -(x / y) * (1 / y)};
      EXPECT_EQ(got, expected) << x << " / " << y;
    }
  }
}

TEST(Recording, QuotientsAreRoundedAsThoseOfNumbers) {
  Recorded recorded(2);
  const tape::Tape tape = recorded.recording.finish({floor(recorded.x[0] / recorded.x[1])});
  for (double a = 1; a <= 60; ++a) {
    for (double b = 1; b <= a; ++b) {
      const double x[] = {a, b};
      const double* const pointers[] = {&x[0], &x[1]};
      double r = 0;
      tape.evaluate(1, {pointers, nullptr}, &r, nullptr);
      EXPECT_EQ(r, std::floor(a / b)) << a << " / " << b;
    }
  }
}

TEST(Recording, TheSideOfASelectionThatIsNotTakenGivesExactlyZero) {
  // sqrt, log and 1 / x have infinite derivatives where they are not taken.
  const auto guarded = [](const Number& x, const Number& y) {
    return select(x > 0.0, sqrt(x) * log(x) / x, y) + select(y == 0.0, y * 2.0, x / y);
  };
  const std::vector<double> got = atPoint(guarded, 0, 0);
  EXPECT_EQ(got, (std::vector<double>{0, 0, 3}));
  // Both sides of a selection below another, each singular where the other is taken.
  const auto nested = [](const Number& x, const Number& y) {
    const Number r = sqrt(x * x + y * y);
    return select(r > 0.0, select(x > y, 1.0 / (x - y), 1.0 / r), x + y);
  };
  EXPECT_EQ(atPoint(nested, 0, 0), (std::vector<double>{0, 1, 1}));
  EXPECT_DOUBLE_EQ(atPoint(nested, 1, 1)[1], -0.35355339059327379);
}

TEST(Recording, FoldsAndSharesWhatItCan) {
  Recorded recorded(2);
  const Number &x = recorded.x[0], &y = recorded.x[1];
  const auto instructions = [&](const Number& z) {
    return recorded.recording.finish({z}).code().residual.size();
  };
  EXPECT_EQ(instructions(x * 0.0 + 1.0 * y + 0.0), 1u);  // a copy
  EXPECT_EQ(instructions(x - x + sin(Number(1.0)) * 2.0), 1u);
  EXPECT_TRUE((x - x).isConstant());
  EXPECT_TRUE((x * 0.0).isConstant());
  EXPECT_EQ(instructions(x * y + y * x + x * y), 3u);  // one product; two sums
  EXPECT_EQ(instructions(x * y - 3.0), 1u);
  EXPECT_EQ(instructions(sin(x) + cos(x)), 2u);  // both at once; the sum
  EXPECT_EQ(instructions(select(Number(1.0) < 2.0, x, log(y))), 1u);
}

TEST(Recording, ConstantEntriesOfTheJacobianAreKnown) {
  Recorded recorded(3);
  const auto& x = recorded.x;
  const tape::Tape tape = recorded.recording.finish({x[0] * 2.0 - x[1], sin(x[2])});
  EXPECT_TRUE(tape.isConstant(0, 0));
  EXPECT_TRUE(tape.isConstant(0, 1));
  EXPECT_TRUE(tape.isZero(0, 2));
  EXPECT_TRUE(tape.isZero(1, 0));
  EXPECT_FALSE(tape.isConstant(1, 2));
  EXPECT_FALSE(tape.isZero(0, 0));
}

/// Returns a function that uses a number which it brings along as data.
auto shifted(double by) {
  return [by](const auto& x) { return x - tape::data(by); };
}
auto scaled(double by) {
  return [by](const auto& x) { return x * by; };
}
TEST(Recording, CapturedNumbersThatAreDataAreNoPartOfTheTape) {
  Estimator est;
  const auto x = est.insertRV(1.0), y = est.insertRV(2.0);
  std::vector<double> first, second, third;
  const auto one = detail::trace(shifted(3), first, x), other = detail::trace(shifted(4), second, y);
  EXPECT_EQ(one, other);
  EXPECT_EQ(first, std::vector<double>{3});
  EXPECT_EQ(second, std::vector<double>{4});
  const auto same = detail::trace([](const auto& a) { return a - tape::data(5); }, third, x);
  EXPECT_EQ(same, one);  // made by another function
  EXPECT_EQ(same->tape.hash(), one->tape.hash());
  std::vector<double> none;
  const auto twice = detail::trace(scaled(2), none, x), thrice = detail::trace(scaled(3), none, x);
  EXPECT_FALSE(twice->tape == thrice->tape);
  EXPECT_TRUE(none.empty());
}
TEST(Recording, EachMeasurementKeepsItsOwnCapturedNumber) {
  Estimator est;
  std::vector<VarID<double>> x;
  for (int i = 0; i < 5; ++i) {
    x.push_back(est.insertRV(0.0));
    est.insertMeasurement(traced(shifted(i)), x.back());
    est.insertMeasurement(traced(scaled(i + 1)), x.back(), StandardDeviation(1e3));
  }
  EXPECT_TRUE(est.optimize().converged);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(*x[static_cast<std::size_t>(i)], i, 1e-4);
}

/// Returns the text of the error that f throws.
template <class F>
std::string errorOf(const F& f) {
  try {
    f();
  } catch (const mtk::Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}
TEST(Recording, EndlessLoopsAreRefused) {
  Recorded recorded(1);
  Number x = recorded.x[0];
  const auto endless = [&] {
    for (;;) x = x * 1.5 + 1.0;
  };
  EXPECT_THROW(endless(), mtk::Error);
}

TEST(Recording, NumbersOfAnotherRecordingAreRefused) {
  Number kept;
  {
    Recorded recorded(1);
    kept = recorded.x[0];
  }
  const std::string expected =
      "[slom.traced-elsewhere] a number of a traced measurement function is used outside of the call that made it; do "
      "not keep numbers from one call to the next";
  EXPECT_EQ(errorOf([&] { (void)(kept + 1.0); }), expected);
  Recorded recorded(1);
  EXPECT_EQ(errorOf([&] { (void)(kept + recorded.x[0]); }), expected);
}
TEST(Recording, ABranchIsRefusedWithItsPlace) {
  Recorded recorded(1);
  tape::Recording::at("fit.py", 12);
  const tape::Condition condition = recorded.x[0] > 0.0;
  EXPECT_EQ(
      errorOf([&] { tape::raiseBranch(condition); }),
      "[slom.traced-branch] a traced measurement function branches on a computed number at fit.py:12; write "
      "slom.where(condition, a, b), which takes a where the condition holds and b elsewhere");
}

// ---- tapes from outside ------------------------------------------------------------------------------------

tape::Code someCode() {
  Recorded recorded(4);
  const auto& x = recorded.x;
  const Number z = tape::data(2);
  return recorded.recording
      .finish({sin(x[0]) * x[1] + cos(x[0]) - z, select(x[2] > x[3], sqrt(x[2]), atan2(x[3], z)),
               exp(x[3] * 0.5)})
      .code();
}
TEST(HostileTape, FaultsAreNamed) {
  const auto fault = [](const auto& spoil) {
    tape::Code code = someCode();
    spoil(code);
    return errorOf([&] { tape::Tape{code}; });
  };
  const std::string remedy = "; write it again with the program that made it";
  EXPECT_EQ(fault([](tape::Code& code) { code.residual[0].kind = 999; }),
            "[slom.bad-tape] the tape has the unknown instruction 999" + remedy);
  EXPECT_EQ(
      fault([](tape::Code& code) { code.residual[0].to = 0; }),
      "[slom.bad-tape] the tape writes to register 0 in instruction 0, which holds no results" + remedy);
  EXPECT_EQ(fault([](tape::Code& code) { code.residual[0].from[0] = 60000; }),
            "[slom.bad-tape] the tape reads register 60000 in instruction 0, which has no value" + remedy);
  EXPECT_EQ(fault([](tape::Code& code) { code.residual.clear(); }),
            "[slom.bad-tape] the tape does not compute its residual" + remedy);
  EXPECT_EQ(fault([](tape::Code& code) { code.entry_register[0] = 1 << 20; }),
            "[slom.bad-tape] the tape does not compute its Jacobian" + remedy);
  EXPECT_EQ(fault([](tape::Code& code) { code.entry_register.pop_back(); }),
            "[slom.bad-tape] the tape has a Jacobian of another size than residual and variables" + remedy);
  EXPECT_EQ(fault([](tape::Code& code) { code.registers = 5; }),
            "[slom.bad-tape] the tape has fewer registers than inputs and outputs" + remedy);
  EXPECT_EQ(fault([](tape::Code& code) { code.rows = 1 << 30; }),
            "[slom.bad-tape] the tape has more than 65535 numbers" + remedy);
}
TEST(HostileTape, SpoiltBytesAreRefusedOrHarmless) {
  std::mt19937 engine(std::random_device{}());
  const auto number = [&](std::size_t below) {
    return std::uniform_int_distribution<std::size_t>(0, below - 1)(engine);
  };
  int harmless = 0;
  for (int round = 0; round < 20000; ++round) {
    tape::Code code = someCode();
    for (std::size_t faults = 1 + number(3); faults > 0; --faults) {
      auto& instructions = number(2) == 0 ? code.residual : code.linearization;
      const auto value = static_cast<std::uint16_t>(number(4) == 0 ? number(65536) : number(80));
      if (instructions.empty()) continue;
      tape::Instruction& instruction = instructions[number(instructions.size())];
      switch (number(7)) {
        case 0:
          instruction.kind = value;
          break;
        case 1:
          instruction.to = value;
          break;
        case 2:
          code.registers = static_cast<int>(value);
          break;
        case 3:
          code.entry_register[number(code.entry_register.size())] = static_cast<std::int32_t>(value) - 1;
          break;
        case 4:
          instructions.erase(instructions.begin() + static_cast<std::ptrdiff_t>(number(instructions.size())));
          break;
        default:
          instruction.from[number(7)] = value;
      }
    }
    try {
      const tape::Tape tape(code);
      const double inputs[] = {0.1, 0.2, 0.3, 0.4}, datum[] = {1, 2};
      const double* const variables[] = {inputs, inputs};
      std::vector<double> r(static_cast<std::size_t>(2 * tape.rows())), J(r.size() * 4);
      tape.evaluate(2, {variables, datum}, r.data(), J.data());
      ++harmless;
    } catch (const mtk::Error& error) {
      EXPECT_EQ(error.id(), "slom.bad-tape");
    }
  }
  EXPECT_GT(harmless, 100);
}

}  // namespace
}  // namespace slom::testing
