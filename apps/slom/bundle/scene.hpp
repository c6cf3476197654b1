// Cameras and points as they stand in a BAL file.
#pragma once

#include <string>
#include <vector>

#include "bundle/camera.hpp"

namespace slom::app::bundle {

/// Point number `point` as camera number `camera` sees it; both count from 0.
struct Observation {
  int camera = 0;
  int point = 0;
  int line = 0;  ///< of the file
  mtk::vect<2> pixel;
};

struct Scene {
  std::string file;
  std::vector<Camera> cameras;
  std::vector<mtk::vect<3>> points;
  std::vector<Observation> observations;

  /// Prediction - observation [px].
  mtk::vect<2> residual(const Observation& observation) const;
  /// Of all residuals, no loss, no 1/2 [px^2].
  double sumOfSquares() const;
  /// sqrt(sum of squares / observations): the root mean square of the distance to the observed pixel [px].
  double rms() const;
};

}  // namespace slom::app::bundle
