// The shape of the board as variables of an estimator.
#pragma once

#include <vector>

#include <slom/slom.hpp>

#include "calibration/data/board_basis.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Each block of unknowns is a variable with a prior at 0. The prior holds the board as a whole where it is stated, in the sense of least squares: what
/// moves, turns or scales all corners is otherwise open.
class BoardUnknowns {
 public:
  /// From the displacements that an earlier fit found, where there is one. Both arguments must live as long as this.
  BoardUnknowns(Estimator& estimator, const Dataset& data, const Settings& settings,
                const FittedBoard* start);
  BoardUnknowns(const BoardUnknowns&) = delete;
  BoardUnknowns& operator=(const BoardUnknowns&) = delete;

  const BoardBasis& basis() const { return basis_; }
  /// The variable that displaces a corner.
  const VarID<vec3>& of(const Corner& corner) const {
    return blocks_[std::size_t(basis_.block(basis_.find(corner.world)))];
  }
  /// Where it is now [m].
  vec3 worldOf(const Corner& corner) const;

  /// Optimises; then, unless the standard deviation of a free board is given, once more with the one that the displacements show: with few images,
  /// corners follow the noise by no more than the board is wrong.
  Summary optimize(const Options& options);
  /// As it is fitted now, without standard deviations.
  FittedBoard board() const;
  /// Fills in those of its corners. Throws as Estimator::marginals.
  void addStandardDeviations(FittedBoard& board) const;

 private:
  vec3 displacement(int point) const;
  void setSigma(double sigma);
  double rmsDisplacement() const;

  Estimator* est_;
  BoardBasis basis_;
  bool sigma_is_given_;
  double sigma_ = 0;
  std::vector<VarID<vec3>> blocks_;
  using PriorID = decltype(std::declval<Estimator&>().prior(std::declval<const VarID<vec3>&>(), vec3(), 1.0));
  std::vector<PriorID> priors_;
};

}  // namespace slom::calibration
