// Moves a pose by [+] and recovers the step by [-]: the consumer's program for the toolkit.

#include <cmath>
#include <cstdio>
#include <numbers>

#include <mtk/mtk.hpp>

using SE3 = mtk::trafo<mtk::SO3<>>;

int main() {
  // A quarter turn about z takes x to y.
  const SE3 pose(mtk::SO3<>::exp(mtk::vect<3>(0.0, 0.0, std::numbers::pi / 2)), mtk::vect<3>(1.0, 2.0, 3.0));
  const mtk::vect<3> moved = pose * mtk::vect<3>(1.0, 0.0, 0.0);
  const double point_error = (moved - mtk::vect<3>(1.0, 3.0, 3.0)).norm();

  mtk::vect<6> step, recovered;
  step << 0.1, -0.2, 0.3, 0.04, 0.05, -0.06;
  SE3 next = pose;
  next.boxplus(step);
  next.boxminus(recovered, pose);
  const double step_error = (recovered - step).norm();

  std::printf("point error %g, step error %g\n", point_error, step_error);
  return point_error < 1e-14 && step_error < 1e-14 ? 0 : 1;
}
