// Uncertainty of the parameters that all images share, where errors are dependent within images, within blocks of images that follow each
// other, and at points of the board (ClusteredUncertainty).
#pragma once

#include <memory>
#include <optional>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

class WhitenedScores;

/// What the images of a result that succeeded say beside each other. Results that did not succeed stay as they are.
class Clustering {
 public:
  /// `data` is sorted and has the noise of the result (withNoiseOf).
  Clustering(const Dataset& data, const Result& result);
  ~Clustering();

  /// Fills Result::gross, which is empty.
  void addGrossCorners(Result& result) const;
  /// Fills Result::clustered and the clustered standard deviations.
  void addClustered(Result& result) const;

 private:
  std::optional<Dataset> on_board_;  // nothing where there is nothing to say
  std::unique_ptr<const WhitenedScores> scores_;
};

/// Both.
void addClustered(const Dataset& data, Result& result);

/// The matrix of ClusteredUncertainty::covariance.
Eigen::MatrixXd covarianceOf(const ClusteredUncertainty& clustered);

}  // namespace slom::calibration
