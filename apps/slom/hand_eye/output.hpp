// The report of a hand-eye calibration, and its JSON.
#pragma once

#include <string>

#include <slom/calibration/hand_eye.hpp>

namespace slom::app::hand_eye {

/// What was given.
struct Streams {
  calibration::PoseStream hand, camera;
  calibration::HandEyeSettings settings;
};

/// Returns the lines on what was read.
std::string streamsText(const Streams& streams);
/// Returns the lines on values, residuals and warnings.
std::string resultText(const Streams& streams, const calibration::HandEyeResult& result);
/// Returns why a calibration failed, in a sentence.
std::string failureText(const Streams& streams, const calibration::HandEyeResult& result);
/// Returns the JSON with the keys of docs/hand_eye_results.md.
std::string toJson(const Streams& streams, const calibration::HandEyeResult& result);

}  // namespace slom::app::hand_eye
