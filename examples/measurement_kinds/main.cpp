// The kinds of measurements in the library. A robot drives along two sides of a square and sees a beacon. Units: metre,
// radian.
#include <cstdio>

#include <slom/measurements.hpp>
#include <slom/slom.hpp>

int main() {
  using Pose = mtk::trafo<mtk::SO2<>>;  // moves points of the robot's frame to the world's
  const Pose forward(mtk::vect<2>(2, 0)), forward_and_left(mtk::SO2<>(1.5708), mtk::vect<2>(2, 0));

  slom::Estimator est;
  auto a = est.insertRV(Pose(), "a");
  auto b = est.insertRV(Pose(), "b");
  auto c = est.insertRV(Pose(), "c");
  auto beacon = est.insertRV(mtk::vect<2>(1, 1), "beacon");

  est.insertMeasurement(slom::Prior(), a, slom::measured(Pose()), slom::StandardDeviation(0.001));
  est.insertMeasurement(slom::RelativePose(), a, b, slom::measured(forward_and_left),
                        slom::StandardDeviation(0.05));
  est.insertMeasurement(slom::RelativePose(), b, c, slom::measured(forward), slom::StandardDeviation(0.05));
  est.insertMeasurement(slom::Bearing(), a, beacon, slom::measured(mtk::SO2<>(0.79)),
                        slom::StandardDeviation(0.01));
  est.insertMeasurement(slom::Bearing(), b, beacon, slom::measured(mtk::SO2<>(0.78)),
                        slom::StandardDeviation(0.01));
  est.insertMeasurement(slom::Range(), a, beacon, slom::measured(1.42), slom::StandardDeviation(0.02));
  est.insertMeasurement(slom::Range(), c, beacon, slom::measured(1.40), slom::StandardDeviation(0.02));

  const slom::Summary summary = est.optimize();
  const auto sigma = est.standardDeviation(beacon);
  std::printf("%s\n", summary.converged ? "converged" : summary.message.c_str());
  std::printf("beacon at (%.2f, %.2f) +- (%.2f, %.2f)\n", beacon->x(), beacon->y(), sigma[0], sigma[1]);
  std::printf("c at (%.2f, %.2f), heading %.2f\n", c->pos.x(), c->pos.y(), c->orient.angle());
}
