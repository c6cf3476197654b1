// The result as text for people.
#pragma once

#include <string>

#include "calibrate/settings.hpp"

namespace slom::app::calib {

/// Returns a summary of the data: cameras, images, corners, readings.
std::string dataText(const Dataset& data);

/// Returns the header before the fits of single cameras.
std::string aloneHeader(const CommandSettings& settings);

/// Returns one line about a camera's own fit.
std::string singleCameraText(const SingleCameraReport& alone);

/// Returns `  name        value +- std        +- clustered  unit`, without the second column if there is none.
std::string valueLine(const std::string& name, double value, double std, double clustered,
                      const std::string& unit);
/// Returns such lines of three components.
std::string vectorLines(const std::string& name, const vec3& value, const vec3& std, const vec3& clustered,
                        const std::string& unit);
/// Returns the lines of a rotation: its rotation vector with standard deviations [rad].
std::string rotationLines(const SO3& R, const vec3& std, const vec3& clustered);

/// Returns the lines of a verdict: level, sentence, and the doubts that the sentence lacks.
std::string verdictText(const char* heading, const Verdict& verdict);

/// Returns the whole report.
std::string reportText(const Result& result, const char* heading_of_verdict = "verdict");

}  // namespace slom::app::calib
