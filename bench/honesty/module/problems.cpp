// The starts of bench_honesty and the check of its claims for by_scipy.py, as plain functions of a shared library.
#include <cstdint>

#include <mtk/dual.hpp>

#include "support/classics/problem.hpp"

using namespace slom::testing::classics;

namespace {

Problem problemOf(int set, std::uint64_t number) {
  switch (set) {
    case 0:
      return publishedStarts()[number];
    case 1:
      return randomClassic(number);
    case 2:
      return randomCurve(number);
    case 3:
      return wideSigmoid(number);
    default:
      return twoDecays(number);
  }
}

}  // namespace

extern "C" {

/// Sets: 0 published starts, 1 classics, 2 curves, 3 sigmoid, 4 decays.
int honesty_published() { return static_cast<int>(publishedStarts().size()); }

/// Returns a problem that is valid until honesty_close.
Problem* honesty_open(int set, std::uint64_t number) { return new Problem(problemOf(set, number)); }
void honesty_close(Problem* problem) { delete problem; }

int honesty_unknowns(const Problem* problem) { return static_cast<int>(problem->start.size()); }
int honesty_residuals(const Problem* problem) { return problem->residuals; }
const double* honesty_start(const Problem* problem) { return problem->start.data(); }

void honesty_evaluate(const Problem* problem, const double* x, double* r) {
  evaluate<double>(*problem, x, r);
}

/// Computes the Jacobian by dual numbers, residuals x unknowns, row-major.
void honesty_jacobian(const Problem* problem, const double* x, double* J) {
  using Dual = mtk::Dual<double, 1>;
  const int n = honesty_unknowns(problem);
  std::vector<Dual> arguments(problem->start.size()), r(static_cast<std::size_t>(problem->residuals));
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) arguments[static_cast<std::size_t>(i)].seed(x[i], i == k ? 0 : -1);
    evaluate<Dual>(*problem, arguments.data(), r.data());
    for (std::size_t m = 0; m < r.size(); ++m)
      J[m * static_cast<std::size_t>(n) + static_cast<std::size_t>(k)] = r[m].partial(0);
  }
}

int honesty_is_false(const Problem* problem, const double* x) {
  return isFalse(*problem, std::vector<double>(x, x + honesty_unknowns(problem))) ? 1 : 0;
}
int honesty_has_free_directions(const Problem* problem, const double* x) {
  return hasFreeDirections(*problem, std::vector<double>(x, x + honesty_unknowns(problem))) ? 1 : 0;
}
int honesty_is_saddle(const Problem* problem, double rss) { return isSaddle(*problem, rss) ? 1 : 0; }
int honesty_is_optimum(const Problem* problem, double rss) { return isOptimum(*problem, rss) ? 1 : 0; }
}
