// Time of the marginal covariances of all poses, or cameras, by SLoM and by Ceres.
//
//   bench_marginals [--time-limit SECONDS] PROBLEM...   problems as for bench_fit
//
// Fits each problem, then lets both compute covariances at the same values, and prints a Markdown table. If they differ
// by more than 1e-6, relative to the standard deviations, the program ends with status 1.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "fit/problem.hpp"
#include "marginals/marginals.hpp"
#include "support/build_info.hpp"
#include "support/child_process.hpp"

namespace {

using namespace slom::bench;
using Eigen::MatrixXd;

constexpr double kTolerance = 1e-6;

/// Returns the time and all numbers as bytes.
std::string packed(const Marginals& marginals) {
  std::string text(reinterpret_cast<const char*>(&marginals.seconds), sizeof(double));
  for (const MatrixXd& block : marginals.blocks) {
    text.append(reinterpret_cast<const char*>(block.data()),
                sizeof(double) * static_cast<std::size_t>(block.size()));
  }
  return text;
}

/// Restores marginals from bytes; `like` has the same shapes.
Marginals unpacked(const std::string& text, const Marginals& like) {
  Marginals result = like;
  const char* next = text.data();
  const auto read = [&](double* to, Eigen::Index count) {
    const std::size_t bytes = sizeof(double) * static_cast<std::size_t>(count);
    if (next + bytes > text.data() + text.size()) throw std::runtime_error("a result is too short");
    std::memcpy(to, next, bytes);
    next += bytes;
  };
  read(&result.seconds, 1);
  for (MatrixXd& block : result.blocks) read(block.data(), block.size());
  return result;
}

/// Returns the largest |a - b|_ij / (sigma_i sigma_j); NaN if a number is not finite.
double difference(const Marginals& x, const Marginals& y) {
  double largest = 0;
  for (std::size_t k = 0; k < x.blocks.size(); ++k) {
    const MatrixXd &a = x.blocks[k], &b = y.blocks[k];
    for (Eigen::Index j = 0; j < a.cols(); ++j) {
      for (Eigen::Index i = 0; i < a.rows(); ++i) {
        const double off = std::abs(a(i, j) - b(i, j)) / std::sqrt(b(i, i) * b(j, j));
        if (!(off <= largest)) largest = off;
      }
    }
  }
  return largest;
}

void printRow(const Problem& problem, const Marginals& own, const std::optional<Marginals>& peer,
              const std::string& why) {
  std::size_t unknowns = 0, blocks = 0;
  for (const MatrixXd& block : own.blocks)
    unknowns += static_cast<std::size_t>(block.rows()), blocks += block.size() > 0;
  std::printf("| %s | %zu x %zu | %.4g | ", problem.name.c_str(), blocks,
              unknowns / std::max<std::size_t>(blocks, 1), own.seconds);
  if (peer) {
    std::printf("%.4g | %.1f | %.0e |\n", peer->seconds, peer->seconds / own.seconds, difference(own, *peer));
  } else {
    std::printf("%s | - | - |\n", why.c_str());
  }
  std::fflush(stdout);
}

/// Compares the two. Returns false if they differ.
bool compare(Problem& problem, [[maybe_unused]] double time_limit) {
  const Marginals own = std::visit([](auto& data) { return marginalsBySlom(data); }, problem.data);
  std::optional<Marginals> peer;
  std::string why = "-";
#ifdef SLOM_BENCH_CERES
  const ChildOutcome outcome = runInChild(
      [&] {
        return packed(std::visit([](const auto& data) { return marginalsByCeres(data); }, problem.data));
      },
      {time_limit, 0});
  if (outcome.ok) {
    peer = unpacked(outcome.text, own);
  } else {
    why = outcome.text;
  }
#endif
  printRow(problem, own, peer, why);
  return !peer || difference(own, *peer) <= kTolerance;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Marginal covariances by SLoM and by Ceres");
  std::vector<std::string> sources;
  double time_limit = 300;
  app.add_option("problems", sources, "as bench_fit takes them")->required()->type_name("");
  app.add_option("--time-limit", time_limit, "of Ceres for each problem [s]; 0: none")
      ->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  std::cout
      << "| problem | blocks | SLoM [s] | Ceres [s] | ratio | difference |\n| --- | ---: | ---: | ---: | ---: | ---: |"
      << std::endl;
  bool ok = true;
  try {
    for (const std::string& source : sources) {
      Problem problem = loadProblem(source, {});
      ok = compare(problem, time_limit) && ok;
    }
  } catch (const std::exception& error) {
    std::cerr << "bench_marginals: " << error.what() << "\n";
    return 2;
  }
  std::cout << "\nProcessor time, one thread; " << processorName() << "; " << compilerName() << "; "
            << compileFlags() << ".\n";
  if (!ok) std::cerr << "bench_marginals: covariances differ by more than " << kTolerance << "\n";
  return ok ? 0 : 1;
}
