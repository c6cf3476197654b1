// Public data sets with known minima.
#include "bundle/bundle_command.hpp"
#include "support/slow_with_sanitizers.hpp"

namespace slom::app::bundle {
namespace {

/// Fits the data set and compares the RSS at the start and at the end.
void expectRss(const std::string& name, double initial, double expected, double tolerance) {
  const auto result =
      testing::command.run({slom::testing::sharedDataPath("bal/" + name).string(), "--quiet", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = testing::Json::parse(result.output);
  EXPECT_NEAR(json["initial_rss"].get<double>(), initial, 1e-9 * initial) << name;
  EXPECT_NEAR(json["final_rss"].get<double>(), expected, tolerance * expected) << name;
}

#define SLOM_BAL(name) SLOM_SKIP_WITHOUT_SHARED_DATA("bal/" name)

TEST(BundleData, Ladybug49) {
  SLOM_BAL("problem-49-7776-pre.txt");
  SLOM_SKIP_WITH_SANITIZERS();
  expectRss("problem-49-7776-pre.txt", 2 * 8.509124607e+05, 26688.7, 1e-3);
}
TEST(BundleData, Dubrovnik16) {
  SLOM_BAL("problem-16-22106-pre.txt");
  SLOM_SKIP_WITH_SANITIZERS();
  expectRss("problem-16-22106-pre.txt", 2 * 4.185659518e+06, 36067.8, 1e-3);
}
TEST(BundleData, Final93Compressed) {
  SLOM_BAL("problem-93-61203-pre.txt.bz2");
  SLOM_SKIP_WITH_SANITIZERS();
  expectRss("problem-93-61203-pre.txt.bz2", 2 * 5.646900249e+06, 291090.4, 1e-3);
}

}  // namespace
}  // namespace slom::app::bundle
