// The table of linear solvers, from which the command makes its option --solver.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <mtk/error.hpp>
#include <slom/solve/block_qr.hpp>
#include <slom/solve/block_solver.hpp>
#include <slom/solve/cholmod.hpp>
#include <slom/solve/dense_qr.hpp>
#include <slom/solve/named.hpp>

namespace {

TEST(NamedSolvers, HaveNamesOfTheirOwnByWhichTheyAreFound) {
  std::set<std::string> names;
  for (const slom::NamedSolver& one : slom::solvers()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name << " is there twice";
    const slom::NamedSolver* const found = slom::solverNamed(one.name);
    ASSERT_NE(found, nullptr) << one.name;
    EXPECT_EQ(found->make, one.make) << one.name;
    EXPECT_EQ(one.missing, nullptr) << one.name;
    EXPECT_STRNE(one.description, "") << one.name;
    EXPECT_NE(one.make(), nullptr) << one.name;
  }
  std::set<std::string> expected{"auto", "cg", "cholesky", "dense-qr", "qr"};
  if (slom::Cholmod::isAvailable()) expected.insert("cholmod");
  EXPECT_EQ(names, expected);
  EXPECT_EQ(slom::solverNamed("lu"), nullptr);
}

template <class S>
bool makes(const char* name) {
  return dynamic_cast<S*>(slom::solverNamed(name)->make().get()) != nullptr;
}

TEST(NamedSolvers, MakeWhatTheySay) {
  EXPECT_TRUE(makes<slom::BlockSolver>("auto"));
  EXPECT_TRUE(makes<slom::BlockSolver>("cholesky"));
  EXPECT_TRUE(makes<slom::BlockSolver>("cg"));
  EXPECT_TRUE(makes<slom::BlockQR>("qr"));
  EXPECT_TRUE(makes<slom::DenseQR>("dense-qr"));
  EXPECT_STREQ(slom::solvers().front().name, "auto");
  EXPECT_TRUE(slom::solverNamed("cholesky")->make()->isExact());
  EXPECT_FALSE(slom::solverNamed("cg")->make()->isExact());
}

TEST(NamedSolvers, SayWhatTheBuildLacks) {
  const slom::NamedSolver* const cholmod = slom::solverNamed("cholmod");
  ASSERT_NE(cholmod, nullptr);
  EXPECT_EQ(cholmod->missing == nullptr, slom::Cholmod::isAvailable());
  if (!slom::Cholmod::isAvailable()) {
    EXPECT_STREQ(cholmod->missing, "CHOLMOD (-DSLOM_WITH_CHOLMOD=ON)");
    EXPECT_THROW(cholmod->make(), mtk::Error);
  }
}

}  // namespace
