// A program of a user on several processes: what it gets, and what it is told of its mistakes.
#include <chrono>
#include <cmath>
#include <string>

#include "distributed/mpirun.hpp"

namespace slom::testing {
namespace {

CommandResult loop(int processes, const std::string& what = "") {
  return runCommand(mpirun(processes, {SLOM_LOOP, what}));
}

/// Returns the number after a word.
double numberAfter(const std::string& text, const std::string& word) {
  const std::size_t at = text.find(word);
  EXPECT_NE(at, std::string::npos) << word << " in " << text;
  return at == std::string::npos ? NAN : std::stod(text.substr(at + word.size()));
}

TEST(Loop, IsFittedAlikeByAnyNumberOfProcesses) {
  const std::string alone = loop(1).output;
  EXPECT_NEAR(numberAfter(alone, "std "), 0.001 * std::sqrt(300 * 300 / 600.0), 1e-12);
  for (const int P : {2, 3}) {
    const CommandResult result = loop(P);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NEAR(numberAfter(result.output, "height "), numberAfter(alone, "height "), 1e-10);
    EXPECT_NEAR(numberAfter(result.output, "std "), numberAfter(alone, "std "), 1e-12);
  }
}

/// The last pivot of a loop is rounding error.
TEST(Loop, WithoutAFixedBenchmarkIsNotDetermined) {
  for (const int P : {1, 2, 3}) {
    const CommandResult result = loop(P, "free");
    EXPECT_EQ(result.output, "converged 0\n");
    EXPECT_EQ(result.errors.find("[slom.rank-deficient] the measurements do not determine benchmark "), 0u)
        << result.errors;
    EXPECT_EQ(result.errors.find("[slom.", 1), std::string::npos) << "said twice: " << result.errors;
    EXPECT_EQ(result.exit_code, 1);
  }
}

void expectBadShare(const std::string& what, const std::string& sentence) {
  const CommandResult result = loop(2, what);
  EXPECT_NE(result.errors.find(sentence), std::string::npos) << result.errors;
  EXPECT_EQ(result.exit_code, 1);
}

TEST(Loop, WithDifferentStartValuesIsRefused) {
  expectBadShare(
      "start",
      "[slom.bad-share] the shared variable benchmark 300 has the value 0 here and another one in another "
      "process; give it the same start value in all");
}

TEST(Loop, WithTwoNamesForAVariableIsRefused) {
  expectBadShare(
      "twonames",
      "[slom.bad-share] the shared variable benchmark 300 has two names in this process; give it the name "
      "that it has in the other processes");
}

TEST(Loop, EndsIfOneProcessFailsBeforeTheFit) {
  const auto start = std::chrono::steady_clock::now();
  const CommandResult result = loop(3, "fails");
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  // mpirun may print its own message first.
  const std::string sentence = "there is no file of this stretch\n";
  const std::size_t at = result.errors.find(sentence);
  ASSERT_NE(at, std::string::npos) << result.errors;
  EXPECT_EQ(result.errors.find(sentence, at + 1), std::string::npos) << "said twice: " << result.errors;
  EXPECT_NE(result.exit_code, 0);
  EXPECT_LT(seconds, 60);  // not forever
}

}  // namespace
}  // namespace slom::testing
