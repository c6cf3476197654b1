// Cameras and IMUs together: the problem of the rig, with the readings between images.
#pragma once

#include <vector>

#include <slom/slom.hpp>

#include "calibration/fit/rig.hpp"
#include "calibration/streams/between_images.hpp"
#include "calibration/streams/start.hpp"
#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// One IMU with the start values and the noise of its fit.
struct StartedImu {
  const ImuStream* stream = nullptr;
  RatesStart start;
  ImuNoise noise;
  SE3 left2imu{start.left2imu};
  vec3 force_bias{0., 0., 0.};
};

/// Start values of the cameras.
struct CamerasStart {
  std::vector<Lens> lenses;
  RigStart rig;
};
/// Returns the values of the cameras' own fit.
CamerasStart startOf(const Result& cameras);

/// Returns a factor for a standard deviation, kept within limits: residuals may be 0, or too few to say anything.
double limited(double ratio);

class StreamProblem {
 public:
  /// Builds the problem. `data` (on the fitted board), `settings` and the streams must outlive it.
  StreamProblem(const Dataset& data, const Settings& settings, const CamerasStart& cameras,
                const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                const std::vector<StartedImu>& imus, double gravity);

  Summary optimize(const Options& options) { return rig_.optimize(options); }
  /// Returns values and standard deviations. These stay unknown if the data leave a direction open; `undetermined` then
  /// says why.
  StreamResult result(const Summary& summary);
  /// Returns the IMUs with the current values and, unless the caller gave their noise, with the densities of white noise
  /// that the residuals suggest.
  std::vector<StartedImu> restarted() const;
  /// Returns how far the poses are from where the corners of their images alone would put them, relative to what the
  /// stated noise of the corners explains: 1 if errors of corners are independent, more if corners of an image share
  /// errors.
  double imageRatio() const;
  mtk::S2<> up() const { return *up_; }
  CamerasStart cameras() const { return {rig_.cameras(), rig_.rig()}; }

 private:
  /// The readings between two successive images.
  struct Interval {
    std::size_t first = 0;  ///< index of the image before
    double duration = 0;    ///< [s]
    PreintegratedImu::Covariance9 noise;
    AnyMeasID id;

    Eigen::Matrix3d turnNoise() const { return noise.topLeftCorner<3, 3>(); }
    Eigen::Matrix<double, 6, 6> pushNoise() const { return noise.bottomRightCorner<6, 6>(); }
  };
  struct Imu {
    const ImuStream* stream = nullptr;
    ImuNoise noise;
    ImuSamples samples;
    VarID<SE3> left2imu;
    VarID<mtk::Scalar<>> offset;
    std::vector<VarID<vec3>> velocities;                 ///< by image
    std::vector<VarID<vec3>> gyro_biases, force_biases;  ///< by interval
    std::vector<Interval> intervals;
  };
  /// Residuals of an IMU divided by what its noise predicts, as root mean square, without what the fit absorbs.
  struct Ratios {
    double gyro = unknown, force = unknown;
  };

  /// The gradient of the pose of the rig at an image, from the corners of that image, and its derivatives: by this pose,
  /// the parameters of all lenses, and the poses left2camera of all cameras but the first.
  struct PullOfImage {
    Eigen::MatrixXd by_variables;  ///< 6 rows
    Eigen::Matrix<double, 6, 1> gradient;
  };

  void insert(const StartedImu& started);
  void insertIntervals(Imu& imu, const StartedImu& started);
  void insertWalk(Imu& imu, const ImuNoise& noise);
  Ratios ratiosOf(const Imu& imu) const;
  std::pair<double, double> expectedSquares(const Imu& imu) const;
  PullOfImage pullOf(int image, const CamerasStart& now) const;
  ImuStreamResult resultOf(const Imu& imu) const;
  void addStandardDeviations(StreamResult& result);
  void addClustered(StreamResult& result);

  const Dataset& data_;
  const Settings& settings_;
  const std::vector<RigAtImage>& images_;
  double gravity_;
  RigProblem rig_;
  Estimator& est_;
  VarID<mtk::S2<>> up_;
  std::vector<Imu> imus_;
};

}  // namespace slom::calibration
