// A stream of poses as a function of time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "slom/calibration/hand_eye.hpp"

namespace slom::calibration {

/// Two poses that follow each other, with the geodesic between them.
struct Segment {
  double start = 0, duration = 0;  ///< [s]
  SE3 pose;                        ///< at the start
  vec3 turn, move;                 ///< rotation vector from start to end in the moving frame; displacement
};

/// A pose whose rotation and translation have any number type.
template <class R, class P>
struct PoseAt {
  R orient;
  P pos;
};

/// A path through poses, geodesic between them. Beyond its ends the first and last segment continue.
class Track {
 public:
  /// Takes at least two poses of rising times; poses with the time of the one before are left out. Times of the track
  /// count from `origin`.
  Track(const std::vector<StampedPose>& poses, double origin);

  /// Returns the pose at a time, also for numbers that carry derivatives.
  template <class T>
  auto at(const T& time) const {
    const Segment& s = segmentAt(time);
    const auto share = (time - s.start) / s.duration;
    const auto turn = SO3::exp(mtk::vector(share * s.turn[0], share * s.turn[1], share * s.turn[2]));
    const auto orient = s.pose.orient * turn;
    const auto pos = mtk::vector(share * s.move[0] + s.pose.pos[0], share * s.move[1] + s.pose.pos[1],
                                 share * s.move[2] + s.pose.pos[2]);
    return PoseAt<std::remove_const_t<decltype(orient)>, std::remove_const_t<decltype(pos)>>{orient, pos};
  }

  double first() const { return segments_.front().start; }
  double last() const { return segments_.back().start + segments_.back().duration; }
  /// Returns the median time between poses.
  double step() const { return step_; }
  /// Returns the time between poses beyond which there is a gap: nothing is interpolated there.
  double mostStep() const { return std::max(8 * step_, 0.1); }
  /// Returns whether the time lies between two poses that are not separated by a gap.
  bool covers(double time) const {
    return time >= first() && time <= last() && segmentAt(time).duration <= mostStep();
  }
  const std::vector<Segment>& segments() const { return segments_; }

 private:
  template <class T>
  const Segment& segmentAt(const T& time) const {
    const auto after = std::upper_bound(segments_.begin() + 1, segments_.end(), time,
                                        [](const T& t, const Segment& s) { return t < s.start; });
    return *(after - 1);
  }

  std::vector<Segment> segments_;
  double step_ = 0;
};

}  // namespace slom::calibration
