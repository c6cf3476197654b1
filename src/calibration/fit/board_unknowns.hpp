// The shape of the board as variables of an estimator.
#pragma once

#include <vector>

#include <slom/slom.hpp>

#include "calibration/data/board_basis.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// The shape of the board: each block of unknowns is a variable with a prior at 0. In the sense of least squares, the
/// prior keeps the board as a whole at its stated place and size. Without the prior, moving, turning or scaling all
/// corners would be undetermined.
class BoardUnknowns {
 public:
  /// Starts from the displacements of an earlier fit, if there is one. Both arguments must outlive this object.
  BoardUnknowns(Estimator& estimator, const Dataset& data, const Settings& settings,
                const FittedBoard* start);
  BoardUnknowns(const BoardUnknowns&) = delete;
  BoardUnknowns& operator=(const BoardUnknowns&) = delete;

  const BoardBasis& basis() const { return basis_; }
  /// Returns the variable that displaces a corner.
  const VarID<vec3>& of(const Corner& corner) const {
    return blocks_[std::size_t(basis_.block(basis_.find(corner.world)))];
  }
  /// Returns the current position of a corner [m].
  vec3 worldOf(const Corner& corner) const;

  /// Optimizes. If the board is free and its standard deviation is not given, optimizes once more with the standard
  /// deviation that the displacements show. So with few images, corners follow the noise by no more than the board is
  /// wrong.
  Summary optimize(const Options& options);
  /// Returns the current board, without standard deviations.
  FittedBoard board() const;
  /// Fills in the standard deviations of the corners. Throws as Estimator::marginals does.
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
