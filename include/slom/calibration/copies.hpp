// Views that repeat others. A photograph given twice, or rows copied under another number, are no further
// measurement; taken as one, they make all uncertainties too small, and agree with themselves in
// cross-validation.
#pragma once

#include "slom/calibration/dataset.hpp"

namespace slom::calibration {

/// Leaves out the views that repeat an earlier one of their camera, and lists them in CameraData::copies;
/// with them the readings of the IMU of images that no camera has then. The time grows as the number of
/// corners does, but where thousands of frames are of a camera at rest. UserError where two cameras have most
/// of their views in common, and where of a camera's views only one is left.
///
/// A view repeats another one when three quarters of the corners of the smaller one, and four at least, are
/// the same points of the board within 0.005 px of each other. Frames of a camera at rest differ by more: no
/// detector has less noise than 0.02 px.
void leaveOutCopies(Dataset& data);

}  // namespace slom::calibration
