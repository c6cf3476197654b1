// Saves a problem to a file, loads it again and fits it: the program of docs/replay.md.
#include <fstream>
#include <iostream>

#include <slom/archive.hpp>
#include <slom/measurements/range.hpp>

using Point = mtk::vect<2>;

int main() {
  slom::Estimator est;
  const auto a = est.insertRV(Point(0, 0), false, "A");
  const auto b = est.insertRV(Point(10, 0), false, "B");
  const auto p = est.insertRV(Point(4, 4), "P");
  est.insertMeasurement(slom::Range(), a, p, slom::measured(5.0), slom::StandardDeviation(0.1));
  est.insertMeasurement(slom::Range(), b, p, slom::measured(8.1), slom::StandardDeviation(0.1));

  slom::Archive archive;
  archive.measurement<slom::Range, slom::VarID<Point>, slom::VarID<Point>, slom::Measured<double>>();
  std::ofstream file("ranges.slom");
  archive.save(est, file);
  file.close();

  std::ifstream again("ranges.slom");
  slom::StoredProblem problem = archive.load(again, "ranges.slom");
  problem.estimator.optimize();
  std::cout << *problem.variable<Point>("P") << "\n";
}
