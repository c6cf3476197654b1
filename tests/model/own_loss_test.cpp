// A user's own function as a loss.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;

slom::Loss welsch(double scale) {
  return slom::ownLoss("Welsch", scale, [](double t) {
    const double weight = std::exp(-t);
    return slom::LossValue{-std::expm1(-t), weight, -weight};
  });
}

/// A level measured eight times, once grossly wrong.
struct Level {
  slom::Estimator est;
  slom::VarID<double> x = est.insertRV(1.0, "x");
  explicit Level(const slom::Loss& loss) {
    for (const double z : {1.1, 0.9, 1.2, 0.8, 1.0, 1.05, 0.95, 9.0}) {
      est.insertMeasurement([](const auto& level) { return level; }, x, slom::measured(z),
                            slom::StandardDeviation(0.1), loss);
    }
  }
};

TEST(OwnLoss, FitsAsTheLibrarysOfTheSameFormula) {
  const auto cauchy = slom::ownLoss("my Cauchy", 2.385, [](double t) {
    const double weight = 1 / (1 + t);
    return slom::LossValue{std::log1p(t), weight, -weight * weight};
  });
  Level own(cauchy), library{slom::Cauchy(2.385)};
  const slom::Summary a = own.est.optimize(), b = library.est.optimize();
  EXPECT_TRUE(a.converged) << a;
  EXPECT_EQ(*own.x, *library.x);
  EXPECT_EQ(a.final_rss, b.final_rss);
  EXPECT_EQ(own.est.standardDeviation(own.x)[0], library.est.standardDeviation(library.x)[0]);
  EXPECT_EQ(a.groups[0].losses[0].loss, "my Cauchy(2.385)");
}

TEST(OwnLoss, ForgetsAGrossErrorAndGraduates) {
  for (const bool graduated : {false, true}) {
    Level level(welsch(3));
    slom::Options options;
    options.graduated_non_convexity = graduated;
    const slom::Summary summary = level.est.optimize(options);
    EXPECT_TRUE(summary.converged) << summary;
    EXPECT_NEAR(*level.x, 1, 1e-3);
    EXPECT_EQ(summary.groups[0].losses[0].down_weighted, 1);
  }
}

std::string refused(const slom::Loss& loss) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  const std::string message = messageOf(
      [&] { est.insertMeasurement([](const auto& v) { return v; }, x, slom::named("level"), loss); });
  EXPECT_EQ(est.getM(), 0);
  return message;
}

TEST(OwnLoss, IsCheckedWhenItIsInserted) {
  using slom::LossValue;
  EXPECT_EQ(
      refused(slom::ownLoss("shifted", 1,
                            [](double t) {
                              return LossValue{t + 1, 1, 0};
                            })),
      "[slom.bad-loss] loss shifted(1) of measurement level #1 has phi(0) = 1 and phi'(0) = 1; let phi begin at 0 "
      "with slope 1, as least squares do");
  EXPECT_EQ(
      refused(slom::ownLoss("steep", 2,
                            [](double t) {
                              return LossValue{t + t * t, 1 + 2 * t, 2};
                            })),
      "[slom.bad-loss] loss steep(2) of measurement level #1 has phi(0.01) = 0.0101, phi' = 1.02, phi'' = 2; let all "
      "be finite, and phi' between 0 and 1");
  EXPECT_EQ(
      refused(slom::ownLoss("wrong", 1,
                            [](double t) {
                              return LossValue{std::log1p(t), 1 / (1 + 2 * t), 0};
                            })),
      "[slom.bad-loss] loss wrong(1) of measurement level #1 has phi'(0.01) = 0.98 where differences of phi give 0.99; "
      "let phi' be the derivative of phi");
  EXPECT_EQ(
      refused(slom::ownLoss("lost", 1,
                            [](double t) {
                              return LossValue{t > 1 ? std::nan("") : t, 1, 0};
                            })),
      "[slom.bad-loss] loss lost(1) of measurement level #1 has phi(2) = nan, phi' = 1, phi'' = 0; let all be finite, "
      "and phi' between 0 and 1");
  EXPECT_EQ(
      refused(welsch(0)),
      "[slom.bad-loss] loss Welsch(0) of measurement level #1 has scale 0; pass a positive finite number, in standard "
      "deviations of the residual");
}

struct Same {
  auto operator()(const auto& x) const { return x * 1.0; }
};

TEST(OwnLoss, IsRefusedByArchives) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement(Same(), x, slom::measured(2.0), welsch(3));
  slom::Archive archive;
  archive.measurement<Same, slom::VarID<double>, slom::Measured<double>>("same");
  std::ostringstream file;
  EXPECT_EQ(
      messageOf([&] { archive.save(est, file); }),
      "[slom.not-savable] the loss Welsch(3) of measurement Same #1 is a function of this program, which "
      "cannot be saved to a file; insert the measurement with one of the library's losses");
  EXPECT_EQ(file.str(), "");
}

TEST(OwnLoss, KeepsItsNameAndHasOnePerName) {
  const auto function = [](double t) {
    return slom::LossValue{1 - std::exp(-t), std::exp(-t), -std::exp(-t)};
  };
  std::string name = "first";
  const slom::Loss first = slom::ownLoss(name.c_str(), 2, function);
  name.assign(5, '#');
  const slom::Loss second = slom::ownLoss("second", 2, function), again = slom::ownLoss("first", 2, function);
  EXPECT_EQ(first.text(), "first(2)");
  EXPECT_EQ(second.text(), "second(2)");
  EXPECT_TRUE(first == again);
  EXPECT_FALSE(first == second);
}

}  // namespace
