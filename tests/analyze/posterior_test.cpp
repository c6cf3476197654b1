// The predicted effect of hypothetical measurements equals their effect when they are made.
#include <cmath>
#include <tuple>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <slom/measurements/landmark.hpp>
#include <slom/measurements/range.hpp>
#include <slom/measurements/relative_pose.hpp>
#include <slom/posterior.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using Eigen::MatrixXd;
using slom::measured;
using slom::StandardDeviation;
using slom::testing::messageOf;
using Point = mtk::vect<2>;
using Pose = mtk::trafo<mtk::SO3<>>;
using Place = mtk::vect<3>;

/// Three points by distances from two fixed ones and from each other.
struct Survey {
  slom::Estimator est;
  slom::VarID<Point> church = est.insertRV(Point(0, 0), "church"), mill = est.insertRV(Point(10, 0), "mill"),
                     tower = est.insertRV(Point(6, 8), "tower"), oak = est.insertRV(Point(3, 4.5), "oak");
  Survey() {
    est.fix(church);
    est.fix(mill, "y");
    for (const auto& [a, b] : {std::pair(church, mill), std::pair(church, tower), std::pair(mill, tower),
                               std::pair(church, oak), std::pair(mill, oak)})
      measure(est, a, b, 0.02);
  }
  static void measure(slom::Estimator& e, const slom::VarID<Point>& a, const slom::VarID<Point>& b,
                      double sigma) {
    e.insertMeasurement(slom::Range(), a, b, measured((*a - *b).norm()), StandardDeviation(sigma));
  }
};

TEST(Posterior, OfAFurtherDistanceIsThatOfTheFitWithIt) {
  Survey survey, longer;
  const MatrixXd before = survey.est.jointCovariance(survey.tower, survey.oak);
  auto [what_if, ids] = slom::posterior(survey.est, survey.tower, survey.oak);
  const auto& [tower, oak] = ids;
  EXPECT_LT((what_if.jointCovariance(tower, oak) - before).norm(), 1e-12 * before.norm());
  EXPECT_EQ(what_if.nameOf(tower), "tower");

  Survey::measure(what_if, tower, oak, 0.01);
  Survey::measure(longer.est, longer.tower, longer.oak, 0.01);
  const MatrixXd after = what_if.jointCovariance(tower, oak);
  const MatrixXd oracle = longer.est.jointCovariance(longer.tower, longer.oak);
  EXPECT_LT((after - oracle).norm(), 1e-11 * oracle.norm());
  EXPECT_GT(slom::informationGain(before, after), 0.1);
  EXPECT_NEAR(slom::informationGain(before, after),
              0.5 * std::log(before.determinant() / oracle.determinant()), 1e-9);
  EXPECT_EQ(survey.est.getM(), 5);  // nothing has happened to it
}

/// Adds a photograph: its own pose, and the points it sees.
template <class Estimator, class Id>
void look(Estimator& est, const Id& a, const Id& b, const Id& c, const Pose& from) {
  const auto pose = est.insertRV(from);
  for (const Id& landmark : {a, b, c}) {
    est.insertMeasurement(slom::Landmark(), pose, landmark, measured(Place(pose->inverse() * *landmark)),
                          StandardDeviation(0.1));
  }
}

TEST(Posterior, TakesUnknownsThatComeWithTheMeasurements) {
  const auto make = [](slom::Estimator& est) {
    const std::tuple all{est.insertRV(Place(1, 0, 2), "a"), est.insertRV(Place(-1, 3, 1), "b"),
                         est.insertRV(Place(0, -2, 4), "c")};
    double sigma = 0.2;
    std::apply([&](const auto&... id) { (est.prior(id, *id, sigma *= 1.5), ...); }, all);
    const auto& [a, b, c] = all;
    look(est, a, b, c, Pose(mtk::SO3<>::exp(Place(0.3, -0.2, 0.5)), Place(1, 1, -3)));
    return all;
  };
  slom::Estimator est, longer;
  const auto ids = make(est);
  const auto in_longer = make(longer);
  auto what_if = std::apply([&](const auto&... id) { return slom::posterior(est, id...); }, ids);
  const Pose next(mtk::SO3<>::exp(Place(-1, 2, 0.1)), Place(5, -2, 0));
  std::apply([&](const auto&... id) { look(what_if.estimator, id..., next); }, what_if.ids);
  std::apply([&](const auto&... id) { look(longer, id..., next); }, in_longer);
  const auto joint = [](const slom::Estimator& e, const auto& all) {
    return std::apply([&](const auto&... id) { return e.jointCovariance(id...); }, all);
  };
  const MatrixXd oracle = joint(longer, in_longer);
  EXPECT_LT((joint(what_if.estimator, what_if.ids) - oracle).norm(), 1e-10 * oracle.norm());
}

TEST(Posterior, KeepsFixedWhatIsFixed) {
  Survey survey;
  auto [what_if, ids] = slom::posterior(survey.est, survey.church, survey.mill, survey.tower);
  const auto& [church, mill, tower] = ids;
  EXPECT_EQ(what_if.getN(), 3);
  EXPECT_EQ(what_if.covariance(church), MatrixXd::Zero(2, 2));
  const MatrixXd expected = survey.est.covariance(survey.mill, survey.tower);
  EXPECT_LT((what_if.covariance(mill, tower) - expected).norm(), 1e-12 * expected.norm());
}

TEST(Posterior, SaysWhatItCannotDo) {
  Survey survey;
  EXPECT_EQ(
      messageOf([&] { slom::posterior(survey.est, survey.oak, survey.oak); }),
      "[slom.singular-covariance] a covariance of 4 components is singular, so a combination of them is certain; "
      "leave out variables that follow from the others, such as a variable given twice");
  survey.est.free(survey.church);
  EXPECT_EQ(messageOf([&] { slom::posterior(survey.est, survey.oak); }).substr(0, 17), "[slom.free-gauge]");
  EXPECT_EQ(
      messageOf([] { slom::informationGain(MatrixXd::Identity(2, 2), MatrixXd::Identity(3, 3)); }),
      "[slom.other-sizes] the covariances before and after have 2 and 3 rows; pass two square matrices of the same "
      "components");
  MatrixXd certain = MatrixXd::Identity(2, 2);
  certain(1, 1) = 0;
  EXPECT_EQ(
      messageOf([&] { slom::informationGain(MatrixXd::Identity(2, 2), certain); }),
      "[slom.singular-covariance] a component is certain before the measurements or after them, but not both: its gain is "
      "infinite");
  EXPECT_EQ(slom::informationGain(certain, certain / 4), std::log(2));
  certain(0, 0) = -1;
  EXPECT_EQ(
      messageOf([&] { slom::informationGain(certain, certain); }),
      "[slom.singular-covariance] entry 0 of the diagonal of a covariance is -1; variances are finite and not negative");
}

}  // namespace
