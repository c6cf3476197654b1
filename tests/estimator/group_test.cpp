// Groups of measurements that may share errors: kept through insertion, removal, marginalisation and archives.
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <slom/archive.hpp>
#include <slom/problem/group_table.hpp>
#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;
using Scalar = mtk::Scalar<double>;

const auto is = [](const auto& x) { return x; };

/// The key of a measurement, `-` without one.
template <class M>
std::string keyOf(const slom::Estimator& est, const slom::MeasID<M>& id, const std::string& dimension = "") {
  const slom::GroupTable* const groups = est.table().groups();
  const int d = groups == nullptr ? -1 : groups->find(dimension);
  if (d < 0) return "-";
  const auto [pool, i] = est.table().locate(id);
  const int key = pool->groupKey(d, i);
  return key < 0 ? "-" : groups->keys(d)[static_cast<std::size_t>(key)].name();
}

TEST(Group, IsAnOptionInAnyPlace) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  const auto a =
      est.insertMeasurement(is, x, slom::group(17), slom::measured(1.0), slom::StandardDeviation(0.1));
  const auto b = est.insertMeasurement(is, x, slom::measured(1.0), slom::group("image", 4),
                                       slom::StandardDeviation(0.1), slom::group("side", "left"));
  const auto c = est.insertMeasurement(is, x, slom::measured(1.0));
  const auto d = est.insertMeasurement(is, x, slom::measured(1.0), slom::group("left"));
  EXPECT_EQ(keyOf(est, a), "17");
  EXPECT_EQ(keyOf(est, a, "image"), "-");
  EXPECT_EQ(keyOf(est, b), "-");
  EXPECT_EQ(keyOf(est, b, "image"), "4");
  EXPECT_EQ(keyOf(est, b, "side"), "left");
  EXPECT_EQ(keyOf(est, c), "-");
  EXPECT_EQ(keyOf(est, d), "left");
  EXPECT_EQ(keyOf(est, d, "corner"), "-");
}

TEST(Group, OfListsAndDeclaredMeasurements) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  const auto list = [](std::span<const slom::VariableView> all) { return all[0].as<double>() - 1; };
  const auto a = est.insertMeasurement(list, {slom::AnyVarID(x)}, slom::group("image", 2));
  const auto b = est.insertMeasurement(slom::GaussianPrior({x}, Eigen::MatrixXd::Identity(1, 1)),
                                       slom::group("image", 3));
  EXPECT_EQ(keyOf(est, a, "image"), "2");
  EXPECT_EQ(keyOf(est, b, "image"), "3");
}

TEST(Group, StaysWhenOthersGo) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  std::vector<decltype(est.insertMeasurement(is, x, slom::measured(1.0)))> ids;
  for (int i = 0; i < 12; ++i) {
    if (i % 3 == 2)
      ids.push_back(est.insertMeasurement(is, x, slom::measured(1.0)));
    else
      ids.push_back(est.insertMeasurement(is, x, slom::measured(1.0), slom::group("g", 100 + i)));
  }
  for (const int gone : {0, 11, 4, 5, 10}) {
    est.removeMeasurement(ids[static_cast<std::size_t>(gone)]);
    ids[static_cast<std::size_t>(gone)] = {};
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (ids[i] == decltype(ids)::value_type()) continue;
      EXPECT_EQ(keyOf(est, ids[i], "g"), i % 3 == 2 ? "-" : std::to_string(100 + i))
          << i << " without " << gone;
    }
  }
  // A new one takes no key from one that went.
  EXPECT_EQ(keyOf(est, est.insertMeasurement(is, x, slom::measured(1.0)), "g"), "-");
  slom::Estimator moved = std::move(est);
  EXPECT_EQ(keyOf(moved, ids[7], "g"), "107");
}

TEST(Group, CanBeSetLater) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  const auto a = est.insertMeasurement(is, x, slom::measured(1.0), slom::group("g", 1));
  est.setGroup(a, slom::group("g", "one"));
  est.setGroup(a, slom::group("h", 2));
  EXPECT_EQ(keyOf(est, a, "g"), "one");
  EXPECT_EQ(keyOf(est, a, "h"), "2");
}

