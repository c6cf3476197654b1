// Parts of errors, which a program reads without parsing the text.
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "slom/fixed_lag.hpp"
#include "slom/measurements.hpp"
#include "slom/measurements/gaussian_prior.hpp"
#include "slom/slom.hpp"

namespace slom {
namespace {

using Point = mtk::vect<2>;

mtk::Error errorOf(const std::function<void()>& f) {
  try {
    f();
  } catch (const mtk::Error& error) {
    return error;
  }
  return {"none", "no error"};
}

TEST(ErrorParts, AreTheSentenceAndWhatItIsAbout) {
  const mtk::Error error("slom.example", "pose[3] is upside down; turn it", "pose[3]");
  EXPECT_STREQ(error.what(), "[slom.example] pose[3] is upside down; turn it");
  EXPECT_EQ(error.id(), "slom.example");
  EXPECT_EQ(error.subject(), "pose[3]");
  EXPECT_EQ(error.sentence(), "pose[3] is upside down; turn it");
  EXPECT_EQ(error.fault(), "pose[3] is upside down");
  EXPECT_EQ(error.remedy(), "turn it");
  const mtk::Error plain("slom.example", "nothing can be done");
  EXPECT_EQ(plain.subject(), "");
  EXPECT_EQ(plain.fault(), plain.sentence());
  EXPECT_EQ(plain.remedy(), "");
  const mtk::Error semicolon("slom.example", "measurement c; d is bad", "c; d");
  EXPECT_EQ(semicolon.fault(), semicolon.sentence());
  EXPECT_EQ(semicolon.remedy(), "");
  const mtk::Error mended("slom.example", "measurement c; d is bad; remove it", "c; d");
  EXPECT_EQ(mended.fault(), "measurement c; d is bad");
  EXPECT_EQ(mended.remedy(), "remove it");
  const mtk::Error copy = error;  // the views are of the copy
  EXPECT_EQ(copy.fault(), "pose[3] is upside down");
}

TEST(ErrorParts, NameTheUsersThings) {
  Estimator est;
  const auto p = est.insertRV(Point(1, 2), "p"), q = est.insertRV(Point(3, 4), "q");
  const auto removed = est.insertRV(1.0, "removed");
  est.removeRV(removed);
  const auto range = est.insertMeasurement(Range(), p, q, measured(2.0), StandardDeviation(0.1));
  struct Case {
    const char* subject;
    const char* id;
    std::function<void()> f;
  };
  const auto expect = [](const Case& c) {
    const mtk::Error error = errorOf(c.f);
    EXPECT_EQ(error.subject(), c.subject) << error.what();
    EXPECT_EQ(error.id(), c.id);
    EXPECT_NE(error.remedy(), "") << error.what();
    // What is named is in the sentence, so that nobody reads of it elsewhere alone.
    EXPECT_NE(error.sentence().find(error.subject()), std::string_view::npos) << error.what();
  };
  expect({"p", "slom.variable-in-use", [&] { est.removeRV(p); }});
  expect({"p.x", "slom.outside-bound", [&] { est.bound(p, "x", 5, 6); }});
  expect({"p.x", "slom.bad-bound", [&] { est.bound(p, "x", 6, 5); }});
  expect({"VarID<double>", "slom.stale-handle", [&] { est.fix(removed); }});
  expect({"Range #2", "slom.not-positive-definite",
          [&] { est.insertMeasurement(Range(), p, q, measured(2.0), StandardDeviation(-1.)); }});
  expect({"Range #2", "slom.bad-loss",
          [&] { est.insertMeasurement(Range(), p, q, measured(2.0), StandardDeviation(1.), Huber(-1)); }});
  expect({"max_iterations", "slom.bad-option", [&] { est.optimize({.max_iterations = -7}); }});
  expect({"max_seconds", "slom.bad-option", [&] { est.optimize({.max_seconds = -7}); }});
  expect({"R", "slom.prior-size",
          [&] { est.insertMeasurement(GaussianPrior({p}, Eigen::MatrixXd::Identity(3, 3))); }});
  expect({"duration", "slom.bad-option", [&] { FixedLag lag({.duration = -1}); }});
  est.reinitRV(q, Point(std::nan(""), 0));
  expect({"Range #1", "slom.not-finite", [&] { est.optimizeStep(); }});
  est.reinitRV(q, Point(3, 4));
  est.prior(p, Point(1, 2), 1.);
  est.prior(q, Point(3, 4), 1.);
  const auto lonely = est.insertRV(1.0, "lonely");
  expect({"lonely", "slom.unmeasured-variable", [&] { est.optimizeStep(); }});
  est.removeRV(lonely);
  est.removeMeasurement(range);
  expect({"MeasID<Range>", "slom.stale-handle", [&] { est.removeMeasurement(range); }});
  EXPECT_EQ(errorOf([&] { est.fix(p, "z"); }).subject(), "p");
}

}  // namespace
}  // namespace slom
