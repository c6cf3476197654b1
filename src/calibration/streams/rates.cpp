#include "calibration/streams/rates.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/nearest_rotation.hpp"
#include "calibration/streams/check.hpp"

namespace slom::calibration {

std::vector<CameraRate> cameraRates(const std::vector<RigAtImage>& images) {
  std::vector<CameraRate> rates;
  for (std::size_t i = 1; i < images.size(); ++i) {
    const RigAtImage &a = images[i - 1], &b = images[i];
    const double duration = b.time - a.time;
    if (duration > longest_pair) continue;
    const SO3 turn = a.left2world.orient.inverse() * b.left2world.orient;
    rates.push_back({a.time, b.time, vec3(SO3::log(turn) / duration)});
  }
  return rates;
}

GyroIntegral::GyroIntegral(const ImuStream& imu) : samples_(imu.samples), gaps_(gapsOf(imu)) {
  sums_.emplace_back(0., 0., 0.);
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    const double h = samples_[i].time - samples_[i - 1].time;
    sums_.push_back(vec3(sums_.back() + (samples_[i].gyro + samples_[i - 1].gyro) * (h / 2)));
  }
}

bool GyroIntegral::covers(double from, double to) const {
  if (from < samples_.front().time || to > samples_.back().time) return false;
  const auto gap = std::upper_bound(gaps_.begin(), gaps_.end(), from,
                                    [](double t, const auto& one) { return t < one.second; });
  return gap == gaps_.end() || gap->first >= to;
}

vec3 GyroIntegral::at(double time) const {
  const auto next = std::upper_bound(samples_.begin() + 1, samples_.end() - 1, time,
                                     [](double t, const ImuSample& s) { return t < s.time; });
  const std::size_t i = std::size_t(next - samples_.begin());
  const double along = (time - samples_[i - 1].time) / (samples_[i].time - samples_[i - 1].time);
  return vec3(sums_[i - 1] + (sums_[i] - sums_[i - 1]) * along);
}

RatePairs pairsAt(double offset, const std::vector<CameraRate>& rates, const GyroIntegral& gyro) {
  RatePairs pairs;
  for (const CameraRate& one : rates) {
    if (!gyro.covers(one.from + offset, one.to + offset)) continue;
    pairs.camera.push_back(one.rate);
    pairs.gyro.push_back(gyro.mean(one.from + offset, one.to + offset));
  }
  return pairs;
}

RatesAlignment align(const RatePairs& pairs, bool mirrored) {
  const double n = double(pairs.camera.size());
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
  for (std::size_t i = 0; i < pairs.camera.size(); ++i) a += pairs.camera[i] / n, b += pairs.gyro[i] / n;
  Eigen::Matrix3d B = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.camera.size(); ++i)
    B += (pairs.gyro[i] - b) * (pairs.camera[i] - a).transpose();
  RatesAlignment result;
  result.R = nearestRotation(B, mirrored);
  result.bias = vec3(b - result.R * a);
  for (std::size_t i = 0; i < pairs.camera.size(); ++i)
    result.rms += (result.R * pairs.camera[i] + result.bias - pairs.gyro[i]).squaredNorm() / n;
  result.rms = std::sqrt(result.rms);
  return result;
}

}  // namespace slom::calibration
