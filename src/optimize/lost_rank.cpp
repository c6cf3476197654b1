#include "optimize/lost_rank.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Largest number of directions along which steps are tried: each may need several hundred evaluations.
constexpr Index kMostTried = 6;
/// Fraction of a direction's largest entry below which an entry does not count as moving.
constexpr double kMovesAlong = 1e-5;
/// Smallest decrease, relative to the RSS, for which a step along a free direction is taken.
constexpr double kLeastGain = 1e-9;

/// Change of the RSS, relative to the RSS, up to which the RSS counts as unchanged.
constexpr double kSameRss = 1e-6;
/// Length of the step that shows whether the RSS rises.
constexpr double kRisingStep = 0.1;
/// Lengths of steps, of moves that leave the RSS unchanged, and of steps from there. A length is the largest change of
/// a component, relative to its size.
constexpr double kEscapeSteps[] = {10, 3, 1, 0.3, 0.1, 0.03, 0.01, 1e-3};
constexpr double kFlatSteps[] = {0.25, 0.5, 0.75, 1.02, 1.1, 1.25, 1.5, 2, 3, 5, 10, 30, 100, 1e3, 1e4};
constexpr double kSplitSteps[] = {0.3, 0.1, 0.03, 0.01};

}  // namespace

MatrixXd asSteps(Evaluator& evaluator, const MatrixXd& basis) {
  const VectorXd sizes =
      evaluator.typicalSizes().unaryExpr([](double size) { return size > 0 ? size : 1.0; });
  MatrixXd steps = basis.leftCols(std::min(basis.cols(), kMostTried));
  for (Index k = 0; k < steps.cols(); ++k)
    steps.col(k) /= steps.col(k).cwiseQuotient(sizes).cwiseAbs().maxCoeff();
  return steps;
}

LostRank::LostRank(Evaluator& evaluator, const std::function<FreeDirections()>& find_free)
    : evaluator_(evaluator), find_free_(find_free) {
  if (find_free && evaluator.structure().system.unknowns() <= Summary::kMostCounted)
    start_.emplace(evaluator.problem());
}

bool LostRank::isInDoubt(StopReason reason) {
  if (!start_ || evaluator_.mustStop()) return false;
  if (reason == StopReason::no_progress) return true;
  return isConverged(reason) && reason != StopReason::nothing_to_do && !evaluator_.hadFullRank();
}

FreeDirections LostRank::find() {
  FreeDirections found = find_free_();
  evaluator_.linearize();
  const Index n = evaluator_.structure().system.unknowns(), known = found.basis.cols();
  std::vector<int> unseen = evaluator_.unseenAtRest();
  std::erase_if(unseen, [&](int i) { return known > 0 && found.basis.row(i).cwiseAbs().maxCoeff() > 0; });
  MatrixXd all = MatrixXd::Zero(n, known + static_cast<Index>(unseen.size()));
  if (known > 0) all.leftCols(known) = found.basis;
  for (std::size_t k = 0; k < unseen.size(); ++k) all(unseen[k], known + static_cast<Index>(k)) = 1;
  found.count += static_cast<int>(unseen.size());
  found.basis = std::move(all);
  return found;
}

int LostRank::atStart() {
  if (!at_start_) {
    ValueSnapshot end(evaluator_.problem());
    start_->restore();
    const FreeDirections found = find();
    at_start_ = found.count - found.gauge;
    end.restore();
  }
  return *at_start_;
}

bool LostRank::examine() {
  unknowns_.clear();
  const FreeDirections found = find();
  if (found.count - found.gauge <= 0 || found.count - found.gauge <= atStart()) return false;
  steps_ = asSteps(evaluator_, found.basis);
  for (Index i = 0; i < found.basis.rows(); ++i) {
    const VectorXd moves = found.basis.row(i).cwiseAbs();
    const VectorXd largest = found.basis.cwiseAbs().colwise().maxCoeff();
    if ((moves.array() > kMovesAlong * largest.array()).any()) unknowns_.push_back(static_cast<int>(i));
  }
  return true;
}

/// Tries steps along these directions from the current values. Keeps in `best_` the values with an RSS below `least_`.
void LostRank::tryAlong(const MatrixXd& steps, std::span<const double> lengths) {
  for (Index k = 0; k < steps.cols() && !evaluator_.mustStop(); ++k) {
    for (const double length : lengths) {
      for (const double sign : {1.0, -1.0}) {
        const double rss = evaluator_.tryStep(sign * length * steps.col(k));
        if (rss < least_ && evaluator_.hasFiniteDerivatives()) {
          least_ = rss;
          best_ = std::make_unique<ValueSnapshot>(evaluator_.problem());
        }
        evaluator_.undo();
      }
    }
  }
}

/// Moves along each direction as far as the RSS is unchanged, and tries steps along the directions that are free there.
void LostRank::tryFromFlatMoves(double rss) {
  ValueSnapshot here(evaluator_.problem());
  for (Index k = 0; k < steps_.cols(); ++k) {
    for (const double length : kFlatSteps) {
      for (const double sign : {1.0, -1.0}) {
        if (evaluator_.mustStop()) return;
        const double moved = evaluator_.tryStep(sign * length * steps_.col(k));
        if (std::abs(moved - rss) <= kSameRss * rss && evaluator_.hasFiniteDerivatives())
          tryAlong(asSteps(evaluator_, find().basis), kSplitSteps);
        here.restore();
      }
    }
  }
}

/// Returns whether the RSS rises along each direction, both ways. Then second-order curvature makes the point a minimum
/// although J has no full rank, for example if two equal rates fit best.
bool LostRank::isMinimum() {
  const double rss = evaluator_.linearize();
  bool rises = true;
  for (Index k = 0; k < steps_.cols() && rises; ++k) {
    for (const double step : {kRisingStep, -kRisingStep}) {
      rises = rises && evaluator_.tryStep(step * steps_.col(k)) > rss + kSameRss * rss;
      evaluator_.undo();
    }
  }
  evaluator_.linearize();
  return rises;
}

bool LostRank::escape() {
  const double rss = evaluator_.linearize();
  least_ = rss - kLeastGain * rss;
  best_.reset();
  tryAlong(steps_, kEscapeSteps);
  if (best_ == nullptr) tryFromFlatMoves(rss);
  if (best_ == nullptr) return false;
  best_->restore();
  return true;
}

}  // namespace slom
