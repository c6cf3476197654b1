// Fits of a user's program on several processes are those of a single one.
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "distributed/mpirun.hpp"

namespace slom::testing {
namespace {

/// What the program parts has printed.
struct Printed {
  std::map<std::string, std::string> words;                 ///< by first word: the rest of the line
  std::map<std::string, std::pair<double, double>> values;  ///< by component: value and standard deviation
  std::string text;

  explicit Printed(const std::string& output) : text(output) {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream in(line);
      std::string name, value, sigma;
      in >> name >> value >> sigma;
      if (name.find('.') != std::string::npos) {
        values[name] = {std::stod(value), std::stod(sigma)};
      } else {
        words[name] = line.substr(std::min(name.size() + 1, line.size()));
      }
    }
  }
  double rss() const { return std::stod(words.at("rss")); }
};

Printed fitted(int processes, const std::string& problem, const std::string& algorithm,
               const std::string& method) {
  const std::vector<std::string> program{SLOM_PARTS, problem, algorithm, method};
  const CommandResult result = processes == 1 ? runCommand(program) : runCommand(mpirun(processes, program));
  EXPECT_EQ(result.exit_code, 0) << problem << ' ' << algorithm << ' ' << method << ": " << result.errors
                                 << result.output.substr(0, 600);
  return Printed(result.exit_code == 0 ? result.output : "rss nan\n");
}

/// Expects the values of a single process, which has the library's own solver.
void expectSame(const Printed& fit, const Printed& alone, const std::string& what) {
  EXPECT_NEAR(fit.rss(), alone.rss(), 1e-10 * alone.rss()) << what;
  std::size_t compared = 0;
  for (const auto& [name, value] : alone.values) {
    if (value.second == 0) continue;  // fixed
    const auto found = fit.values.find(name);
    ASSERT_TRUE(found != fit.values.end()) << what << ": " << name;
    EXPECT_NEAR(found->second.first, value.first, 1e-8 * value.second) << what << ": " << name;
    ++compared;
  }
  EXPECT_GT(compared, 200u) << what;
  for (const char* const word : {"measurements", "unknowns", "converged"})
    EXPECT_EQ(fit.words.at(word), alone.words.at(word)) << what << ": " << word;
}

TEST(Program, FitsAsASingleProcess) {
  const std::map<std::string, std::vector<int>> runs{{"plain", {2, 7}}, {"losses", {3}}, {"fixed", {4}}};
  for (const auto& [problem, numbers] : runs) {
    const Printed alone = fitted(1, problem, "gn", "own");
    for (const int processes : numbers)
      expectSame(fitted(processes, problem, "gn", "auto"), alone,
                 problem + " on " + std::to_string(processes));
  }
}

TEST(Program, FitsWithOneProcessOfASession) {
  expectSame(fitted(1, "plain", "gn", "auto"), fitted(1, "plain", "gn", "own"), "one process");
}

TEST(Program, FitsByEachAlgorithm) {
  for (const char* const algorithm : {"lm", "dogleg"})
    expectSame(fitted(3, "losses", algorithm, "cholesky"), fitted(1, "losses", algorithm, "own"), algorithm);
}

TEST(Program, FitsByEachMethod) {
  const Printed alone = fitted(1, "plain", "gn", "own");
  for (const char* const method : {"jacobi", "block_jacobi", "schwarz", "multigrid", "matrix_free"})
    expectSame(fitted(3, "plain", "gn", method), alone, method);
}

TEST(Program, HasTheSameBitsInEachRun) {
  for (const char* const method : {"jacobi", "block_jacobi", "schwarz", "matrix_free"}) {
    const Printed first = fitted(3, "plain", "gn", method);
    EXPECT_EQ(fitted(3, "plain", "gn", method).text, first.text) << method;
  }
}

TEST(Program, SumsUpGroups) {
  const Printed alone = fitted(1, "losses", "gn", "own"), fit = fitted(3, "losses", "gn", "auto");
  const auto group = [](const Printed& printed) { return printed.text.substr(printed.text.find("group ")); };
  EXPECT_EQ(group(fit), group(alone));
}

CommandResult refused(int processes, const std::string& problem, const std::string& method = "auto") {
  return runCommand(mpirun(processes, {SLOM_PARTS, problem, "gn", method}));
}

CommandResult withPetscOptions(const std::string& options, int processes, const std::string& method) {
  std::vector<std::string> words = mpirun(processes, {SLOM_PARTS, "plain", "gn", method});
  words.insert(words.begin(), {"env", "PETSC_OPTIONS=" + options});
  return runCommand(words);
}

TEST(Program, TakesTheFormOfTheMatrixFromPetscOptions) {
  const Printed free(withPetscOptions("-slom_matrix free", 2, "cholesky").output);
  expectSame(free, fitted(1, "plain", "gn", "own"), "free");
  EXPECT_NE(free.words.at("solver").find("without a matrix"), std::string::npos) << free.words.at("solver");
  const Printed multigrid(withPetscOptions("-ksp_type cg -pc_type gamg", 2, "block_jacobi").output);
  EXPECT_NE(multigrid.words.at("solver").find("cg with gamg"), std::string::npos) << multigrid.text;
  const CommandResult wrong = withPetscOptions("-slom_matrix fre", 2, "auto");
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_NE(
      wrong.errors.find("[slom.petsc-option] -slom_matrix fre: unknown form of the matrix; give free or "
                        "assembled\n"),
      std::string::npos)
      << wrong.errors;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

TEST(Program, NamesWhatNothingDetermines) {
  const CommandResult result = refused(3, "free");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.output.find("converged 0"), std::string::npos) << result.output.substr(0, 400);
  EXPECT_NE(result.output.find("the measurements do not determine pose "), std::string::npos)
      << result.output.substr(0, 600);
}

TEST(Program, PassesOnTheErrorOfOneProcess) {
  const CommandResult result = refused(3, "throws");
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  EXPECT_EQ(count(result.errors, "caught"), 3u) << result.errors;
}

TEST(Program, RefusesDifferentOpinionsOfAVariable) {
  const CommandResult result = refused(2, "disagree");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(count(result.errors, "caught"), 2u) << result.errors;
}

}  // namespace
}  // namespace slom::testing
