// The data as a fit took them: pixels corrected for the readout of a result, and corners with the noise of the
// result.
#pragma once

#include <map>
#include <vector>

#include <slom/slom.hpp>

#include "slom/calibration/dataset.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

/// Returns the data without readout, with the noise of the result. `data` must be sorted, as for all functions here.
Dataset asFitted(const Result& result, const Dataset& data);

/// Returns the data with Corner::by_readout from the poses of the result: (row / height) motion. Corners that are not
/// known to move get 0.
Dataset withMotion(const Result& result, const Dataset& data);
/// Returns whether corners of the camera are known to move: whether Corner::by_readout of some is not 0.
bool moves(const CameraData& camera);

/// Returns the data as a camera that reads all rows at once would have seen them, with Corner::by_readout. Moves each
/// pixel back by the motion of its corner until its row is read.
Dataset withoutReadout(const Dataset& data, const Result& result);

/// Returns the data with Corner::sigma multiplied by the noise factors of the result.
Dataset withNoiseOf(const Result& result, const Dataset& data);

// ---- the parts

/// Returns the loss of a setting; no loss for Robust::none and Robust::reject.
Loss lossOf(Robust robust);

/// Multiplies Corner::sigma by the growth of the noise. `on_board`: the data on the board of the result.
void applyGrowth(const Result& result, const Dataset& on_board, Dataset& data);

/// Divides Corner::sigma by the square root of the loss's weight. Sums up the weights in `down`.
void applyLoss(const Loss& loss, const Result& result, const Dataset& on_board, Dataset& data,
               Downweighted& down);

/// Returns the quantity that the noise may grow with, for each view of a camera; NaN if unknown.
std::vector<double> quantityOf(SigmaBy by, const Dataset& on_board, const Result& result, std::size_t camera);

/// Returns the motion of the corners of all views of a camera from one image number to the next [px]; NaN if unknown.
/// Computes it from the poses of the images before and after, if their numbers are not much farther away than usual.
/// Detected corners would add their noise to the motion, which no pose absorbs.
std::vector<std::vector<Eigen::Vector2d>> motionsByPoses(const CameraData& camera, const CameraResult& fitted,
                                                         const Result& result);

/// Returns the pose left2world of each image.
std::map<int, SE3> posesOf(const Result& result);

/// Returns the distances between the corners of a view and their predictions by the fit [px].
std::vector<double> distancesOf(const View& view, const CameraResult& camera, const SE3& left2world);

}  // namespace slom::calibration
