// Fits a circle to points of a known circle and checks the result: the consumer's program for the estimator.

#include <cmath>
#include <cstdio>

#include <slom/slom.hpp>

using vec2 = mtk::vect<2>;
using Circle = mtk::vect<3>;  // centre and radius

SLOM_BUILD_MEASUREMENT(OnCircle, 1, ((Circle, circle)), ((vec2, point)))
SLOM_IMPLEMENT_MEASUREMENT(OnCircle, ret) { ret << (point - circle->head<2>()).norm() - (*circle)[2]; }

int main() {
  const Circle truth(3.0, -2.0, 5.0);
  slom::Estimator est;
  const slom::VarID<Circle> circle = est.insertRV(Circle(0.0, 0.0, 1.0), "circle");
  for (int i = 0; i < 20; ++i) {
    const vec2 point(truth[0] + truth[2] * std::cos(0.1 * i), truth[1] + truth[2] * std::sin(0.1 * i));
    est.insertMeasurement(OnCircle(circle, point), slom::StandardDeviation(0.1));
  }
  const slom::Summary summary = est.optimize();
  const double error = (*circle - truth).norm();
  std::printf("converged %d, circle (%g, %g), radius %g\n", summary.converged, (*circle)[0], (*circle)[1],
              (*circle)[2]);
  return summary.converged && error < 1e-9 ? 0 : 1;
}
