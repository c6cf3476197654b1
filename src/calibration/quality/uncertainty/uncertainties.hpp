// All standard deviations of a result in one list, so that a change applies to all of them.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "calibration/quality/uncertainty/information.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// A number of a result with standard deviations.
struct StatedUncertainty {
  double* stated = nullptr;
  double* clustered = nullptr;
  Eigen::RowVectorXd by_shared;  ///< derivative of the number by the shared parameters
};

/// Returns the numbers of lenses, camera to camera (translation, rotation, rotation vector) and the IMU. `result`
/// must outlive the list. ClusteredUncertainty::covariance and ImuResult::precision follow from these numbers and are
/// not in the list.
std::vector<StatedUncertainty> uncertaintiesOf(Result& result, const SharedColumns& columns);

/// Adds an independent error to all standard deviations, to the covariance they come from and to their summaries.
/// `followed` is the derivative of the shared parameters by the error, `std` and `std_clustered` are its standard
/// deviations.
void addIndependentError(const Eigen::VectorXd& followed, double std, double std_clustered,
                         const SharedColumns& columns, Result& result);

}  // namespace slom::calibration
