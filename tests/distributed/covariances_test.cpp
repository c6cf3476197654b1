// Covariances of chosen variables on several processes are those of a single one.
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "distributed/mpirun.hpp"

namespace slom::testing {
namespace {

using Blocks =
    std::map<std::string, std::vector<double>>;  ///< by variable, or variable-variable; column-major

CommandResult runParts(int processes, const std::string& problem, const std::string& algorithm,
                       const std::string& method) {
  const std::vector<std::string> program{SLOM_PARTS, problem, algorithm, method, "covariances"};
  return processes == 1 ? runCommand(program) : runCommand(mpirun(processes, program));
}

Blocks covariances(int processes, const std::string& problem, const std::string& method) {
  const CommandResult result = runParts(processes, problem, "gn", method);
  EXPECT_EQ(result.exit_code, 0) << problem << ' ' << method << ": " << result.errors;
  Blocks blocks;
  std::istringstream lines(result.output);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    std::vector<double>& block = blocks[name];
    for (double number = 0; words >> number;) block.push_back(number);
  }
  return blocks;
}

/// Returns the standard deviations of a square block.
std::vector<double> deviations(const std::vector<double>& block) {
  const auto n = std::size_t(std::lround(std::sqrt(double(block.size()))));
  std::vector<double> result;
  for (std::size_t i = 0; i < n; ++i) result.push_back(std::sqrt(block[i * n + i]));
  return result;
}

/// Expects each entry to differ by 1e-8 of the product of its standard deviations at most.
void expectSame(const Blocks& found, const Blocks& alone, const std::string& what) {
  ASSERT_GT(alone.size(), 12u) << what;
  ASSERT_EQ(found.size(), alone.size()) << what;
  for (const auto& [name, block] : alone) {
    ASSERT_TRUE(found.count(name) > 0) << what << ": " << name;
    const std::vector<double>& other = found.at(name);
    ASSERT_EQ(other.size(), block.size()) << what << ": " << name;
    const std::size_t dash = name.find('-');
    const std::vector<double> rows = deviations(alone.at(name.substr(0, dash))),
                              columns = deviations(
                                  alone.at(dash == std::string::npos ? name : name.substr(dash + 1)));
    for (std::size_t i = 0; i < block.size(); ++i) {
      const double scale = rows[i % rows.size()] * columns[i / rows.size()];
      ASSERT_NEAR(other[i], block[i], 1e-8 * scale) << what << ": " << name << " entry " << i;
    }
  }
}

TEST(Covariances, AreThoseOfASingleProcess) {
  const Blocks alone = covariances(1, "plain", "own");
  for (const char* const method : {"cholesky", "block_jacobi"}) {
    for (const int processes : {1, 2, 3, 4})
      expectSame(covariances(processes, "plain", method), alone,
                 std::string(method) + " on " + std::to_string(processes));
  }
  expectSame(covariances(3, "plain", "matrix_free"), alone, "matrix_free");
}

TEST(Covariances, KnowLossesFixedComponentsAndTheVarianceFactor) {
  for (const char* const problem : {"losses", "fixed", "estimated"})
    expectSame(covariances(3, problem, "cholesky"), covariances(1, problem, "own"), problem);
}

TEST(Covariances, OfAFreeGaugeAreRefused) {
  const CommandResult exact = runParts(3, "free", "gn", "cholesky");
  EXPECT_EQ(exact.exit_code, 3) << exact.output;
  EXPECT_NE(exact.errors.find("the measurements do not determine pose "), std::string::npos) << exact.errors;
  const CommandResult iterated = runParts(3, "free", "gn", "block_jacobi");
  EXPECT_EQ(iterated.exit_code, 3) << iterated.output;
  EXPECT_NE(iterated.errors.find("[slom.rank-deficient]"), std::string::npos) << iterated.errors;
}

}  // namespace
}  // namespace slom::testing
