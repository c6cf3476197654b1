#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "slom/calibration/assess.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

constexpr double least_on_earth = 9.78, most_on_earth = 9.84;  // [m/s^2]
constexpr double other_unit =
    0.5;                          // off the Earth's gravity [m/s^2]; no sensor's scale error explains as much
constexpr double weak_ratio = 3;  // std over the std with the other parameter fixed
constexpr double weak_gravity = 0.1;    // [m/s^2]
constexpr double weak_rotation = 0.02;  // [rad]
constexpr double misfit = 5;            // RMS of the readings over sigma_acc

double offEarth(const ImuResult& imu) {
  return std::max(least_on_earth - std::abs(imu.gravity), std::abs(imu.gravity) - most_on_earth);
}

/// A unit for accelerations.
struct AccelerationUnit {
  const char* name;
  double metres_per_second2;
};

/// Names the units in which this gravity would be that of the Earth, to 5 %, and says what to do. Empty if there is
/// no such unit.
std::string remedyOfUnit(double gravity) {
  constexpr AccelerationUnit units[] = {
      {"g", 9.80665}, {"mg", 9.80665e-3}, {"cm/s^2", 0.01}, {"mm/s^2", 0.001}, {"ft/s^2", 0.3048}};
  std::string names, factors;
  for (const AccelerationUnit& unit : units) {
    if (std::abs(std::abs(gravity) * unit.metres_per_second2 / 9.81 - 1) > 0.05) continue;
    names += (names.empty() ? "" : " or ") + std::string(unit.name);
    factors += (factors.empty() ? "" : " or ") + fmt::format("{:g}", unit.metres_per_second2);
  }
  return names.empty() ? ""
                       : fmt::format("the readings seem to be in {}: multiply them by {}", names, factors);
}

void findGravity(const ImuResult& imu, std::vector<ImuFinding>& findings) {
  const double off = offEarth(imu), std = std::isfinite(imu.gravity_std) ? imu.gravity_std : 0;
  if (imu.gravity_is_fixed || off <= std::max(0.1, 4 * std)) return;
  ImuFinding finding{ImuFinding::Kind::gravity,
                     fmt::format("gravity of {:.3g} m/s^2 is not that of the Earth ({:.2f} to {:.2f})",
                                 imu.gravity, least_on_earth, most_on_earth),
                     "check the unit and the scale of the readings, and that the world's z axis is vertical",
                     off > std::max(other_unit, 6 * std)};
  if (std::string remedy = remedyOfUnit(imu.gravity); !remedy.empty()) finding.remedy = std::move(remedy);
  findings.push_back(std::move(finding));
}

void findMisfit(const Result& result, std::vector<ImuFinding>& findings) {
  const ImuResult& imu = *result.imu;
  const double limit = std::max(misfit * result.sigma_acc, 0.03 * std::abs(imu.gravity));
  if (!(imu.rms_acc > limit)) return;
  findings.push_back(
      {ImuFinding::Kind::misfit,
       fmt::format("the readings of the IMU are off by {} m/s^2 (RMS), but {} are stated",
                   twoDigits(imu.rms_acc), twoDigits(result.sigma_acc)),
       "check their unit, their image numbers, and that the rig stood still and the board lay level", true});
}

void findSign(const ImuResult& imu, std::vector<ImuFinding>& findings) {
  if (imu.sign_evidence < 9) {
    findings.push_back(
        {ImuFinding::Kind::sign,
         "the sign of gravity is undetermined: the images are tilted about one axis only, and the other "
         "sign (with the IMU turned by half a turn) fits as well",
         "add images tilted about another axis"});
  } else if (imu.up_is_known && imu.gravity * imu.up_by_z < 0) {
    // A reflection of the axes and the opposite sign of gravity leave the same residuals, so only the user can
    // distinguish them.
    const bool points_up = imu.reads_gravity;
    findings.push_back(
        {ImuFinding::Kind::handedness,
         fmt::format("the readings of the IMU point {} by {} m/s^2 at rest, but they must point {}",
                     points_up ? "up" : "down", twoDigits(std::abs(imu.gravity)), points_up ? "down" : "up"),
         "unless the sensor reports gravity itself, check whether one or all of its axes have the wrong "
         "sign, or two are exchanged",
         true});
  }
}

void findWeakness(const ImuResult& imu, std::vector<ImuFinding>& findings) {
  if (imu.acc_bias_is_fixed || imu.gravity_is_fixed || !std::isfinite(imu.gravity_std)) return;
  const double ratio = imu.gravity_std / imu.if_acc_bias_fixed.gravity;
  if (ratio < weak_ratio && imu.gravity_std < weak_gravity) return;
  ImuFinding finding{
      ImuFinding::Kind::weak,
      fmt::format("acc_bias and gravity are weakly determined, because the tilts of the images spread by "
                  "only {:.1f} deg: the two trade off against each other and against the rotation "
                  "(multiple correlation of gravity with acc_bias {:.4f})",
                  imu.tilt_spread * 180 / std::numbers::pi, std::sqrt(1 - 1 / (ratio * ratio))),
      "add images with more tilt, about both axes"};
  finding.is_doubt = imu.gravity_std > weak_gravity || imu.precision.rotation > weak_rotation;
  findings.push_back(std::move(finding));
}

}  // namespace

std::vector<ImuFinding> imuFindings(const Result& result) {
  std::vector<ImuFinding> findings;
  if (!result.imu) return findings;
  findGravity(*result.imu, findings);  // first, because another unit is the likeliest mistake
  findSign(*result.imu, findings);
  findMisfit(result, findings);
  findWeakness(*result.imu, findings);
  return findings;
}

}  // namespace slom::calibration