TEST(Group, OneOfEachDimension) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0);
  EXPECT_EQ(
      messageOf([&] { est.insertMeasurement(is, x, slom::measured(1.0), slom::group(1), slom::group(2)); }),
      "[slom.bad-group] a measurement is put into two groups; pass slom::group once, or once for each of several "
      "names: slom::group(\"image\", 17)");
  EXPECT_EQ(
      messageOf([&] {
        est.insertMeasurement(is, x, slom::measured(1.0), slom::group("g", 1), slom::group("g", "two"));
      }),
      "[slom.bad-group] a measurement is put into two groups of \"g\"; pass slom::group once, or once for each of "
      "several names: slom::group(\"image\", 17)");
  EXPECT_EQ(est.getM(), 0);
}

TEST(Group, OfPriorsIsThatOfAllThatTheyReplace) {
  const auto difference = [](const auto& a, const auto& b) { return b - a; };
  for (const bool is_mixed : {false, true}) {
    slom::Estimator est;
    const auto x = est.insertRV(0.0), y = est.insertRV(1.0);
    est.insertMeasurement(is, y, slom::measured(1.0), slom::group("g", 5));
    est.insertMeasurement(is, x, slom::measured(0.0), slom::group("g", 7), slom::group("h", 1));
    est.insertMeasurement(difference, x, y, slom::measured(1.0), slom::group("g", is_mixed ? 8 : 7));
    const auto priors = est.marginalize({x});
    ASSERT_EQ(priors.size(), 1U);
    EXPECT_EQ(keyOf(est, priors[0], "g"), is_mixed ? "-" : "7");
    EXPECT_EQ(keyOf(est, priors[0], "h"), "-");
  }
}

/// A function object, as archives want it.
struct Is {
  auto operator()(const auto& x) const { return x; }
};

TEST(Group, IsInArchives) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement(Is(), x, slom::measured(1.0), slom::group(-3), slom::group("side", "the \"left\""));
  est.insertMeasurement(Is(), x, slom::measured(2.0), slom::Huber(2), slom::StandardDeviation(0.5),
                        slom::group("side", 4));
  est.insertMeasurement(Is(), x, slom::measured(3.0));
  slom::Archive archive;
  archive.measurement<Is, slom::VarID<double>, slom::Measured<double>>("is");
  std::ostringstream saved;
  archive.save(est, saved);
  EXPECT_NE(saved.str().find("0 | unit group \"\" -3 group \"side\" \"the \\\"left\\\"\" | 1\n"
                             "0 | scalar 2 huber 2 group \"side\" 4 | 2\n"
                             "0 | unit | 3\n"),
            std::string::npos)
      << saved.str();
  std::istringstream text(saved.str());
  const slom::StoredProblem loaded = archive.load(text);
  std::ostringstream again;
  archive.save(loaded.estimator, again);
  EXPECT_EQ(again.str(), saved.str());
}

TEST(Group, FaultsInArchives) {
  slom::Archive archive;
  archive.measurement<Is, slom::VarID<double>, slom::Measured<double>>("is");
  const auto faultOf = [&](const std::string& options) {
    std::istringstream text(
        "slom problem 1\nvariables \"double\"\n\"x\" free 1\nmeasurements \"is\" \"\"\n0 | unit " + options +
        " | 1\nend\n");
    return messageOf([&] { archive.load(text, "FILE"); });
  };
  EXPECT_EQ(faultOf("group \"a\" 1"), "no error");
  EXPECT_EQ(faultOf("group"), "[slom.bad-archive] FILE:5: write group \"NAME\" KEY");
  EXPECT_EQ(faultOf("group a 1"), "[slom.bad-archive] FILE:5: write group \"NAME\" KEY");
  EXPECT_EQ(faultOf("group \"a\" b"),
            "[slom.bad-archive] FILE:5: the key of a group is a whole number or a text in quotes");
  EXPECT_EQ(faultOf("group \"a\" 1 2"),
            "[slom.bad-archive] FILE:5: a | is missing after the noise and the "
            "loss");
  EXPECT_EQ(
      faultOf("group \"a\" 1 group \"a\" 2"),
      "[slom.bad-archive] FILE:5: a measurement is put into two groups of \"a\"; pass slom::group once, or once for "
      "each of several names: slom::group(\"image\", 17)");
}

}  // namespace
