// The data as a fit took them: pixels without the readout that a result states, and corners with the noise that it states.
#pragma once

#include <map>
#include <vector>

#include <slom/slom.hpp>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the data without readout, with the noise of the result. `data` is sorted, as in all functions here.
Dataset asFitted(const Result& result, const Dataset& data);

/// Returns the data as a camera that reads all rows at once would have seen them: pixels moved back by what the corners move until their row is
/// read, value (row / height) motion.
Dataset withoutReadout(const Dataset& data, const Result& result);

/// Returns the data with Corner::sigma times what the result says about it.
Dataset withNoiseOf(const Result& result, const Dataset& data);

// ---- the parts

/// The loss of a setting; none for Robust::none and Robust::reject.
Loss lossOf(Robust robust);

/// Multiplies Corner::sigma by what grows. `on_board`: the data on the board of the result.
void applyGrowth(const Result& result, const Dataset& on_board, Dataset& data);

/// Divides Corner::sigma by the roots of the weights of a loss, and sums these up.
void applyLoss(const Loss& loss, const Result& result, const Dataset& on_board, Dataset& data,
               Downweighted& down);

/// Returns what the noise may grow with, by view of a camera; NaN: unknown.
std::vector<double> quantityOf(SigmaBy by, const Dataset& on_board, const Result& result, std::size_t camera);

/// Returns the motion of the corners of all views of a camera from one image number to the next, by the poses of the images before and after, if these
/// are not much farther away than usual [px]; NaN: unknown. Corners as they were found would bring their noise along, which no pose takes up.
std::vector<std::vector<Eigen::Vector2d>> motionsByPoses(const CameraData& camera, const CameraResult& fitted,
                                                         const Result& result);

/// The pose left2world of each image.
std::map<int, SE3> posesOf(const Result& result);

/// Returns the distances of the corners of a view from where the fit puts them [px].
std::vector<double> distancesOf(const View& view, const CameraResult& camera, const SE3& left2world);

}  // namespace slom::calibration
