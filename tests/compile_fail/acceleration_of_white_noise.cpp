// expect: slom: the acceleration of this process is white noise and has no value; use WhiteNoise::on_jerk
#include <slom/trajectory.hpp>

auto f(const slom::trajectory::PoseProcess<slom::trajectory::WhiteNoise::on_acceleration>& pose) {
#ifdef MUST_FAIL
  return pose.segmentAt(1).bodyAccelerationAt(1.0);
#else
  return pose.segmentAt(1).bodyVelocityAt(1.0);
#endif
}
