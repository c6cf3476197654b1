// Uncertainty of the parameters shared by all images (ClusteredUncertainty). Errors may be dependent within images,
// within blocks of successive images, and at points of the board.
#pragma once

#include <memory>
#include <optional>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

class WhitenedScores;

/// Comparisons between the images of a successful result. Other results stay unchanged.
class Clustering {
 public:
  /// Takes data with the noise of the result (withNoiseOf). `data` must be sorted.
  Clustering(const Dataset& data, const Result& result);
  ~Clustering();

  /// Fills Result::gross, which must be empty.
  void addGrossCorners(Result& result) const;
  /// Fills Result::clustered and the clustered standard deviations.
  void addClustered(Result& result) const;

 private:
  std::optional<Dataset> on_board_;  // empty if there is nothing to compare
  std::unique_ptr<const WhitenedScores> scores_;
};

/// Runs Clustering::addGrossCorners and Clustering::addClustered.
void addClustered(const Dataset& data, Result& result);

/// Returns ClusteredUncertainty::covariance as a matrix.
Eigen::MatrixXd covarianceOf(const ClusteredUncertainty& clustered);

}  // namespace slom::calibration
