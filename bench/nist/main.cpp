// Certified digits found by SLoM and Ceres in NIST's problems of nonlinear regression, each from its two starts.
//
//   bench_nist DATA [--output FILE]   DATA: folder of the .dat files; prints the page, and writes it to FILE
//
// If a fit by SLoM's one setting for all has fewer than 8 digits of a parameter, the program ends with status 1.
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "support/nist/fit.hpp"

#ifdef SLOM_BENCH_CERES
#include "nist/by_ceres.hpp"
#endif

namespace {

using namespace slom;
using testing::nist::digits;
using testing::nist::Fit;
using testing::nist::kCautiousDamping;
using testing::nist::Problem;

struct Method {
  std::string name, what;
  std::function<Fit(const Problem&, const Eigen::VectorXd&)> fit;
};

/// Returns the method of a fit by SLoM, to the last digit.
template <class A>
Method bySlom(std::string name, std::string what, const A& algorithm) {
  return {std::move(name), std::move(what),
          [algorithm](const Problem& problem, const Eigen::VectorXd& start) {
            return testing::nist::fitBySlom(problem, start, algorithm, testing::nist::toTheLastDigit());
          }};
}

Method asItComes() {
  return {"SLoM, as it comes", "`est.optimize()`: default algorithm, options and solver",
          testing::nist::fitAsItComes};
}

#ifdef SLOM_BENCH_CERES
Method byCeres(std::string name, std::string what, bench::CeresMethod method, double radius) {
  return {std::move(name), std::move(what), [=](const Problem& problem, const Eigen::VectorXd& start) {
            return bench::fitByCeres(problem, start, method, radius);
          }};
}
#endif

/// Returns the methods. The first must solve all problems.
std::vector<Method> methods() {
  std::vector<Method> all{
      bySlom("SLoM", "`LevenbergMarquardt(1e3)`: short first steps, because some starts are far off",
             LevenbergMarquardt(kCautiousDamping)),
      bySlom("SLoM, default damping", "`LevenbergMarquardt()`", LevenbergMarquardt()),
      bySlom("SLoM, dog leg", "`DogLeg()`", DogLeg()),
      bySlom("SLoM, Gauss-Newton",
             "`GaussNewton()`, which continues with Levenberg-Marquardt if a step leads uphill",
             GaussNewton()),
      asItComes()};
#ifdef SLOM_BENCH_CERES
  using enum bench::CeresMethod;
  all.push_back(byCeres("Ceres", "Levenberg-Marquardt with the default trust region, 1e4",
                        levenberg_marquardt, bench::kCeresRadius));
  all.push_back(byCeres(
      "Ceres, short steps",
      "the same with a first trust region of 1e-3, the inverse of the damping of SLoM in the first row",
      levenberg_marquardt, 1 / kCautiousDamping));
  all.push_back(byCeres("Ceres, dog leg", "its traditional dog leg with the default trust region", dog_leg,
                        bench::kCeresRadius));
#endif
  return all;
}

struct Score {
  double parameters = 0, deviations = 0;
  int iterations = 0;
};

struct Row {
  const Problem* problem;
  int start;
  std::vector<Score> scores;  ///< one per method
};

std::vector<Row> scoreAll(const std::vector<Problem>& problems, const std::vector<Method>& all) {
  std::vector<Row> rows;
  for (const Problem& problem : problems) {
    for (int s = 0; s < 2; ++s) {
      Row row{&problem, s + 1, {}};
      for (const Method& method : all) {
        const Fit fit = method.fit(problem, problem.starts[static_cast<std::size_t>(s)]);
        row.scores.push_back({digits(fit.parameters, problem.parameters),
                              digits(fit.deviations, problem.deviations), fit.iterations});
      }
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

std::string text(const char* format, double a, double b, int n) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, a, b, n);
  return buffer;
}

/// Returns the number of fits whose `member` has at least `least` digits.
int countFrom(const std::vector<Row>& rows, std::size_t method, double Score::*member, double least) {
  int count = 0;
  for (const Row& row : rows) count += row.scores[method].*member >= least;
  return count;
}

void writeIntroduction(std::ostream& out) {
  out << "# Certified digits\n\n"
         "How many digits of a fit are right? NIST's Statistical Reference Datasets (<https://www.itl.nist.gov/div898/strd>) "
         "have 27 problems of nonlinear regression,\neach with two starts. NIST certifies the parameters and their standard "
         "deviations to 11 digits. This page counts how many digits of the fits agree.\nIt was written by\n\n"
         "    cmake --preset bench && cmake --build --preset bench --target bench_nist\n"
         "    build/bench/bench/bench_nist DATA --output docs/nist.md\n\n"
         "The number of digits is `-log10(|x - c| / |c|)` for the certified value c, at most 11. The tables give it for the "
         "parameter with the fewest digits. 0 means that\nthe fit ended at another minimum, or at none. 4 digits are enough for "
         "any use. More digits show how much accuracy the arithmetic loses.\n\n";
}

void writeSummary(std::ostream& out, const std::vector<Method>& all, const std::vector<Row>& rows) {
  out << "| of " << rows.size()
      << " fits | parameters to 8 digits | to 4 digits | standard deviations to 8 digits | to 4 digits | setting |\n"
         "| --- | ---: | ---: | ---: | ---: | --- |\n";
  for (std::size_t m = 0; m < all.size(); ++m) {
    out << "| " << all[m].name;
    for (double Score::*member : {&Score::parameters, &Score::deviations}) {
      for (const double least : {8.0, 4.0}) out << " | " << countFrom(rows, m, member, least);
    }
    out << " | " << all[m].what << " |\n";
  }
  out << "\nAll settings except \"as it comes\" continue as long as digits are gained: "
      << testing::nist::toTheLastDigit().max_iterations
      << " iterations at most, tolerances at the machine's precision,\nexact derivatives and dense QR (`slom::DenseQR`, Ceres' "
         "`DENSE_QR`). Standard deviations come from `est.setSigma(slom::Sigma::estimated)`,\nin Ceres from `Covariance` by "
         "`DENSE_SVD` times RSS / redundancy.\n\n"
         "The data of Lanczos1 were generated from its model to 14 digits, so its residuals are about 1e-13. The rounding errors of "
         "the predictions are about 1e-16, so double\nprecision resolves only 3 digits of the RSS and of the standard "
         "deviations.\n\n";
}

void writeTable(std::ostream& out, const std::vector<Method>& all, const std::vector<Row>& rows) {
  out << "Digits of the parameters / of the standard deviations (iterations):\n\n| problem | level | start";
  for (const Method& method : all) out << " | " << method.name;
  out << " |\n| --- | --- | ---:";
  for (std::size_t m = 0; m < all.size(); ++m) out << " | ---:";
  out << " |\n";
  for (const Row& row : rows) {
    out << "| " << row.problem->name << " | " << row.problem->difficulty << " | " << row.start;
    for (const Score& score : row.scores)
      out << " | " << text("%.1f / %.1f (%d)", score.parameters, score.deviations, score.iterations);
    out << " |\n";
  }
}

int run(const std::string& data, const std::string& output) {
  const std::vector<Problem> problems = testing::nist::readProblems(data);
  const std::vector<Method> all = methods();
  const std::vector<Row> rows = scoreAll(problems, all);
  std::ostringstream page;
  writeIntroduction(page);
  writeSummary(page, all, rows);
  writeTable(page, all, rows);
  std::cout << page.str();
  if (!output.empty()) {
    std::ofstream file(output);
    file << page.str();
    if (!file.flush())
      throw std::runtime_error(output + ": cannot be written; name a file in a folder that you may write to");
  }
  return countFrom(rows, 0, &Score::parameters, 8) == static_cast<int>(rows.size()) ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  std::string data, output;
  bool ok = true;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--output" && i + 1 < argc) {
      output = argv[++i];
    } else if (data.empty() && argument.rfind("--", 0) != 0) {
      data = argument;
    } else {
      ok = false;
    }
  }
  if (!ok || data.empty()) {
    std::cerr << "usage: bench_nist DATA [--output FILE], with DATA the folder of NIST's .dat files\n";
    return 2;
  }
  try {
    return run(data, output);
  } catch (const std::exception& error) {
    std::cerr << "bench_nist: " << error.what() << "\n";
    return 2;
  }
}
