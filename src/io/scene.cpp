#include "slom/io/scene.hpp"

#include <cmath>

namespace slom::io {

mtk::vect<2> Scene::residual(const Observation& observation) const {
  const Camera& camera = cameras[std::size_t(observation.camera)];
  return CameraProjection()(camera, points[std::size_t(observation.point)]) - observation.pixel;
}

double Scene::sumOfSquares() const {
  double sum = 0;
  for (const Observation& observation : observations) sum += residual(observation).squaredNorm();
  return sum;
}

double Scene::rms() const { return std::sqrt(sumOfSquares() / double(observations.size())); }

}  // namespace slom::io
