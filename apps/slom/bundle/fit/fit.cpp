#include "bundle/fit/fit.hpp"

namespace slom::app::bundle {

namespace {

template <class T>
std::vector<VarID<T>> insertAll(Estimator& est, const std::vector<T>& values, const char* kind) {
  std::vector<VarID<T>> ids;
  ids.reserve(values.size());
  for (const T& value : values) ids.push_back(est.insertRV(value, kind + std::to_string(ids.size())));
  return ids;
}

template <class T>
void copyValues(const std::vector<VarID<T>>& ids, std::vector<T>& values) {
  for (std::size_t i = 0; i < ids.size(); ++i) values[i] = *ids[i];
}

// Points recede from cameras along the way, and old scales would hold them back.
constexpr double initial_damping = 1e-4, scale_memory = 0.1;

}  // namespace

BundleFit::BundleFit(const Scene& scene, const FitOptions& options)
    : cameras_(insertAll(est_, scene.cameras, "camera ")), points_(insertAll(est_, scene.points, "point ")) {
  apply(options, est_);
  if (options.algorithm == AlgorithmName::lm)
    est_.changeAlgorithm(LevenbergMarquardt(initial_damping, scale_memory));
  for (const Observation& observation : scene.observations) {
    est_.insertMeasurement(Sight(), cameras_[std::size_t(observation.camera)],
                           points_[std::size_t(observation.point)], measured(observation.pixel), options.loss,
                           named("observation"));
  }
}

void BundleFit::writeTo(Scene& scene) const {
  copyValues(cameras_, scene.cameras);
  copyValues(points_, scene.points);
}

}  // namespace slom::app::bundle
