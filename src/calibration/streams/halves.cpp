#include "calibration/streams/halves.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// Returns the readings before a time, or from then on.
ImuStream partOf(ImuStream imu, double time, bool is_first) {
  const auto at = std::lower_bound(imu.samples.begin(), imu.samples.end(), time,
                                   [](const ImuSample& sample, double t) { return sample.time < t; });
  if (is_first)
    imu.samples.erase(at, imu.samples.end());
  else
    imu.samples.erase(imu.samples.begin(), at);
  return imu;
}

/// Returns the standard deviation of a difference of halves: both stated ones, as much larger as clustering makes it.
double stdOfDifference(double first, double second, double stated, double clustered) {
  return std::hypot(first, second) * std::fmax(1, clustered / stated);
}

vec3 stdOfDifference(const vec3& first, const vec3& second, const vec3& stated, const vec3& clustered) {
  vec3 std;
  for (int i = 0; i < 3; ++i) std[i] = stdOfDifference(first[i], second[i], stated[i], clustered[i]);
  return std;
}

ImuAgreement differenceOf(const ImuStreamResult& a, const ImuStreamResult& b, const ImuStreamResult& whole) {
  ImuAgreement one;
  one.name = whole.name;
  one.translation = vec3(b.left2imu.pos - a.left2imu.pos);
  one.translation_std = stdOfDifference(a.translation_std, b.translation_std, whole.translation_std,
                                        whole.translation_clustered);
  one.rotation = SO3::log(a.left2imu.orient.inverse() * b.left2imu.orient);
  one.rotation_std =
      stdOfDifference(a.rotation_std, b.rotation_std, whole.rotation_std, whole.rotation_clustered);
  one.time_offset = b.time_offset - a.time_offset;
  one.time_offset_std = stdOfDifference(a.time_offset_std, b.time_offset_std, whole.time_offset_std,
                                        whole.time_offset_clustered);
  return one;
}

}  // namespace

void addHalves(const std::vector<StartedImu>& imus, const std::vector<RigAtImage>& images,
               const std::function<PosesOfImus(const std::vector<StartedImu>&)>& fit, StreamResult& result) {
  PosesOfImus halves[2];
  for (const bool is_first : {true, false}) {
    std::vector<ImuStream> parts;
    for (const StartedImu& imu : imus) {
      const auto& samples = imu.stream->samples;
      const double from = std::max(samples.front().time, images.front().time + imu.start.offset),
                   to = std::min(samples.back().time, images.back().time + imu.start.offset);
      parts.push_back(partOf(*imu.stream, from / 2 + to / 2, is_first));
    }
    std::vector<StartedImu> started = imus;
    for (std::size_t i = 0; i < imus.size(); ++i) started[i].stream = &parts[i];
    try {
      halves[is_first ? 0 : 1] = fit(started);
    } catch (const slom::Error&) {
      return;  // a half leaves something open
    }
  }
  for (std::size_t i = 0; i < std::min(halves[0].size(), halves[1].size()); ++i)
    result.imus[i].halves = differenceOf(halves[0][i], halves[1][i], result.imus[i]);
}

}  // namespace slom::calibration
