#include <memory>

#include <slom/measurements/preintegration.hpp>

#include "fits.hpp"

namespace slom::bench {

namespace {

/// The pose of the camera at an image.
struct SeenByCamera {
  auto operator()(const auto& body, const auto& body_T_camera) const { return body * body_T_camera; }
};

/// The readings between two times of the camera's clock, integrated anew for each offset and each bias.
struct Between {
  ImuSamples samples;
  double from, to;

  template <class V>
  auto operator()(const auto& pose_i, const auto& velocity_i, const V& gyro_bias, const V& force_bias,
                  const auto& pose_j, const auto& velocity_j, const auto& offset, const auto& up) const {
    using S = mtk::scalar_t<V>;
    const S shift(offset);
    return samples.motion(from + shift, to + shift, withoutBias(gyro_bias, force_bias))
        .residual(pose_i, velocity_i, pose_j, velocity_j, up.vector() * (-kGravity), to - from);
  }
};

}  // namespace

Fit byPreintegration(const Recording& given) {
  const auto kept = std::make_shared<const Recording>(given);
  const Recording& recording = *kept;
  const auto est = std::make_shared<Estimator>();
  const auto body_T_camera = est->insertRV(recording.body_T_camera, "body_T_camera");
  const auto offset = est->insertRV(0.0, "offset");
  const auto gyro_bias = est->insertRV(Vec3(), "gyro_bias"), force_bias = est->insertRV(Vec3(), "force_bias");
  const auto up = est->insertRV(roughlyUp(recording), "up");
  std::vector<VarID<Pose>> poses;
  std::vector<VarID<Vec3>> velocities;
  Eigen::Matrix<double, 6, 1> sigmas;
  sigmas << Vec3(1, 1, 1) * recording.position_sigma, Vec3(1, 1, 1) * recording.angle_sigma;
  const ImuSamples samples(recording.readings);
  const auto& images = recording.images;
  for (std::size_t i = 0; i < images.size(); ++i) {
    poses.push_back(est->insertRV(images[i].pose * recording.body_T_camera.inverse(), "pose"));
    const std::size_t near = i == 0 ? 1 : i;
    const Vec3 moved = images[near].pose.pos - images[near - 1].pose.pos;
    velocities.push_back(
        est->insertRV(Vec3(moved / (images[near].time - images[near - 1].time)), "velocity"));
    est->insertMeasurement(SeenByCamera(), poses[i], body_T_camera, measured(images[i].pose),
                           StandardDeviation(sigmas));
    if (i == 0) continue;
    const double from = images[i - 1].time, to = images[i].time;
    const PreintegratedImu noise(samples, from, to, recording.noise);
    est->insertMeasurement(Between{samples, from, to}, poses[i - 1], velocities[i - 1], gyro_bias, force_bias,
                           poses[i], velocities[i], offset, up, Covariance(noise.covariance()));
  }
  const Summary summary = est->optimize();
  Fit fit{summary.converged,
          est->getN(),
          summary.iterations,
          summary.seconds,
          summary.chi2PerDof(),
          *offset,
          0,
          *body_T_camera,
          {},
          {}};
  fit.offset_sigma = est->standardDeviation(offset)[0];
  fit.covariance = est->covariance(body_T_camera);
  fit.poseAt = [=, owner = est](double t) {
    const auto& images = kept->images;
    std::size_t i = 0;
    while (i + 2 < images.size() && images[i + 1].time <= t) ++i;
    const double from = images[i].time, duration = t - from;
    const auto moved = samples.motion(from + *offset, t + *offset, withoutBias(*gyro_bias, *force_bias));
    const Vec3 g = up->vector() * (-kGravity);
    const Pose& at = *poses[i];
    return Pose(
        Vec3(at.pos + *velocities[i] * duration + g * (duration * duration / 2) + at.orient * moved.position),
        at.orient * moved.rotation);
  };
  return fit;
}

}  // namespace slom::bench
