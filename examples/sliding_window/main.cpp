// Online model fitting with bounded effort: section 3 of the paper. Poses arrive one by one. The oldest pose of the
// window is marginalised: a prior keeps the information that its measurements give on the others.
#include <cmath>
#include <cstdio>

#include <slom/fixed_lag.hpp>
#include <slom/slom.hpp>

typedef MTK::vect<2> vec2;
typedef MTK::vect<3> vec3;
typedef MTK::trafo<MTK::SO2<>> Pose;

SLOM_BUILD_MEASUREMENT(Odometry, 3, ((Pose, from)) ((Pose, to)), ((Pose, motion)))
SLOM_IMPLEMENT_MEASUREMENT(Odometry, ret) { ret = MTK::difference(from->inverse() * *to, motion); }

// A compass: it measures the heading, with an offset that is estimated too.
SLOM_BUILD_MEASUREMENT(Compass, 1, ((Pose, pose)) ((MTK::Scalar<>, offset)), ((MTK::SO2<>, reading)))
SLOM_IMPLEMENT_MEASUREMENT(Compass, ret) {
  ret = MTK::difference(pose->orient * MTK::SO2<>(*offset), reading);
}

// A position fix, for example from a satellite receiver.
SLOM_BUILD_MEASUREMENT(Fix, 2, ((Pose, pose)), ((vec2, position)))
SLOM_IMPLEMENT_MEASUREMENT(Fix, ret) { ret = pose->pos - position; }

int main() {
  SLOM::Estimator est;
  SLOM::FixedLag window({.variables = 11});
  SLOM::VarID<MTK::Scalar<>> offset =
      est.insertRV(MTK::Scalar<>(0.0), false, "compass offset");  // estimated later

  SLOM::VarID<Pose> last;
  const Pose motion(MTK::SO2<>(0.1), vec2(1, 0));
  const double true_offset = 0.3;
  Pose truth;
  for (int k = 0; k < 200; ++k) {
    SLOM::VarID<Pose> pose = est.insertRV(k == 0 ? Pose() : *last * motion, "pose" + std::to_string(k));
    if (k > 0) {
      // The wheels slip a little: the odometry is 1 % short.
      const Pose measured(motion.orient, vec2(0.99 * motion.pos));
      est.insertMeasurement(Odometry(last, pose, measured), SLOM::StandardDeviation(vec3(0.05, 0.05, 0.01)));
    }
    est.insertMeasurement(
        Compass(pose, offset, truth.orient * MTK::SO2<>(true_offset + 0.02 * std::sin(7.0 * k))),
        SLOM::StandardDeviation(0.02));
    est.insertMeasurement(Fix(pose, truth.pos + vec2(0.2 * std::sin(3.0 * k), 0.2 * std::cos(5.0 * k))),
                          SLOM::StandardDeviation(0.2));
    window.add(pose);
    last = pose;
    if (k == 5)
      est.optimizeRV(offset, true);  // enough poses to distinguish the offset from the heading: "un-fix" it

    est.optimizeStep();
    window.forget(est);
    if (k % 40 == 39) {
      std::printf(
          "pose %3d: %2d unknowns, %2d residuals, position error %.2f m, compass offset %.3f +- %.3f\n", k,
          est.getN(), est.getM(), (pose->pos - truth.pos).norm(), double(*offset),
          est.standardDeviation(offset)[0]);
    }
    truth = truth * motion;
  }
}
