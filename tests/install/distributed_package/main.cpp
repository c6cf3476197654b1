// Fits the heights of benchmarks along a line that several processes have measured, each a stretch.
#include <cstdio>
#include <memory>
#include <vector>

#include <slom/distributed.hpp>
#include <slom/slom.hpp>

void fitLine(const slom::distributed::Session& session) {
  // This process measures from benchmark first to first + count.
  const int count = 500, first = session.rank() * count;

  slom::Estimator est;
  std::vector<slom::VarID<double>> heights;
  for (int i = 0; i <= count; ++i) {
    const bool is_known = first + i == 0;  // benchmark 0 has height 0
    heights.push_back(est.insertRV(0.0, !is_known, "benchmark " + std::to_string(first + i)));
  }
  for (int i = 0; i < count; ++i) {
    const double difference = 0.1;  // [m], here a number; in your program a line of this process' file
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, heights[i], heights[i + 1],
                          slom::measured(difference), slom::StandardDeviation(0.001));
  }

  slom::distributed::SharedVariables shared;  // with the neighbours along the line
  shared.share(est, heights.front(), first);
  shared.share(est, heights.back(), first + count);
  auto own_solver = std::make_unique<slom::distributed::PetscSolver>(est, shared);
  slom::distributed::PetscSolver& solver = *own_solver;
  est.changeSolver(std::move(own_solver));
  const slom::Summary summary = est.optimize();  // in all processes, with the same summary

  const bool is_last = session.rank() == session.size() - 1;
  // All processes make the object; those without a wish pass an empty list.
  std::vector<slom::AnyVarID> wanted;
  if (is_last) wanted.push_back(heights.back());
  const slom::distributed::Covariances covariances(est, solver, wanted);
  if (is_last)
    std::printf("converged: %d, benchmark %d: %.3f m, standard deviation %.4f m\n", summary.converged,
                first + count, *heights.back(), covariances.standardDeviation(heights.back())[0]);
}

int main() { return slom::distributed::run(fitLine); }
