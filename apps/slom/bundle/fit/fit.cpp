#include "bundle/fit/fit.hpp"

namespace slom::app::bundle {

namespace {

// Points recede from cameras during the fit. Scales of earlier linearisations would make steps of points too short.
constexpr double initial_damping = 1e-4, scale_memory = 0.1;

}  // namespace

void prepare(const FitOptions& options, Estimator& est) {
  apply(options, est);
  if (options.algorithm.name == kAlgorithm)
    est.changeAlgorithm(LevenbergMarquardt(initial_damping, scale_memory));
}

BundleFit::BundleFit(const Scene& scene, const FitOptions& options) {
  prepare(options, est_);
  variables_ = io::insert(est_, scene, options.loss);
}

}  // namespace slom::app::bundle
