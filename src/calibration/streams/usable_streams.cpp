#include "calibration/streams/usable_streams.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "calibration/streams/check.hpp"

namespace slom::calibration {

namespace {

/// Returns the readings that jump, but for those at the ends of times in which readings stay the same.
Spikes spikesBeside(const std::vector<GrossReadings>& stuck, const ImuStream& imu) {
  Spikes spikes = spikesOf(imu);
  const double margin = 2 * (imu.samples.back().time - imu.samples.front().time) / double(imu.samples.size());
  std::erase_if(spikes.all, [&](const ImuSpike& spike) {
    return std::any_of(stuck.begin(), stuck.end(), [&](const GrossReadings& one) {
      return spike.time > one.from - margin && spike.time < one.to + margin;
    });
  });
  return spikes;
}

}  // namespace

UsableStreams::UsableStreams(const std::vector<ImuStream>& imus, Robust robust)
    : given_(imus), robust_(robust), gross_(imus.size()), jumps_(imus.size()) {
  for (const ImuStream& imu : imus) {
    requireGoodStream(imu);
    stuck_.push_back(isRobust() ? stuckReadings(imu) : std::vector<GrossReadings>());
    spikes_.push_back(isRobust() ? spikesBeside(stuck_.back(), imu) : Spikes());
    used_.push_back(withoutSpikes(imu, spikes_.back().all));
    removeReadings(stuck_.back(), used_.back());
  }
}

namespace {

/// Returns whether there is something of any IMU.
template <class T>
bool hasAny(const std::vector<std::vector<T>>& by_imu) {
  return std::any_of(by_imu.begin(), by_imu.end(), [](const std::vector<T>& one) { return !one.empty(); });
}

}  // namespace

bool UsableStreams::remove(std::vector<std::vector<GrossReadings>> gross) {
  if (robust_ == Robust::none || !hasAny(gross)) return false;
  gross_ = std::move(gross);
  for (std::size_t i = 0; i < used_.size(); ++i) removeReadings(gross_[i], used_[i]);
  return true;
}

bool UsableStreams::remove(std::vector<std::vector<BiasJump>> jumps) {
  if (robust_ == Robust::none || !hasAny(jumps)) return false;
  jumps_ = std::move(jumps);
  for (std::size_t i = 0; i < used_.size(); ++i) removeJumps(jumps_[i], used_[i]);
  return true;
}

bool UsableStreams::remove(const ForceLags& lags) {
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (lags[i]) removeLag(lags[i]->value, used_[i]);
  }
  return std::any_of(lags.begin(), lags.end(), [](const auto& lag) { return lag.has_value(); });
}

void UsableStreams::report(StreamResult& result) const {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < given_.size(); ++i) {
    result.imus[i].spikes = spikes_[i].all;
    result.imus[i].gross = stuck_[i];
    result.imus[i].gross.insert(result.imus[i].gross.end(), gross_[i].begin(), gross_[i].end());
    result.imus[i].jumps = jumps_[i];
    for (std::string note : {noteOnStuck(stuck_[i], given_[i]), noteOn(spikes_[i], given_[i]),
                             noteOn(gross_[i], given_[i]), noteOn(jumps_[i], given_[i])}) {
      if (!note.empty()) notes.push_back(std::move(note));
    }
  }
  result.notes.insert(result.notes.begin(), notes.begin(), notes.end());
}

}  // namespace slom::calibration
