#pragma once
// Readings of the BROAD data set, and its error statistic.
//   source  Laidig, Caruso, Cereatti, Seel, "BROAD - a benchmark for robust inertial orientation estimation", 2021

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <mtk/mtk.hpp>
#include <slom/io/bal.hpp>

#include "support/paths.hpp"

namespace slom::testing {

struct BroadReading {
  double time;                      ///< [s]
  mtk::vect<3> gyro, force, field;  ///< [rad/s], [m/s^2], [uT]
  std::optional<mtk::SO3<>> truth;  ///< world_R_body, where the markers were seen
  bool is_moving;
};

inline const char* const kBroadFile = "attitude/broad_06_undisturbed_fast_rotation_A.csv.bz2";

/// Returns the readings of one trial.
inline std::vector<BroadReading> readBroad(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string compressed{std::istreambuf_iterator<char>(in), {}};
  const std::string text = io::bzip2Decompressed(file, compressed);
  std::vector<BroadReading> readings;
  for (std::size_t line = text.find('\n') + 1; line < text.size(); line = text.find('\n', line) + 1) {
    double x[18];
    const char* at = text.data() + line;
    for (double& number : x) {
      char* end = nullptr;
      number = std::strtod(at, &end);
      at = end + 1;
    }
    readings.push_back(
        {x[0],
         {x[1], x[2], x[3]},
         {x[4], x[5], x[6]},
         {x[7], x[8], x[9]},
         std::isnan(x[10]) ? std::nullopt : std::optional(mtk::SO3<>(x[10], x[11], x[12], x[13])),
         x[17] > 0});
  }
  return readings;
}

/// RMS errors [degree] of orientation: total, about the vertical, and of the vertical.
struct OrientationErrors {
  double total, heading, inclination;
};

/// Errors of orientations against the truth.
class BroadScore {
 public:
  void add(const mtk::SO3<>& truth, const mtk::SO3<>& estimate) {
    errors_.push_back(truth * estimate.inverse());
  }
  std::size_t size() const { return errors_.size(); }
  /// Returns the mean error of heading [degree].
  double headingOffset() const {
    double sum = 0;
    for (const auto& e : errors_) sum += headingOf(e);
    return sum / double(errors_.size()) * kDegrees;
  }
  /// Returns the RMS errors after a rotation of the estimates about the vertical by `offset` [degree].
  OrientationErrors rms(double offset = 0) const {
    const mtk::SO3<> back = mtk::SO3<>::exp(mtk::vect<3>(0, 0, -offset / kDegrees));
    double total = 0, heading = 0, inclination = 0;
    for (const auto& error : errors_) {
      const mtk::SO3<> e = back * error;
      total += std::pow(2 * std::acos(std::min(1., std::abs(e.w()))), 2);
      heading += std::pow(headingOf(e), 2);
      inclination += std::pow(2 * std::acos(std::min(1., std::hypot(e.w(), e.z()))), 2);
    }
    const auto root = [&](double sum) { return std::sqrt(sum / double(errors_.size())) * kDegrees; };
    return {root(total), root(heading), root(inclination)};
  }

 private:
  static constexpr double kDegrees = 57.29577951308232;
  static double headingOf(const mtk::SO3<>& e) { return 2 * std::atan(e.z() / e.w()); }
  std::vector<mtk::SO3<>> errors_;
};

}  // namespace slom::testing
