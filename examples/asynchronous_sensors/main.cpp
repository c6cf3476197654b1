// Two sensors that never measure at the same time: a camera that sees poses at 20 Hz, and a gyroscope at 100 Hz whose
// clock differs by an unknown offset. The motion is fitted as a spline and as a Gaussian process. Units: metre, radian,
// second.
#include <cmath>
#include <cstdio>

#include <mtk/testing/random.hpp>
#include <slom/slom.hpp>
#include <slom/trajectory.hpp>

using Pose = mtk::trafo<mtk::SO3<>>;  // world_T_body
using Vec3 = mtk::vect<3>;
using namespace slom::trajectory;

constexpr double kDuration = 6, kOffset = 0.043, kPoseSigma = 0.003, kGyroSigma = 0.01;

// The true motion: it turns about its z axis and swings about its x axis.
mtk::SO3<> swing(double t) { return mtk::SO3<>::exp(Vec3(0.5 * std::sin(3 * t), 0, 0)); }
Pose truePose(double t) {
  return {Vec3(std::cos(t), std::sin(t), 0.2 * std::sin(4 * t)), mtk::SO3<>::exp(Vec3(0, 0, t)) * swing(t)};
}
Vec3 trueRate(double t) { return swing(t).inverse() * Vec3(0, 0, 1) + Vec3(1.5 * std::cos(3 * t), 0, 0); }

// What the sensors measure, for any representation of the motion.
struct Camera {
  auto operator()(const auto& motion, double t) const { return motion.poseAt(t); }
};
struct Gyroscope {
  auto operator()(const auto& motion, const auto& offset, const auto& bias, double stamp) const {
    return motion.angularVelocityAt(stamp + offset) + bias;
  }
};

template <class Motion>
void fit(const char* title, Motion motion) {
  mtk::testing::Random random(1);
  const auto noise = [&](double sigma) {
    return Vec3(sigma * random.normal(), sigma * random.normal(), sigma * random.normal());
  };
  slom::Estimator est;
  motion.extend(est, 0, kDuration,
                truePose);  // start values; with real data, the nearest pose that the camera saw
  motion.tieEnds(est);
  for (int i = 0; i < 20 * kDuration; ++i) {
    const double t = 0.05 * i + 0.013;
    const Pose seen(Vec3(truePose(t).pos + noise(kPoseSigma)),
                    truePose(t).orient * mtk::SO3<>::exp(noise(kPoseSigma)));
    insertMeasurement(est, Camera(), motion.around(t), t, slom::measured(seen),
                      slom::StandardDeviation(kPoseSigma));
  }
  const auto offset = est.insertRV(0.0, "offset");
  const auto bias = est.insertRV(Vec3(), "bias");
  for (int i = 0; i < 100 * (kDuration - 0.1); ++i) {
    const double stamp = 0.01 * i;
    const Vec3 rate = trueRate(stamp + kOffset) + Vec3(0.02, -0.01, 0.03) + noise(kGyroSigma);
    insertMeasurement(est, Gyroscope(), motion.around(stamp, offset), offset, bias, stamp,
                      slom::measured(rate), slom::StandardDeviation(kGyroSigma));
  }
  const slom::Summary summary = optimize(est, {motion});

  const double t = 2.3456;  // any time
  const auto at = motion.segmentAt(t);
  std::printf("%s: %s, %d unknowns\n", title, summary.converged ? "converged" : "NOT converged", est.getN());
  std::printf("  offset %.1f +- %.1f ms, true %.1f\n", 1e3 * *offset, 1e3 * est.standardDeviation(offset)[0],
              1e3 * kOffset);
  std::printf("  at %.4f s: position off by %.1f mm, velocity by %.0f mm/s\n", t,
              1e3 * (at.positionAt(t) - truePose(t).pos).norm(),
              1e3 * (at.velocityAt(t) - Vec3(-std::sin(t), std::cos(t), 0.8 * std::cos(4 * t))).norm());
}

int main() {
  fit("spline of order 5", PoseSpline<5>(Knots(0, 0.2), "motion"));
  fit("white noise on jerk", PoseProcess<WhiteNoise::on_jerk>(Knots(0, 0.2), poseDensity(30, 30), "motion"));
}
