// A measurement function is saved with the problem, and fitted again without the program: docs/replay.md.
#include <fstream>
#include <iostream>

#include <slom/archive.hpp>
#include <slom/tape.hpp>

int main() {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  est.insertMeasurement(slom::traced([](const auto& x) { return exp(x) - 2.0; }), x);
  std::ofstream file("growth.slom");
  slom::Archive().save(est, file);
  file.close();

  std::ifstream again("growth.slom");
  slom::StoredProblem problem = slom::Archive().load(again, "growth.slom");
  problem.estimator.optimize();
  std::cout << problem.estimator.standardDeviation(problem.variable("x")) << "\n";
}
