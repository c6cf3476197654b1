// GaussianPriors in files.
#include <sstream>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"
#include "support/random.hpp"

namespace slom::testing {
namespace {

Archive makeArchive() {
  Archive archive;
  archive.variable<Vec3>("point");
  archive.variable<mtk::SO2<>>("angle");
  archive.variable<Eigen::VectorXd>("numbers");
  archive.variable<SE3>("pose");
  archive.measurement<GaussianPrior>();
  return archive;
}

TEST(StoredPriors, IsSavedAndLoaded) {
  RandomValues random(5);
  Estimator est;
  const auto point = est.insertRV(random.vector(1), "point");
  const auto angle = est.insertRV(mtk::SO2<>(random()), "angle");
  const auto numbers = est.insertRV(Eigen::VectorXd(random.matrix(3, 1)), "numbers");
  est.insertMeasurement(GaussianPrior({point, angle, numbers}, random.matrix(7, 7), random.matrix(7, 1))
                            .linearizedAt(point, random.vector(1)),
                        Huber(1.5), named("information"));
  est.insertMeasurement(
      GaussianPrior({angle, angle}, random.matrix(1, 2)).linearizedAt(angle, mtk::SO2<>(0.1)));
  est.insertMeasurement(GaussianPrior({numbers}, MatrixXd(0, 3)));
  est.insertMeasurement(GaussianPrior({point}, random.matrix(3, 3), random.matrix(3, 1)));
  const Archive archive = makeArchive();
  std::ostringstream text;
  archive.save(est, text);
  std::istringstream file(text.str());
  StoredProblem loaded = archive.load(file);
  EXPECT_EQ(loaded.estimator.getRSS(), est.getRSS());  // bit for bit
  std::ostringstream again;
  archive.save(loaded.estimator, again);
  EXPECT_EQ(again.str(), text.str());
  est.optimize();
  loaded.estimator.optimize();
  EXPECT_EQ(loaded.estimator.getRSS(), est.getRSS());
  EXPECT_EQ(*loaded.variable<Vec3>("point"), *point);
}

TEST(StoredPriors, OfPosesIsSavedAndLoaded) {
  RandomValues random(6);
  Estimator est;
  const auto a = est.insertRV(random.pose(1), "a"), b = est.insertRV(random.pose(1), "b");
  est.insertMeasurement(
      GaussianPrior({a, b}, random.matrix(12, 12), random.matrix(12, 1)).linearizedAt(b, random.pose(1)));
  std::ostringstream text;
  makeArchive().save(est, text);
  std::istringstream file(text.str());
  EXPECT_NEAR(makeArchive().load(file).estimator.getRSS(), est.getRSS(), 1e-13 * est.getRSS());
}

TEST(StoredPriors, AreSavedWithTheirFirstEstimates) {
  RandomValues random(7);
  Estimator est;
  const auto point = est.insertRV(random.vector(1), "point");
  const auto prior = est.insertMeasurement(
      GaussianPrior({point}, random.matrix(3, 3)).linearizedAt(point, random.vector(1)).withFirstEstimates());
  std::ostringstream text;
  makeArchive().save(est, text);
  std::istringstream file(text.str());
  StoredProblem loaded = makeArchive().load(file);
  const auto first = [](const Estimator& of) {
    const void* const value = of.table().firstEstimates().of(0);
    return value == nullptr ? Vec3(0, 0, 0) : *static_cast<const Vec3*>(value);
  };
  EXPECT_GT(first(est).norm(), 0);
  EXPECT_EQ(first(loaded.estimator), first(est));
  std::ostringstream again;
  makeArchive().save(loaded.estimator, again);
  EXPECT_EQ(again.str(), text.str());
  est.removeMeasurement(prior);
  EXPECT_TRUE(est.table().firstEstimates().isEmpty());
}

TEST(StoredPriors, FilesThatDoNotFitAreRefused) {
  const auto messageFor = [](const std::string& line) {
    std::istringstream file(
        "slom problem 1\nvariables \"point\"\n\"p\" free 1 2 3\nmeasurements \"GaussianPrior\" \"\"\n" +
        line + "\nend\n");
    return messageOf([&] { makeArchive().load(file, "file"); });
  };
  EXPECT_EQ(messageFor("0 | unit | 1 2 3 1 1 0 0 0.5"), "no error");
  EXPECT_EQ(
      messageFor("0 | unit | 1 2 3 1 1 0 0"),
      "[slom.bad-archive] file:5: the text after the second | is not the data of GaussianPrior: 1 2 3 1 1 0 0");
  EXPECT_EQ(messageFor("0 | unit | 1 2 3 1 1 0 0 0.5 first_estimates"), "no error");
  EXPECT_EQ(
      messageFor("0 | unit | 1 2 3 1 1 0 0 0.5 first"),
      "[slom.bad-archive] file:5: the text after the second | is not the data of GaussianPrior: 1 2 3 1 "
      "1 0 0 0.5 first");
  EXPECT_EQ(messageFor("7 | unit | 1 2 3 0"),
            "[slom.bad-archive] file:5: there is no variable 7; defined above are 0 to 0");
  EXPECT_EQ(messageFor("0 0 unit | 1 2 3 0"),
            "[slom.bad-archive] file:5: a | is missing after the numbers of 2 variables");
  Estimator est;
  const auto x = est.insertRV(Vec3());
  est.insertMeasurement(GaussianPrior({x}, MatrixXd::Identity(3, 3)));
  Archive without;
  without.variable<Vec3>("point");
  std::ostringstream os;
  EXPECT_EQ(
      messageOf([&] { without.save(est, os); }),
      "[slom.not-in-archive] the type of the measurements GaussianPrior is not registered with the archive; name it by "
      "archive.measurement, with the function's type and those of its arguments");
}

}  // namespace
}  // namespace slom::testing
