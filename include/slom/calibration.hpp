/// Calibration of cameras, and of an IMU on their rig, from corners of a flat board. Data in memory give start values,
/// a fit, and a result with uncertainty, quality and verdict. docs/calibration_library.md shows an example. Link
/// slom::calibration.
///   dataset.hpp            the measured data
///   options.hpp            what is assumed and fixed, and when to give up
///   models.hpp             the camera models
///   calibrate.hpp          the fit: calibrate(data, settings)
///   result.hpp             the result with standard deviations
///   assess.hpp             assess(data, settings, result): trust in the result, in figures (quality.hpp) and words
///   patterns.hpp           patterns in the residuals and their causes
///   pixel_uncertainty.hpp  the uncertainty of a projected point, for each pixel
///   board_shape.hpp        a board that is not flat, estimated in the fit
///   corner_noise.hpp       corners that are less precise than others
///   readout.hpp            rolling shutters
///   comparison.hpp         which camera model the data support
///   choose.hpp             a calibration that leaves settings to comparisons
///   files.hpp              corners and readings from and to files
///   hand_eye.hpp           a camera on a hand, from two streams of poses: handEye(hand, camera, settings)
///   imu_stream.hpp         cameras and IMUs in motion
///   moving_cameras.hpp     cameras with clocks of their own or rolling shutters, and IMUs
///   stream_agreement.hpp   how far two fits of them agree
///   stream_verdict.hpp     whether the fit of IMUs in motion can be trusted
///   error.hpp              exceptions for invalid data and settings
#pragma once

#include "slom/calibration/assess.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/choose.hpp"
#include "slom/calibration/comparison.hpp"
#include "slom/calibration/corner_noise.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/files.hpp"
#include "slom/calibration/hand_eye.hpp"
#include "slom/calibration/imu_stream.hpp"
#include "slom/calibration/models.hpp"
#include "slom/calibration/moving_cameras.hpp"
#include "slom/calibration/number_text.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/patterns.hpp"
#include "slom/calibration/pixel_uncertainty.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/readout.hpp"
#include "slom/calibration/result.hpp"
#include "slom/calibration/stream_agreement.hpp"
#include "slom/calibration/stream_verdict.hpp"
