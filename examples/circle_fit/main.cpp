// Fits a circle to points: the program of the README.
#include <slom/slom.hpp>

#include <iostream>

int main() {
  const std::vector<Eigen::Vector2d> points{{3.9, 1.0}, {3.1, 3.2}, {1.0, 4.1}, {-1.1, 3.0}, {-2.0, 1.1}, {-1.2, -1.1}, {0.9, -2.0}};

  slom::Estimator est;
  auto centre = est.insertRV(Eigen::Vector2d(0, 0), "centre");
  auto radius = est.insertRV(1.0, "radius");
  for (const auto& p : points) {
    est.insertMeasurement([](const auto& c, const auto& r, const auto& point) { return (point - c).norm() - r; },
                          centre, radius, p, slom::StandardDeviation(0.1));
  }
  std::cout << est.optimize();
  std::cout << "diameter " << 2 * *radius << " +- " << 2 * est.standardDeviation(radius)[0] << "\n";
}
