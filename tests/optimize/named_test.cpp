// The table of algorithms, from which the command makes its option --algorithm.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <slom/estimator.hpp>
#include <slom/optimize/named.hpp>

namespace {

TEST(NamedAlgorithms, HaveNamesOfTheirOwnByWhichTheyAreFound) {
  std::set<std::string> names;
  for (const slom::NamedAlgorithm& one : slom::algorithms()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name << " is there twice";
    EXPECT_EQ(slom::algorithmNamed(one.name), &one);
    EXPECT_STRNE(one.description, "") << one.name;
    EXPECT_NE(one.make(), nullptr) << one.name;
  }
  EXPECT_EQ(names, (std::set<std::string>{"dogleg", "gn", "lm"}));
  EXPECT_EQ(slom::algorithmNamed("newton"), nullptr);
  EXPECT_EQ(slom::algorithmNamed(""), nullptr);
}

template <class A>
bool makes(const char* name) {
  return dynamic_cast<A*>(slom::algorithmNamed(name)->make().get()) != nullptr;
}

TEST(NamedAlgorithms, MakeWhatTheySay) {
  EXPECT_TRUE(makes<slom::GaussNewton>("gn"));
  EXPECT_TRUE(makes<slom::LevenbergMarquardt>("lm"));
  EXPECT_TRUE(makes<slom::DogLeg>("dogleg"));
}

TEST(NamedAlgorithms, TheFirstOfWhichIsTheDefault) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement([](double value) { return value; }, x, slom::measured(2.0),
                        slom::StandardDeviation(1));
  EXPECT_EQ(est.optimize().algorithm, slom::algorithms().front().make()->name());
}

}  // namespace
