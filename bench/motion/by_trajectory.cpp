#include <cmath>
#include <memory>
#include <stdexcept>

#include <mtk/testing/random.hpp>
#include <slom/trajectory.hpp>

#include "fits.hpp"

namespace slom::bench {

namespace {

using trajectory::Knots;
using trajectory::PoseProcess;
using trajectory::PoseSpline;
using trajectory::WhiteNoise;

// The same functions for splines and processes. Stamps of the other sensors are their times plus the offset.

struct SeenByBody {
  auto operator()(const auto& motion, double t) const { return motion.poseAt(t); }
};
struct SeenByCamera {
  auto operator()(const auto& motion, const auto& body_T_camera, double t) const {
    return motion.poseAt(t) * body_T_camera;
  }
};
struct SeenLater {
  auto operator()(const auto& motion, const auto& offset, const auto& body_T_camera, double stamp) const {
    return motion.poseAt(stamp - offset) * body_T_camera;
  }
};
struct Gyro {
  auto operator()(const auto& motion, const auto& offset, const auto& bias, double stamp) const {
    return motion.angularVelocityAt(stamp - offset) + bias;
  }
};
struct Accelerometer {
  auto operator()(const auto& motion, const auto& offset, const auto& bias, const auto& up,
                  double stamp) const {
    const auto t = stamp - offset;
    return motion.bodyAccelerationAt(t) + motion.orientationAt(t).inverse() * (up.vector() * kGravity) + bias;
  }
};

Eigen::Matrix<double, 6, 1> sigmasOfPoses(const auto& recording) {
  Eigen::Matrix<double, 6, 1> sigmas;
  sigmas << Vec3(1, 1, 1) * recording.position_sigma, Vec3(1, 1, 1) * recording.angle_sigma;
  return sigmas;
}

/// Fits the images alone, then adds the other sensors by `add` and fits all.
template <class Trajectory>
Fit fitted(const std::shared_ptr<Estimator>& est, Trajectory motion, const VarID<double>& offset,
           const VarID<Pose>& body_T_camera, const auto& add) {
  est->fix(offset), est->fix(body_T_camera);
  motion.tieEnds(*est);
  const Summary start = est->optimize();
  est->free(offset), est->free(body_T_camera);
  add();
  const Summary summary = trajectory::optimize(*est, {motion});
  Fit fit{summary.converged,
          est->getN(),
          start.iterations + summary.iterations,
          start.seconds + summary.seconds,
          summary.chi2PerDof(),
          *offset,
          est->standardDeviation(offset)[0],
          *body_T_camera,
          est->covariance(body_T_camera),
          {}};
  fit.poseAt = [est, motion](double t) { return motion.segmentAt(t).poseAt(t); };
  return fit;
}

template <class Trajectory>
Fit fitImu(const Recording& recording, Trajectory motion) {
  const auto est = std::make_shared<Estimator>();
  const auto& images = recording.images;
  motion.extend(*est, images.front().time, images.back().time, [&](double t) -> typename Trajectory::Control {
    return Pose(nearest(images, t) * recording.body_T_camera.inverse());
  });
  const auto body_T_camera = est->insertRV(recording.body_T_camera, "body_T_camera");
  const auto offset = est->insertRV(0.0, "offset");
  for (const Sighting& image : images) {
    trajectory::insertMeasurement(*est, SeenByCamera(), motion.around(image.time), body_T_camera, image.time,
                                  measured(image.pose), StandardDeviation(sigmasOfPoses(recording)));
  }
  return fitted(est, motion, offset, body_T_camera, [&] {
    const auto gyro_bias = est->insertRV(Vec3(), "gyro_bias"),
               force_bias = est->insertRV(Vec3(), "force_bias");
    const auto up = est->insertRV(roughlyUp(recording), "up");
    const double rate = double(recording.readings.size() - 1) /
                        (recording.readings.back().time - recording.readings.front().time);
    const double margin = 0.05;  // for the offset
    for (const ImuSample& reading : recording.readings) {
      const double stamp = reading.time;
      if (stamp < images.front().time + margin || stamp > images.back().time - margin) continue;
      const auto place = motion.around([=] { return stamp - *offset; });
      trajectory::insertMeasurement(*est, Gyro(), place, offset, gyro_bias, stamp, measured(reading.gyro),
                                    StandardDeviation(recording.noise.gyro * std::sqrt(rate)));
      trajectory::insertMeasurement(*est, Accelerometer(), place, offset, force_bias, up, stamp,
                                    measured(reading.force),
                                    StandardDeviation(recording.noise.force * std::sqrt(rate)));
    }
  });
}

template <class Trajectory>
Fit fitAsynchronous(const Asynchronous& recording, Trajectory motion) {
  const auto est = std::make_shared<Estimator>();
  const auto& first = recording.first;
  motion.extend(*est, first.front().time, first.back().time,
                [&](double t) -> typename Trajectory::Control { return nearest(first, t); });
  const auto body_T_camera = est->insertRV(Pose(), "body_T_camera");
  const auto offset = est->insertRV(0.0, "offset");
  for (const Sighting& image : first) {
    trajectory::insertMeasurement(*est, SeenByBody(), motion.around(image.time), image.time,
                                  measured(image.pose), StandardDeviation(sigmasOfPoses(recording)));
  }
  return fitted(est, motion, offset, body_T_camera, [&] {
    const auto bias = est->insertRV(Vec3(), "bias");
    const auto place = [&](double stamp) { return motion.around([=] { return stamp - *offset; }); };
    for (const Sighting& image : recording.second) {
      trajectory::insertMeasurement(*est, SeenLater(), place(image.time), offset, body_T_camera, image.time,
                                    measured(image.pose), StandardDeviation(sigmasOfPoses(recording)));
    }
    for (const ImuSample& reading : recording.readings) {
      trajectory::insertMeasurement(*est, Gyro(), place(reading.time), offset, bias, reading.time,
                                    measured(reading.gyro), StandardDeviation(recording.gyro_sigma));
    }
  });
}

Fit ofSpline(const auto& recording, int order, double spacing, const auto& fit) {
  const Knots knots(0, spacing);
  if (order == 4) return fit(recording, PoseSpline<4>(knots, "motion"));
  if (order == 5) return fit(recording, PoseSpline<5>(knots, "motion"));
  if (order == 6) return fit(recording, PoseSpline<6>(knots, "motion"));
  throw std::invalid_argument("bench_motion: splines of order 4 to 6");
}

}  // namespace

Fit bySpline(const Recording& recording, int order, double spacing) {
  return ofSpline(recording, order, spacing,
                  [](const auto& all, const auto& motion) { return fitImu(all, motion); });
}

Fit byProcess(const Recording& recording, double spacing, double position_density,
              double orientation_density) {
  return fitImu(recording, PoseProcess<WhiteNoise::on_jerk>(
                               Knots(0, spacing),
                               trajectory::poseDensity(position_density, orientation_density), "motion"));
}

Asynchronous simulateAsynchronous(const Truth& truth, double duration, std::uint64_t seed) {
  mtk::testing::Random random(seed, 2);
  Asynchronous all{{}, {}, {}, 0.002, 0.002, 0.005};
  const auto at = [&](double t) { return Pose(truth.motion.position(t), truth.motion.orientation(t)); };
  for (double t = 0; t < duration; t += 1.0 / 17)
    all.first.push_back({t, withNoise(at(t), random, all.position_sigma, all.angle_sigma)});
  for (double t = 0.1; t < duration - 0.15; t += 1.0 / 23) {
    all.second.push_back({t + truth.offset, withNoise(at(t) * truth.body_T_camera, random, all.position_sigma,
                                                      all.angle_sigma)});
  }
  for (double t = 0.1; t < duration - 0.15; t += 0.01) {
    all.readings.push_back(
        {t + truth.offset,
         Vec3(truth.motion.angularVelocity(t) + Vec3(0.01, 0, -0.02) + randomVector(random, all.gyro_sigma)),
         Vec3()});
  }
  return all;
}

Fit bySpline(const Asynchronous& recording, int order, double spacing) {
  return ofSpline(recording, order, spacing,
                  [](const auto& all, const auto& motion) { return fitAsynchronous(all, motion); });
}

Fit byProcess(const Asynchronous& recording, bool on_jerk, double spacing, double position_density,
              double orientation_density) {
  const auto density = trajectory::poseDensity(position_density, orientation_density);
  if (on_jerk)
    return fitAsynchronous(recording, PoseProcess<WhiteNoise::on_jerk>(Knots(0, spacing), density, "motion"));
  return fitAsynchronous(recording,
                         PoseProcess<WhiteNoise::on_acceleration>(Knots(0, spacing), density, "motion"));
}

}  // namespace slom::bench
