/// The rank at the end of a fit. A saddle or a plateau also has a small gradient, but directions are free there that
/// the measurements determined at the start.
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

/// Returns the first of these directions as steps. The largest change of a component, relative to its size, is 1.
Eigen::MatrixXd asSteps(Evaluator& evaluator, const Eigen::MatrixXd& basis);

class LostRank {
 public:
  /// Takes the current values as the start of the fit.
  LostRank(Evaluator& evaluator, const std::function<FreeDirections()>& find_free);

  /// Returns whether the rank is unknown after a fit that stopped for this reason.
  bool isInDoubt(StopReason reason);
  /// Examines the current values. Returns whether more directions are free than at the start, not counting the gauge.
  bool examine();
  /// Returns the unknowns that move along the directions found by examine().
  const std::vector<int>& unknowns() const { return unknowns_; }
  /// Tries steps along these directions, both ways. Then tries steps from points along them, because the curvature
  /// along one direction may change sign along another. Takes the step with the smallest RSS if that is below the
  /// present one. Returns whether it took one.
  ///   source   Conn, Gould and Toint, "Trust-region methods", 2000, section 6.6 (directions of negative curvature)
  bool escape();
  /// Returns whether the RSS rises along these directions: a minimum at which J has no full rank.
  bool isMinimum();

 private:
  FreeDirections find();
  int atStart();
  void tryAlong(const Eigen::MatrixXd& steps, std::span<const double> lengths);
  void tryFromFlatMoves(double rss);

  Evaluator& evaluator_;
  std::function<FreeDirections()> find_free_;
  std::optional<ValueSnapshot> start_;  // none: too many unknowns, or no way to find free directions
  std::optional<int> at_start_;         // number of free directions, not counting the gauge
  Eigen::MatrixXd steps_;
  std::vector<int> unknowns_;
  std::unique_ptr<ValueSnapshot> best_;  // values with the smallest RSS after a step
  double least_ = 0;
};

}  // namespace slom
