// Start values of an IMU in motion: clock, rotation, biases, gravity and velocities.
#pragma once

#include <vector>

#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// The rig at an image: time in the clock of the cameras [s], pose of the reference camera.
struct RigAtImage {
  int image = 0;
  double time = 0;
  SE3 left2world;
};

/// What the angular rates say.
struct RatesStart {
  double offset = 0;  ///< t_imu - t_camera, both since their epochs [s]
  SO3 left2imu;
  vec3 gyro_bias{0., 0., 0.};
  double correlation = 0;  ///< of the magnitudes, at the offset
};

/// Returns the offset at which the magnitudes of the angular rates correlate best, over all offsets that leave a common
/// time of at least a third of the shorter recording, and the rotation and bias that then fit best. `offset`: searched
/// only near this one. Throws DataError [slom.calibration.bad-stream] or [slom.calibration.no-motion].
RatesStart startByRates(const ImuStream& imu, const std::vector<RigAtImage>& images,
                        const std::optional<double>& offset);

/// Returns the direction against gravity in the world: the mean specific force, because accelerations cancel in time.
mtk::S2<> upByForces(const ImuStream& imu, const std::vector<RigAtImage>& images, const RatesStart& start);

/// Returns the velocities of the reference camera at the images, in the world, from positions before and after [m/s].
std::vector<vec3> velocitiesOf(const std::vector<RigAtImage>& images);

}  // namespace slom::calibration
