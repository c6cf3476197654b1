/// What the fits by Ceres have in common.
#pragma once

#include <memory>

#include <ceres/problem.h>
#include <ceres/types.h>

#include "fit/run.hpp"

namespace slom::bench {

inline ceres::Problem::Options keepingManifolds() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

struct CeresProblem {
  virtual ~CeresProblem() = default;
  ceres::Problem problem{keepingManifolds()};
};

template <class Pose>
std::unique_ptr<CeresProblem> ceresProblemOf(const app::graph::PoseGraph<Pose>& graph);

/// Levenberg-Marquardt. Stops when nothing can be gained, so that a trace shows when each cost is reached.
Run solveByCeres(CeresProblem& problem, ceres::LinearSolverType solver, const Limits& limits);

}  // namespace slom::bench
