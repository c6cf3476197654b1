// Wrong derivatives given by hand: the summary of a fit reports them and guesses the cause. Right derivatives of
// awkward functions give no warning.
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

namespace {

using vec2 = mtk::vect<2>;
using Texts = std::vector<std::string>;

/// z - exp(-k t) with the derivative by k multiplied by Percent / 100.
template <int Percent>
struct Decay {
  double operator()(const double& k, double t, double z) const { return z - std::exp(-k * t); }
  template <class J>
  void jacobian(const double& k, double t, double, J& by_k) const {
    by_k(0, 0) = Percent / 100.0 * t * std::exp(-k * t);
  }
};
template <int Percent>
slom::Estimator decay() {
  slom::Estimator est;
  const auto k = est.insertRV(1.0, "k");
  for (int i = 1; i < 30; ++i) {
    est.insertMeasurement(Decay<Percent>(), k, 0.1 * i, std::exp(-0.13 * i), slom::StandardDeviation(0.01),
                          slom::named("sample"));
  }
  return est;
}

const std::string kRemedy =
    "; wrong derivatives lead to other values or wrong standard deviations: slom::checkDerivatives(est) "
    "compares them all";

TEST(WrongDerivatives, AreInTheWarningsWithAGuess) {
  EXPECT_EQ(decay<100>().optimize().warnings, Texts());
  slom::Estimator factor = decay<130>();
  const slom::Summary summary = factor.optimize();
  EXPECT_TRUE(summary.converged);
  ASSERT_EQ(summary.warnings.size(), 1u);
  EXPECT_TRUE(summary.warnings[0].starts_with("the given derivative of residual 0 of sample #"))
      << summary.warnings[0];
  EXPECT_EQ(summary.warnings[0].substr(summary.warnings[0].find(": ")),
            ": it is too large by the factor 1.3" + kRemedy);
  slom::Estimator sign = decay<-100>();
  const Texts texts = sign.optimize().warnings;
  ASSERT_FALSE(texts.empty());
  EXPECT_NE(texts.back().find(": the sign is wrong" + kRemedy), std::string::npos) << texts.back();
}

/// x + y0 y1 - 3 with twice the derivative by y.
struct Counted {
  int* count;
  double operator()(const double& x, const vec2& y) const { return ++*count, x + y[0] * y[1] - 3; }
  void jacobian(const double&, const vec2& y, auto& by_x, auto& by_y) const {
    by_x(0, 0) = 1;
    by_y << 2 * y[1], 2 * y[0];
  }
};
TEST(WrongDerivatives, AreFoundOncePerStructureAndSaidEachTime) {
  int evaluations = 0;
  slom::Estimator est;
  est.setThreads(1);
  const auto x = est.insertRV(1.0, "x");
  const auto y = est.insertRV(vec2(1, 3), "y");
  est.insertMeasurement(Counted{&evaluations}, x, y, slom::named("product"));
  est.prior(x, 1, 1);
  est.prior(y, vec2(1, 3), 1);
  est.optimize();
  slom::Options none;
  none.max_iterations = 0;
  const auto warnings = [&] {
    evaluations = 0;
    return est.optimize(none).warnings;
  };
  const Texts first = warnings();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_NE(first[0].find(": it is too large by the factor 2; wrong derivatives"), std::string::npos)
      << first[0];
  const int at_rest = evaluations;
  est.insertRV(2.0, false);
  EXPECT_EQ(warnings(), first);
  EXPECT_GT(evaluations, at_rest + 10) << "a new structure is checked";
}

/// `Change` turns R's given derivative into a wrong one.
template <class Change>
struct Rotated {
  Eigen::Vector3d operator()(const mtk::SO3<>& R, const mtk::vect<3>& p, const mtk::vect<3>& z) const {
    return R * p - z;
  }
  template <class J>
  void jacobian(const mtk::SO3<>& R, const mtk::vect<3>& p, const mtk::vect<3>&, J& by_R) const {
    Eigen::Matrix3d P;
    P << 0, -p[2], p[1], p[2], 0, -p[0], -p[1], p[0], 0;
    by_R = -R.toRotationMatrix() * P;
    Change()(R, by_R);
  }
};
template <class Change>
std::string warningOf(Change) {
  slom::Estimator est;
  const mtk::SO3<> truth = mtk::SO3<>::exp(mtk::vect<3>(0.4, -0.9, 0.3));
  const auto R = est.insertRV(truth, "R");
  for (const mtk::vect<3>& p : {mtk::vect<3>(1, 2, 3), mtk::vect<3>(-1, 0, 2), mtk::vect<3>(0.5, 2, -1)}) {
    est.insertMeasurement(Rotated<Change>(), R, p, mtk::vect<3>(truth * p));
  }
  slom::Options none;
  none.max_iterations = 0;
  const Texts texts = est.optimize(none).warnings;
  return texts.empty() ? "" : texts.back();
}
TEST(WrongDerivatives, OfRotationsAreGuessed) {
  EXPECT_EQ(warningOf([](const auto&, auto&) {}), "");
  EXPECT_NE(warningOf([](const auto&, auto& J) { J = J.transpose().eval(); }).find("it is transposed"),
            std::string::npos);
  EXPECT_NE(warningOf([](const auto& R, auto& J) {
              J = (J * R.toRotationMatrix().transpose()).eval();
            }).find("it is the derivative by a rotation on the left"),
            std::string::npos);
  EXPECT_NE(warningOf([](const auto&, auto& J) { J.setZero(); }).find("they were forgotten"),
            std::string::npos);
  EXPECT_NE(warningOf([](const auto&, auto& J) { J(1, 1) += 0.5; }).find("no simple cause"),
            std::string::npos);
}

/// Functions whose derivatives are right where they exist, and awkward for differences.
struct Kink {  // at the fit, and next to it
  double operator()(const double& x, double z) const { return std::abs(x - z); }
  void jacobian(const double& x, double z, auto& J) const { J(0, 0) = x < z ? -1 : 1; }
};
struct Noisy {
  double operator()(const double& x, double z) const { return x - z + 1e-7 * std::sin(1e9 * x); }
  void jacobian(const double&, double, auto& J) const { J(0, 0) = 1; }
};
struct Steps {  // a staircase whose derivative is given as its slope
  double operator()(const double& x, double z) const { return std::floor(x * 1e4) / 1e4 - z; }
  void jacobian(const double&, double, auto& J) const { J(0, 0) = 1; }
};
struct Root {  // ends at 2, where the bound is
  double operator()(const double& x, double z) const { return std::sqrt(2 - x) - z; }
  void jacobian(const double& x, double, auto& J) const {
    J(0, 0) = -0.5 / std::sqrt(std::max(2 - x, 1e-12));
  }
};
struct Cancelling {
  double operator()(const double& x, double z) const { return (x + 1e9) - (z + 1e9); }
  void jacobian(const double&, double, auto& J) const { J(0, 0) = 1; }
};
struct Throwing {
  double operator()(const double& x, double z) const {
    if (x > 1) throw 7;
    return x - z;
  }
  void jacobian(const double&, double, auto& J) const { J(0, 0) = 1; }
};
struct Flat {
  double operator()(const double& x, double z) const { return std::pow(x - z, 3); }
  void jacobian(const double& x, double z, auto& J) const { J(0, 0) = 3 * std::pow(x - z, 2); }
};
template <class F>
Texts warningsAt(double at, double z) {
  slom::Estimator est;
  const auto x = est.insertRV(at, "x");
  est.insertMeasurement(F(), x, z);
  est.prior(x, at, 1);
  slom::Options none;
  none.max_iterations = 0;
  return est.optimize(none).warnings;
}
TEST(WrongDerivatives, RightOnesOfAwkwardFunctionsAreLeftInPeace) {
  for (const double distance : {0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 5e-4, 1e-3, 0.3, 40.0}) {
    for (const double at : {1.0, 0.0, -1e-3, 123.0, 1e6}) {
      EXPECT_EQ(warningsAt<Kink>(at, at - distance), Texts()) << at << ", kink at " << distance;
      EXPECT_EQ(warningsAt<Noisy>(at, at - distance), Texts()) << at << ", " << distance;
      EXPECT_EQ(warningsAt<Steps>(at + distance, 0.5), Texts()) << at << ", " << distance;
      EXPECT_EQ(warningsAt<Cancelling>(at, at - distance), Texts()) << at << ", " << distance;
      EXPECT_EQ(warningsAt<Flat>(at, at - distance), Texts()) << at << ", " << distance;
    }
    EXPECT_EQ(warningsAt<Root>(2 - distance, 0.1), Texts()) << distance;
    EXPECT_EQ(warningsAt<Throwing>(1 - distance, 0.1), Texts()) << distance;
  }
}

TEST(GivenDerivatives, AreNotJudgedWhereACurveIsFlat) {
  slom::Estimator est;
  const auto middle = est.insertRV(0.25), width = est.insertRV(0.03);
  for (int i = 0; i < 40; ++i) {
    const double x = -3 + 0.15 * i;
    est.insertMeasurement(
        [](const auto& a, const auto& b, double at) {
          using std::erfc;
          return 0.5 * erfc((a - at) / b) - 0.5;
        },
        middle, width, x);
  }
  EXPECT_TRUE(slom::checkDerivatives(est).ok()) << slom::checkDerivatives(est).text();
}

}  // namespace
