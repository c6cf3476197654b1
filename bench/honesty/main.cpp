// Does "converged" hold? Fits from random starts, their claims checked in long double.
//
//   bench_honesty [--first K] [--fits N] [--slom] [--verbose]
//     N random starts of each set, 1000 without, from number K on, 0 without; --slom: without the peers
//
// by_scipy.py has the rows of SciPy.
//
// A false claim of SLoM ends the program with status 1.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <string>

#include "honesty/methods.hpp"

using namespace slom::bench;
using namespace slom::testing::classics;

namespace {

struct Score {
  int fits = 0, claims = 0, false_claims = 0, optima = 0;
  double iterations = 0;
};

using Fit = std::function<Claim(const Problem&)>;

void add(Score& score, const Problem& problem, const Fit& fit, bool verbose, int first = 0) {
  const Claim claim = fit(problem);
  ++score.fits;
  score.iterations += claim.iterations;
  if (!claim.converged) return;
  ++score.claims;
  std::string why;
  if (isFalse(problem, claim.x, &why)) {
    ++score.false_claims;
    if (verbose)
      std::printf("    false: %s %d, %s\n", problem.name.c_str(), first + score.fits - 1, why.c_str());
  } else {
    score.optima += isOptimum(problem, claim.rss);
  }
}

void print(const char* set, const char* method, const Score& score) {
  std::printf("%-10s %-28s %8d %8d %8d %8d %10.1f\n", set, method, score.fits, score.claims,
              score.false_claims, score.optima, score.iterations / score.fits);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** words) {
  int fits = 1000;
  int first = 0;
  bool verbose = false, with_peers = true;
  for (int i = 1; i < count; ++i) {
    if (std::strcmp(words[i], "--verbose") == 0) {
      verbose = true;
    } else if (std::strcmp(words[i], "--slom") == 0) {
      with_peers = false;
    } else if (std::strcmp(words[i], "--first") == 0 && i + 1 < count) {
      first = std::atoi(words[++i]);
    } else if (std::strcmp(words[i], "--fits") == 0 && i + 1 < count) {
      fits = std::atoi(words[++i]);
    } else {
      std::fprintf(
          stderr,
          "bench_honesty: unknown argument '%s'; usage: bench_honesty [--first K] [--fits N] [--slom] [--verbose]\n",
          words[i]);
      return 2;
    }
  }
  struct Row {
    const char* name;
    Fit fit;
    bool is_slom;
  };
  std::vector<Row> rows{
      {"SLoM, default", [](const auto& p) { return fitBySlom(p, Method::automatic); }, true},
      {"SLoM, Levenberg-Marquardt", [](const auto& p) { return fitBySlom(p, Method::levenberg_marquardt); },
       true},
      {"SLoM, dog leg", [](const auto& p) { return fitBySlom(p, Method::dog_leg); }, true}};
#ifdef SLOM_BENCH_CERES
  rows.push_back({"Ceres, default", [](const auto& p) { return fitByCeres(p, Method::automatic); }, false});
  rows.push_back({"Ceres, dog leg", [](const auto& p) { return fitByCeres(p, Method::dog_leg); }, false});
#endif
  std::printf("%-10s %-28s %8s %8s %8s %8s %10s\n", "starts", "method", "fits", "claims", "false", "optima",
              "iterations");
  int lies = 0;
  for (const Row& row : rows) {
    if (!row.is_slom && !with_peers) continue;
    Score published, classics, curves;
    for (const Problem& problem : publishedStarts()) add(published, problem, row.fit, verbose);
    print("published", row.name, published);
    for (int i = first; i < first + fits; ++i)
      add(classics, randomClassic(static_cast<std::uint64_t>(i)), row.fit, verbose, first);
    print("classics", row.name, classics);
    for (int i = first; i < first + fits; ++i)
      add(curves, randomCurve(static_cast<std::uint64_t>(i)), row.fit, verbose, first);
    print("curves", row.name, curves);
    if (row.is_slom) lies += published.false_claims + classics.false_claims + curves.false_claims;
  }
  return lies > 0 ? 1 : 0;
}
