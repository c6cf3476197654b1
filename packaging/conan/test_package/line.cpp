// Fits a line to three points on it.
#include <cmath>
#include <utility>

#include <slom/slom.hpp>

int main() {
  slom::Estimator est;
  const auto offset = est.insertRV(0.0, "offset"), slope = est.insertRV(0.0, "slope");
  for (const auto& [x, y] : {std::pair{0.0, 1.0}, {1.0, 3.0}, {2.0, 5.0}}) {
    est.insertMeasurement([x = x](const auto& a, const auto& b, const auto& y) { return a + b * x - y; }, offset, slope, y,
                          slom::StandardDeviation(0.1));
  }
  est.optimize();
  return std::abs(*offset - 1) < 1e-9 && std::abs(*slope - 2) < 1e-9 ? 0 : 1;
}
