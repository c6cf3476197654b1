/// Common parts of the fits by Ceres.
#pragma once

#include <memory>
#include <vector>

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/types.h>

#include "fit/run.hpp"

namespace slom::bench {

class CeresProblem {
 public:
  /// Makes the problem. huber: Limits::huber.
  explicit CeresProblem(double huber) {
    if (huber > 0) loss_ = std::make_unique<ceres::HuberLoss>(huber);
  }
  virtual ~CeresProblem() = default;

  ceres::Problem problem{sharedParts()};
  std::vector<double*> eliminated_first;           ///< none: Ceres finds an order
  std::vector<std::vector<const double*>> blocks;  ///< parameter blocks of each pose or camera

 protected:
  ceres::LossFunction* loss() const { return loss_.get(); }

 private:
  static ceres::Problem::Options sharedParts() {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    return options;
  }
  std::unique_ptr<ceres::LossFunction> loss_;
};

template <class Pose>
std::unique_ptr<CeresProblem> ceresProblemOf(const io::PoseGraph<Pose>& graph, double huber);
std::unique_ptr<CeresProblem> ceresProblemOf(const io::Scene& scene, double huber);

/// Fits by Levenberg-Marquardt.
Run solveByCeres(CeresProblem& problem, ceres::LinearSolverType solver, const Limits& limits);

}  // namespace slom::bench
