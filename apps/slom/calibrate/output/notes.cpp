#include "calibrate/output/notes.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "calibrate/output/format.hpp"

namespace slom::app::calib {
namespace {

constexpr double sigma_mismatch = 1.25;   // residuals larger or smaller than stated by this factor are worth a note
constexpr double together_mismatch = 1.2; // RMS together over RMS alone
constexpr double weak_ratio = 3;          // std over what it would be if the other were fixed
constexpr double weak_gravity = 0.1;      // m/s^2

void noteDetermination(const Result& result, std::vector<std::string>& notes) {
  if (result.undetermined.empty()) return;
  notes.push_back(fmt::format("The images do not determine all parameters, so there are no standard deviations, and the "
                              "values must not be used: {}. Add images from other directions and distances, or choose "
                              "a model with fewer parameters by --intrinsics.", result.undetermined));
}

/// Root mean square of the residuals of one component, corrected for the unknowns they were fitted with.
double observedSigma(double rms_per_component, const Result& result) {
  return rms_per_component * std::sqrt(double(result.measurements) / std::max(1, result.redundancy));
}

void noteSigma(const char* what, const char* option, double stated, double observed, const char* unit,
               std::vector<std::string>& notes) {
  if (!(observed > 0) || std::abs(std::log(observed / stated)) < std::log(sigma_mismatch)) return;
  const bool larger = observed > stated;
  const double factor = larger ? observed / stated : stated / observed;
  notes.push_back(fmt::format("The residuals of {} are {:.1f} times {} than {} {:g} says. If that is their noise and not a "
                              "flaw of the model, pass {} {} {}; all standard deviations here are those of the stated "
                              "sigma [{}].",
                              what, factor, larger ? "larger" : "smaller", option, stated, option, twoDigits(observed),
                              larger ? "and look at the worst images" : "to get the smaller standard deviations", unit));
}

void noteSigmas(const Result& result, std::vector<std::string>& notes) {
  double square = 0, corners = 0;
  for (const CameraResult& camera : result.cameras) {
    square += camera.rms_px * camera.rms_px * double(camera.corners);
    corners += double(camera.corners);
  }
  noteSigma("the corners", "--sigma-px", result.sigma_px, observedSigma(std::sqrt(square / corners / 2), result), "px",
            notes);
  if (!result.imu) return;
  noteSigma("the IMU", "--sigma-acc", result.sigma_acc, observedSigma(result.imu->rms_acc / std::sqrt(3.0), result),
            "m/s^2", notes);
}

void noteTogether(const Result& result, std::vector<std::string>& notes) {
  for (const CameraResult& camera : result.cameras) {
    if (!(camera.rms_px > together_mismatch * camera.rms_px_alone)) continue;
    notes.push_back(fmt::format("Camera {} fits its images to {:.3f} px alone, but to {:.3f} px together with the rest: "
                                "look for images that were not taken at the same time, image numbers that do not belong "
                                "together, or a part that moved.",
                                camera.name, camera.rms_px_alone, camera.rms_px));
  }
}

void noteGravity(const Result& result, std::vector<std::string>& notes) {
  if (!result.imu) return;
  const ImuResult& imu = *result.imu;
  if (imu.sign_evidence < 9) {
    notes.push_back("The sign of gravity is open: the images are tilted about one axis only, and the other sign (with "
                    "the IMU turned half round) fits as well. Add images tilted about another axis.");
  }
  if (imu.acc_bias_is_fixed || imu.gravity_is_fixed || !std::isfinite(imu.gravity_std)) return;
  const double ratio = imu.gravity_std / imu.gravity_std_if_bias_fixed;
  const bool weak = ratio > weak_ratio || imu.gravity_std > weak_gravity;
  const vec3& bias = imu.acc_bias_std;
  const vec3& better = imu.acc_bias_std_if_gravity_fixed;
  notes.push_back(fmt::format(
      "acc_bias and gravity are {} determined: the tilts of the images spread by {:.1f} deg, which leaves gravity known "
      "to {} and acc_bias to ({}, {}, {}) m/s^2. With the local gravity given (--fix gravity=9.81) acc_bias would be "
      "known to ({}, {}, {}); with the bias given (--fix acc_bias=X,Y,Z) gravity would be known to {}.",
      weak ? "weakly" : "well", imu.tilt_spread * 180 / std::numbers::pi, twoDigits(imu.gravity_std),
      twoDigits(bias[0]), twoDigits(bias[1]), twoDigits(bias[2]), twoDigits(better[0]), twoDigits(better[1]),
      twoDigits(better[2]), twoDigits(imu.gravity_std_if_bias_fixed)));
}

}  // namespace

std::vector<std::string> notes(const Result& result) {
  std::vector<std::string> notes;
  noteDetermination(result, notes);
  noteSigmas(result, notes);
  noteTogether(result, notes);
  noteGravity(result, notes);
  return notes;
}

}  // namespace slom::app::calib
