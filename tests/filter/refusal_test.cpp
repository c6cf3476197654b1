// Steps that a filter refuses: the status, its sentence, and that the filter is then as before, to the last bit.
#include <limits>

#include <gtest/gtest.h>

#include <slom/filter.hpp>

#include "support/message_of.hpp"

namespace slom::testing {

using Vec3 = mtk::vect<3>;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class S>
struct BodyOf {
  mtk::trafo<mtk::SO3<S>> pose;
  mtk::vect<3, S> velocity;
};
using Body = BodyOf<double>;

struct Move {
  auto operator()(const auto& x, const Vec3& force, double dt) const {
    auto y = x;
    y.pose.pos += x.velocity * dt;
    y.velocity += force * dt;
    return y;
  }
};
constexpr auto position = [](const auto& x, const Vec3& z) { return x.pose.pos - z; };

/// The arguments behind state and noise of the constructors.
template <class Filter>
inline constexpr bool has_root = false;
template <template <class, template <class, int> class> class Filter>
inline constexpr bool has_root<Filter<Body, SquareRootCovariance>> = true;

template <class Filter>
Filter started() {
  Body x;
  x.velocity = Vec3(1, 2, 3);
  if constexpr (has_root<Filter>) {
    return Filter(x, StandardDeviation(0.1), square_root);
  } else {
    return Filter(x, StandardDeviation(0.1));
  }
}

template <class Filter>
struct Refusal : ::testing::Test {};
using Filters = ::testing::Types<ErrorStateFilter<Body>, ErrorStateFilter<Body, SquareRootCovariance>,
                                 UnscentedFilter<Body>, UnscentedFilter<Body, SquareRootCovariance>>;
TYPED_TEST_SUITE(Refusal, Filters);

TYPED_TEST(Refusal, LeavesTheFilterUnchanged) {
  auto filter = started<TypeParam>();
  ASSERT_TRUE(filter.predict(Move(), StandardDeviation(0.01), Vec3(1, 0, 0), 0.1));
  const auto P = filter.covariance();
  const Vec3 pos = filter.state().pose.pos;
  const auto expect = [&](const auto& result, FilterStatus status) {
    EXPECT_EQ(int(result.status), int(status)) << result.message();
    EXPECT_FALSE(result);
    EXPECT_EQ(filter.covariance(), P);
    EXPECT_EQ(filter.state().pose.pos, pos);
  };
  using enum FilterStatus;
  const Vec3 zero(0, 0, 0), bad(0, kNan, 0);
  expect(filter.predict(Move(), Covariance(0.1), zero, 0.0), bad_duration);
  expect(filter.predict(Move(), Covariance(0.1), zero, -0.1), bad_duration);
  expect(filter.predict(Move(), Covariance(0.1), zero, kNan), bad_duration);
  expect(filter.predict(Move(), Covariance(0.1), zero, std::numeric_limits<double>::infinity()),
         bad_duration);
  expect(filter.predict(Move(), Covariance(0.1), bad, 0.1), data_not_finite);
  expect(filter.predict(Move(), Covariance(-0.1), zero, 0.1), bad_noise);
  expect(filter.predict(Move(), Covariance(kNan), zero, 0.1), bad_noise);
  expect(filter.predict(Move(), SpectralDensity(-1.), zero, Duration(0.1)), bad_noise);
  for (const double dt : {0., -0.1, kNan, std::numeric_limits<double>::infinity()}) {
    expect(filter.predict(Move(), SpectralDensity(1), zero, Duration(dt)), bad_duration);
    expect(filter.predict(Move(), Covariance(1), zero, Duration(dt)), bad_duration);
  }
  const auto reads_beyond = [](const auto& x, const auto& w, double dt) {
    auto y = x;
    y.velocity[0] += (w[1] + w[2]) * dt;
    return y;
  };
  expect(filter.predict(reads_beyond, noiseArgument<2>(StandardDeviation(0.1)), 0.1), function_not_finite);
  Eigen::Matrix<double, 9, 9> Q = Eigen::Matrix<double, 9, 9>::Identity();
  Q(0, 1) = Q(1, 0) = 2;  // an eigenvalue -1
  expect(filter.predict(Move(), Covariance(Q), zero, 0.1), bad_noise);
  Q(0, 1) = 0.1;  // not symmetric
  Q(1, 0) = 0;
  expect(filter.predict(Move(), Covariance(Q), zero, 0.1), bad_noise);
  expect(filter.predict(Move(), Covariance(Eigen::MatrixXd(Eigen::MatrixXd::Identity(8, 8))), zero, 0.1),
         bad_noise);
  expect(filter.predict(
             [](const auto& x, double) {
               return decltype(x){x.pose, x.velocity * kNan};
             },
             Covariance(0.1), 0.1),
         function_not_finite);

  expect(filter.update(position, bad, StandardDeviation(0.1)), data_not_finite);
  expect(filter.update([](const auto& x) { return x.velocity; }, measured(bad), StandardDeviation(0.1)),
         data_not_finite);
  expect(filter.update(position, zero, StandardDeviation(0.)), bad_noise);
  expect(filter.update(position, zero, StandardDeviation(-1.)), bad_noise);
  expect(filter.update(position, zero, Covariance(Eigen::Vector3d(1, 1, -1))), bad_noise);
  expect(filter.update([](const auto& x, const Vec3&) { return (x.pose.pos * kNan).eval(); }, zero,
                       Covariance(1)),
         function_not_finite);
  expect(filter.update(position, zero, StandardDeviation(0.1), Huber(0)), bad_loss);
  expect(filter.update(position, zero, StandardDeviation(0.1), Cauchy(kNan)), bad_loss);
  expect(filter.update(position, zero, StandardDeviation(0.1), Barron(3, 1)), bad_loss);
  expect(filter.update(position, Vec3(100, 0, 0), StandardDeviation(0.1), Gate(0.999)), gated);

  EXPECT_EQ(int(filter.reset(Body{}, Covariance(-1))), int(bad_state));
  EXPECT_EQ(filter.covariance(), P);
}

TEST(Refusals, SayWhatIsWrong) {
  auto filter = started<ErrorStateFilter<Body>>();
  EXPECT_STREQ(
      filter.predict(Move(), Covariance(0.1), Vec3(0, 0, 0), -0.1).message(),
      "the duration of the prediction, its last argument if none is marked, is not positive and finite; pass the "
      "time since the last prediction in seconds, sort readings by time, and mark a duration that is not last by "
      "slom::Duration(seconds)");
  EXPECT_EQ(
      messageOf([] { ErrorStateFilter(mtk::vect<2>(1, 2), Covariance(-1)); }),
      "[slom.bad-filter-state] filter: the state or its covariance is not valid; pass finite numbers and a symmetric "
      "covariance without negative eigenvalues");
  EXPECT_EQ(
      messageOf([] { UnscentedFilter(mtk::vect<2>(1, 2), Covariance(1), SigmaSpread(0.5)); }),
      "[slom.bad-filter-state] filter: the spread of the sigma points is below 1 or not finite; pass 1 to 3 standard "
      "deviations");
  EXPECT_EQ(
      messageOf([] { Gate(99); }),
      "[slom.bad-option] gate: the probability of passing is not between 0 and 1; pass a number such as 0.999");
  EXPECT_EQ(messageOf([] { Iterations(0); }),
            "[slom.bad-option] iterations: an update needs at least 1; pass a number such as 10");
}

TEST(Refusals, AMeasurementThatDoesNotDependOnTheStateIsNamed) {
  const auto check = [](auto filter) {
    const auto before = filter.covariance();
    const auto forgetful =
        filter.update([](const auto& x, double z) { return x[0] * 0. + z; }, 3., StandardDeviation(0.1));
    EXPECT_TRUE(forgetful);
    EXPECT_FALSE(forgetful.depends_on_state);
    EXPECT_EQ(filter.covariance(), before);
    EXPECT_STREQ(
        forgetful.message(),
        "the measurement does not depend on the state here, so the filter is unchanged; check that the function uses "
        "its state, and that the state is not at a point where its derivatives are 0");
    const auto good =
        filter.update([](const auto& x, double z) { return x[0] - z; }, 3., StandardDeviation(0.1));
    EXPECT_TRUE(good.depends_on_state);
    EXPECT_STREQ(good.message(), "the step was taken");
  };
  check(ErrorStateFilter(mtk::vect<2>(1, 2), Covariance(1)));
  check(UnscentedFilter(mtk::vect<2>(1, 2), Covariance(1)));
}

TEST(Refusals, AMarkedDurationIsANumberAtItsPlace) {
  const auto drive = [](const auto& x, double dt, double forward) {
    auto y = x;
    y[0] += forward * dt;
    return y;
  };
  const auto check = [&](auto filter) {
    ASSERT_TRUE(filter.predict(drive, Covariance(0), Duration(2), -0.5));  // the last number is no duration
    EXPECT_DOUBLE_EQ(filter.state()[0], 0);
    ASSERT_TRUE(filter.predict(drive, SpectralDensity(3), Duration(2), -0.5));
    EXPECT_DOUBLE_EQ(filter.state()[0], -1);
    EXPECT_NEAR(filter.covariance()(0, 0), 1 + 3 * 2, 1e-14);
    EXPECT_EQ(filter.predict(drive, Covariance(0), 2., -0.5).status, FilterStatus::bad_duration);
  };
  check(ErrorStateFilter(mtk::vect<1>(1), Covariance(1)));
  check(UnscentedFilter(mtk::vect<1>(1), Covariance(1), square_root));
}

TEST(Refusals, UncertaintyOfZeroIsAllowedInAState) {
  ErrorStateFilter filter(mtk::vect<2>(1, 2), Covariance(Eigen::Vector2d(0, 1)), square_root);
  ASSERT_TRUE(filter.update([](const auto& x) { return x[0] - 3; }, StandardDeviation(1)));
  EXPECT_EQ(filter.state()[0], 1);
  ASSERT_TRUE(filter.update([](const auto& x) { return x[0] + x[1] - 4; }, StandardDeviation(1)));
  EXPECT_NEAR(filter.state()[1], 2.5, 1e-15);
}

}  // namespace slom::testing
