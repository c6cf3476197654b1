// All standard deviations that a result states, in one list: what changes some of them changes all.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// A number of a result whose standard deviations are stated.
struct StatedUncertainty {
  double* stated = nullptr;
  double* clustered = nullptr;
  Eigen::RowVectorXd by_shared;  ///< how the number follows the shared parameters
};

/// Of lenses, camera to camera (translation, rotation, rotation vector) and the IMU. `result` must live as long; ClusteredUncertainty::covariance
/// and ImuResult::precision follow from these and are not in the list.
std::vector<StatedUncertainty> uncertaintiesOf(Result& result, const SharedColumns& columns);

/// Adds to all standard deviations, to the covariance they come from and to what is summed up of them, an error that is independent of the others:
/// the shared parameters follow it by `followed`, and its standard deviations are these.
void addIndependentError(const Eigen::VectorXd& followed, double std, double std_clustered,
                         const SharedColumns& columns, Result& result);

}  // namespace slom::calibration
