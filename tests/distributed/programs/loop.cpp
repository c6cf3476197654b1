// A closed levelling loop of 600 stretches, of which each process has a part, with a mistake on request.
//   loop          fits, and prints the standard deviation of benchmark 300
//   loop free     no benchmark is fixed
//   loop start    one process starts the benchmark that it shares at another height
//   loop twonames one process gives a benchmark two names
//   loop fails    one process throws an error before the fit
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <slom/distributed.hpp>
#include <slom/slom.hpp>

namespace {

constexpr int count = 600;

void fit(const slom::distributed::Session& session, const std::string& what) {
  const int first = session.rank() * count / session.size(),
            last = (session.rank() + 1) * count / session.size();
  const bool is_last = session.rank() == session.size() - 1;
  if (what == "fails" && is_last) throw std::runtime_error("there is no file of this stretch");
  slom::Estimator est;
  std::vector<slom::VarID<double>> heights;
  for (int i = first; i <= last; ++i) {
    const int number = i % count;
    if (session.size() == 1 && i == count) {
      heights.push_back(heights.front());
      break;
    }
    const double start = what == "start" && session.rank() == 1 && i == first ? 1 : 0;
    heights.push_back(
        est.insertRV(start, number > 0 || what == "free", "benchmark " + std::to_string(number)));
  }
  for (int i = first; i < last; ++i) {
    const double difference = 0.1 * std::sin(2 * M_PI * i / count) + 0.001 * std::sin(12.9898 * i);
    est.insertMeasurement([](const auto& a, const auto& b) { return b - a; }, heights[std::size_t(i - first)],
                          heights[std::size_t(i - first + 1)], slom::measured(difference),
                          slom::StandardDeviation(0.001));
  }
  slom::distributed::SharedVariables shared;
  shared.share(est, heights.front(), std::uint64_t(first % count));
  shared.share(est, heights.back(), std::uint64_t(last % count));  // the same variable with a single process
  if (what == "twonames" && is_last) shared.share(est, heights.front(), 5000);
  auto own_solver = std::make_unique<slom::distributed::PetscSolver>(est, shared);
  slom::distributed::PetscSolver& solver = *own_solver;
  est.changeSolver(std::move(own_solver));
  const slom::Summary summary = est.optimize();
  if (session.rank() == 0) std::printf("converged %d\n", summary.converged);
  std::fflush(stdout);
  const int number = 300;
  std::vector<slom::AnyVarID> wanted;
  if (number >= first && number < last) wanted.push_back(heights[std::size_t(number - first)]);
  const slom::distributed::Covariances covariances(est, solver, wanted);
  for (const auto& any : wanted)
    std::printf("height %.12f std %.12f\n", any.as<double>(), covariances.standardDeviation(any)[0]);
}

}  // namespace

int main(int argc, char** argv) {
  return slom::distributed::run(
      [&](const slom::distributed::Session& session) { fit(session, argc > 1 ? argv[1] : ""); });
}
