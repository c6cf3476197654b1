#include "calibration/hand_eye/track.hpp"

#include "calibration/median.hpp"

namespace slom::calibration {

Track::Track(const std::vector<StampedPose>& poses, double origin) {
  segments_.reserve(poses.size());
  const StampedPose* before = &poses.front();
  std::vector<double> steps;
  for (const StampedPose& pose : poses) {
    const double duration = pose.t_s - before->t_s;
    if (!(duration > 0)) continue;
    segments_.push_back({before->t_s - origin, duration, before->pose,
                         SO3::log(before->pose.orient.inverse() * pose.pose.orient),
                         vec3(pose.pose.pos - before->pose.pos)});
    steps.push_back(duration);
    before = &pose;
  }
  step_ = medianOf(std::move(steps));
}

}  // namespace slom::calibration
