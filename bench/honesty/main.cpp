// Checks claims of convergence: fits from random starts, with claims checked in long double.
//
//   bench_honesty [--first K] [--fits N] [--set NAME] [--slom] [--verbose]
//     --first K   number of the first random start of each set; 0 by default
//     --fits N    number of random starts of each set; 1000 by default
//     --set NAME  only this set
//     --slom      without the peers
//
// by_scipy.py has the rows of SciPy.
//
// If a claim of SLoM is false, the program ends with status 1.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "honesty/methods.hpp"

using namespace slom::bench;
using namespace slom::testing::classics;

namespace {

struct Score {
  int fits = 0, throws = 0, claims = 0, false_claims = 0;
  int free = 0;     ///< true claims with free directions, away from the known minima
  int saddles = 0;  ///< fits that end at the known saddle, whatever their claim
  int optima = 0;
  double iterations = 0;
};

using Fit = std::function<Claim(const Problem&)>;

struct Set {
  const char* name;
  std::function<Problem(std::uint64_t)> problem;
  int count = -1;  ///< number of its problems; -1: as many as requested
};

struct Row {
  const char* name;
  Fit fit;
  bool is_slom;
};

void add(Score& score, const Problem& problem, const Fit& fit, bool verbose, int number) {
  const Claim claim = fit(problem);
  ++score.fits;
  score.throws += claim.threw ? 1 : 0;
  score.iterations += claim.iterations;
  score.saddles += isSaddle(problem, claim.rss) ? 1 : 0;
  if (!claim.converged) return;
  ++score.claims;
  std::string why;
  if (isFalse(problem, claim.x, &why)) {
    ++score.false_claims;
    if (verbose) std::printf("    false: %s %d, %s\n", problem.name.c_str(), number, why.c_str());
  } else if (isOptimum(problem, claim.rss)) {
    ++score.optima;
  } else if (hasFreeDirections(problem, claim.x)) {
    ++score.free;
    if (verbose)
      std::printf("    free directions: %s %d, RSS %.9g\n", problem.name.c_str(), number, claim.rss);
  }
}

void print(const char* set, const char* method, const Score& score) {
  std::printf("%-10s %-28s %8d %8d %8d %8d %8d %8d %8d %10.1f\n", set, method, score.fits, score.throws,
              score.claims, score.false_claims, score.free, score.saddles, score.optima,
              score.iterations / score.fits);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
  int fits = 1000;
  int first = 0;
  bool verbose = false, with_peers = true;
  std::string only;
  for (int i = 1; i < count; ++i) {
    if (std::strcmp(words[i], "--verbose") == 0) {
      verbose = true;
    } else if (std::strcmp(words[i], "--slom") == 0) {
      with_peers = false;
    } else if (std::strcmp(words[i], "--first") == 0 && i + 1 < count) {
      first = std::atoi(words[++i]);
    } else if (std::strcmp(words[i], "--fits") == 0 && i + 1 < count) {
      fits = std::atoi(words[++i]);
    } else if (std::strcmp(words[i], "--set") == 0 && i + 1 < count) {
      only = words[++i];
    } else {
      std::fprintf(
          stderr,
          "bench_honesty: unknown argument '%s'; usage: bench_honesty [--first K] [--fits N] [--set NAME] "
          "[--slom] [--verbose]\n",
          words[i]);
      return 2;
    }
  }
  const auto published = publishedStarts();
  const std::vector<Set> sets{
      {"published", [&](std::uint64_t i) { return published[i]; }, static_cast<int>(published.size())},
      {"classics", randomClassic},
      {"curves", randomCurve},
      {"sigmoid", wideSigmoid},
      {"decays", twoDecays}};
  std::vector<Row> methods{
      {"SLoM, default", [](const auto& p) { return fitBySlom(p, Method::automatic); }, true},
      {"SLoM, Levenberg-Marquardt", [](const auto& p) { return fitBySlom(p, Method::levenberg_marquardt); },
       true},
      {"SLoM, dog leg", [](const auto& p) { return fitBySlom(p, Method::dog_leg); }, true}};
#ifdef SLOM_BENCH_CERES
  methods.push_back(
      {"Ceres, default", [](const auto& p) { return fitByCeres(p, Method::automatic); }, false});
  methods.push_back({"Ceres, dog leg", [](const auto& p) { return fitByCeres(p, Method::dog_leg); }, false});
#endif
  std::printf("%-10s %-28s %8s %8s %8s %8s %8s %8s %8s %10s\n", "starts", "method", "fits", "throws",
              "claims", "false", "free", "saddle", "optima", "iterations");
  int lies = 0;
  for (const Row& method : methods) {
    if (!method.is_slom && !with_peers) continue;
    for (const Set& set : sets) {
      if (!only.empty() && only != set.name) continue;
      Score score;
      const int begin = set.count < 0 ? first : 0, end = set.count < 0 ? first + fits : set.count;
      for (int i = begin; i < end; ++i)
        add(score, set.problem(static_cast<std::uint64_t>(i)), method.fit, verbose, i);
      print(set.name, method.name, score);
      if (method.is_slom) lies += score.false_claims;
    }
  }
  return lies > 0 ? 1 : 0;
}
