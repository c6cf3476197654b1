// Section 3 of the paper: online model fitting with bounded effort. Poses come in one by one; those older than the window
// are fixed, and once no optimised pose refers to them they and their measurements are removed.
#include <slom/slom.hpp>

#include <cmath>
#include <cstdio>
#include <deque>

typedef MTK::vect<2> vec2;
typedef MTK::vect<3> vec3;
typedef MTK::trafo<MTK::SO2< > > Pose;

SLOM_BUILD_MEASUREMENT(Odometry, 3, ((Pose, from)) ((Pose, to)), ((Pose, motion)))
SLOM_IMPLEMENT_MEASUREMENT(Odometry, ret) { ret = MTK::difference(from->inverse() * *to, motion); }

// A compass: the heading, with an offset that has to be estimated too.
SLOM_BUILD_MEASUREMENT(Compass, 1, ((Pose, pose)) ((MTK::Scalar<>, offset)), ((MTK::SO2<>, reading)))
SLOM_IMPLEMENT_MEASUREMENT(Compass, ret) { ret = MTK::difference(pose->orient * MTK::SO2<>(*offset), reading); }

// A position fix, as from a satellite receiver.
SLOM_BUILD_MEASUREMENT(Fix, 2, ((Pose, pose)), ((vec2, position)))
SLOM_IMPLEMENT_MEASUREMENT(Fix, ret) { ret = pose->pos - position; }

int main() {
  const std::size_t window = 10;
  SLOM::Estimator est;
  SLOM::VarID<MTK::Scalar<>> offset = est.insertRV(MTK::Scalar<>(0.0), false, "compass offset");  // known later

  struct Frame {
    SLOM::VarID<Pose> pose;
    SLOM::MeasID<Odometry> odometry;
    SLOM::MeasID<Compass> compass;
    SLOM::MeasID<Fix> fix;
  };
  std::deque<Frame> frames;
  const Pose motion(MTK::SO2< >(0.1), vec2(1, 0));
  const double true_offset = 0.3;
  Pose truth;
  for (int k = 0; k < 200; ++k) {
    Frame frame;
    frame.pose = est.insertRV(frames.empty() ? Pose() : *frames.back().pose * motion, "pose" + std::to_string(k));
    if (!frames.empty()) {
      // Wheels that slip a little: the odometry is 1 % short.
      const Pose measured(motion.orient, vec2(0.99 * motion.pos));
      frame.odometry = est.insertMeasurement(Odometry(frames.back().pose, frame.pose, measured),
                                             SLOM::StandardDeviation(vec3(0.05, 0.05, 0.01)));
    }
    frame.compass = est.insertMeasurement(
        Compass(frame.pose, offset, truth.orient * MTK::SO2<>(true_offset + 0.02 * std::sin(7.0 * k))), SLOM::StandardDeviation(0.02));
    frame.fix = est.insertMeasurement(Fix(frame.pose, truth.pos + vec2(0.2 * std::sin(3.0 * k), 0.2 * std::cos(5.0 * k))),
                                      SLOM::StandardDeviation(0.2));
    frames.push_back(frame);
    if (k == 5) est.optimizeRV(offset, true);  // enough poses to tell the offset from the heading: "un-fix" it

    if (frames.size() > window + 1) {  // fix what leaves the window ...
      est.optimizeRV(frames[frames.size() - window - 1].pose, false);
      const Frame old = frames.front();  // ... and remove what is fixed on both sides
      if (frames.size() > window + 2) {
        est.removeMeasurement(frames[1].odometry);
        est.removeMeasurement(old.compass);
        est.removeMeasurement(old.fix);
        est.removeRV(old.pose);
        frames.pop_front();
      }
    }
    est.optimizeStep();
    if (k % 40 == 39) {
      std::printf("pose %3d: %2d unknowns, %2d residuals, position error %.2f m, compass offset %.3f\n", k, est.getN(), est.getM(),
                  (frames.back().pose->pos - truth.pos).norm(), double(*offset));
    }
    truth = truth * motion;
  }
}
