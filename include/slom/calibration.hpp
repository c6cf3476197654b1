/// Calibration of cameras, and of an IMU on their rig, from corners of a flat board: data in memory -> start values -> fit ->
/// result with uncertainty, quality and verdict. docs/calibration_library.md shows it at work. Library slom::calibration.
///   dataset.hpp     what was measured
///   options.hpp     what is assumed and fixed, and when to give up; models.hpp: the camera models
///   calibrate.hpp   the fit: calibrate(data, settings)
///   result.hpp      what it found, with standard deviations
///   assess.hpp      how far it can be trusted, assess(data, settings, result), in figures (quality.hpp) and in a sentence
///   patterns.hpp    what residuals have in common, and why
///   pixel_uncertainty.hpp  how sure it is where a point is projected to, asked pixel by pixel
///   board_shape.hpp  a board that is not flat, found with the rest
///   corner_noise.hpp  corners that are less precise than others
///   readout.hpp     rolling shutters
///   comparison.hpp  which camera model the data carry
///   files.hpp       corners and readings from and to files
///   error.hpp       what is thrown for data and settings that make no sense
#pragma once

#include "slom/calibration/assess.hpp"
#include "slom/calibration/board.hpp"
#include "slom/calibration/board_shape.hpp"
#include "slom/calibration/calibrate.hpp"
#include "slom/calibration/comparison.hpp"
#include "slom/calibration/corner_noise.hpp"
#include "slom/calibration/dataset.hpp"
#include "slom/calibration/error.hpp"
#include "slom/calibration/files.hpp"
#include "slom/calibration/models.hpp"
#include "slom/calibration/number_text.hpp"
#include "slom/calibration/options.hpp"
#include "slom/calibration/patterns.hpp"
#include "slom/calibration/pixel_uncertainty.hpp"
#include "slom/calibration/quality.hpp"
#include "slom/calibration/readout.hpp"
#include "slom/calibration/result.hpp"
