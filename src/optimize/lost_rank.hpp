/// The rank at the end of a fit: a saddle or a plateau has a small gradient too, but leaves directions free that the measurements
/// determined at the start.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "problem/value_snapshot.hpp"
#include "slom/optimize/evaluator.hpp"
#include "slom/optimize/optimizer.hpp"

namespace slom {

/// Returns the first of these directions as steps: the largest change of a component, relative to its size, is 1.
Eigen::MatrixXd asSteps(Evaluator& evaluator, const Eigen::MatrixXd& basis);

class LostRank {
 public:
  /// The current values are the start of the fit.
  LostRank(Evaluator& evaluator, const std::function<FreeDirections()>& find_free);

  /// Returns whether the rank is unknown after a fit that stopped for this reason.
  bool isInDoubt(StopReason reason);
  /// Examines the current values: whether more directions are free than at the start, not counting the gauge.
  bool examine();
  /// Unknowns that move along the directions that `examine` has found.
  const std::vector<int>& unknowns() const { return unknowns_; }
  /// Tries steps along these directions, both ways, and then from points along them, as the curvature along one may change sign along
  /// another. Takes the step with the smallest RSS, if that is below the present one; returns whether there is one.
  ///   source   Conn, Gould and Toint, "Trust-region methods", 2000, section 6.6 (directions of negative curvature)
  bool escape();
  /// Whether the RSS rises along these directions: a minimum whose J has not full rank.
  bool isMinimum();

 private:
  FreeDirections find();
  int atStart();
  void tryAlong(const Eigen::MatrixXd& steps, std::span<const double> lengths);
  void tryFromFlatMoves(double rss);

  Evaluator& evaluator_;
  std::function<FreeDirections()> find_free_;
  std::optional<ValueSnapshot> start_;  // none: too many unknowns, or nobody can ask
  std::optional<int> at_start_;         // free directions that are no gauge
  Eigen::MatrixXd steps_;
  std::vector<int> unknowns_;
  std::unique_ptr<ValueSnapshot> best_;  // the smallest RSS that a step has led to
  double least_ = 0;
};

}  // namespace slom
