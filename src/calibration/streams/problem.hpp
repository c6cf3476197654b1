// Cameras and IMUs together: the problem of the rig, with the readings between images.
#pragma once

#include <map>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/streams/axes.hpp"
#include "calibration/streams/between_images.hpp"
#include "calibration/streams/condensed.hpp"
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
  /// From an earlier fit, by image: the velocity there, and the biases of gyroscope and accelerometer from there on.
  std::map<std::size_t, vec3> velocities{}, gyro_biases{}, force_biases{};
  ImuAxes axes = ImuAxes::calibrated;  ///< that are estimated
  ImuModel<> model{};                  ///< without biases
  std::vector<BiasJump> jumps{};       ///< that the readings no longer have
};

/// Returns a factor for a standard deviation, kept within limits: residuals may be 0, or too few to say anything.
double limited(double ratio);

/// True length on the board / stated length.
struct BoardScale {
  double value = 1;
  double std = unknown;  ///< the larger one of stated and clustered; unknown: the fit did not converge
};

class StreamProblem {
 public:
  /// Builds the problem. `settings`, `images` and the streams must outlive it. `cameras`, `up` and `imus` are start values.
  /// `loss`: of the readings between two images.
  StreamProblem(const Dataset& data, const CondensedCorners& corners, const Settings& settings,
                const CamerasAt& cameras, const std::vector<RigAtImage>& images, const mtk::S2<>& up,
                const std::vector<StartedImu>& imus, double gravity, const Loss& loss = {});

  Summary optimize(const Options& options);
  /// Replaces the corners by the same ones, linearised at another point.
  void setCorners(const CondensedCorners& corners);
  /// Returns values and standard deviations. These stay unknown if the data leave a direction open; `undetermined` then
  /// says why.
  StreamResult result(const Summary& summary);
  /// Returns the IMUs with the current values.
  std::vector<StartedImu> started() const;
  /// Returns the IMUs with the current values and, unless the caller gave their noise, with the densities of white noise
  /// that the residuals suggest.
  std::vector<StartedImu> restarted() const;
  /// Returns, for each IMU, the pairs of images between which its readings contradict the images: those with a residual 10
  /// times as long as in the median, and as the noise predicts. Returns none if they are more than a tenth.
  std::vector<std::vector<GrossReadings>> grossReadings() const;
  /// Returns how far the poses are from where the corners of their images alone would put them, relative to what the
  /// stated noise of the corners explains: 1 if errors of corners are independent, more if corners of an image share
  /// errors.
  double imageRatio() const;
  /// Fits all values again, now with the size of the board, and returns it. Corners fit any size; the readings tell it,
  /// because gravity is known. Throws slom::Error if the data leave something open.
  BoardScale boardScale(const Options& options);
  /// Makes the size of the board a variable.
  void freeBoardScale() { est_.optimizeRV(board_scale_, true); }
  /// Returns the poses and clocks of the IMUs, with stated standard deviations alone. Throws slom::Error if the data
  /// leave something open.
  std::vector<ImuStreamResult> posesOfImus() const;
  /// Returns these, with the residuals relative to what the noise predicts. Throws likewise.
  std::vector<ImuStreamResult> posesAndRatios() const;
  /// Returns whether an error of the axes of an IMU is more than so many standard deviations, stated and clustered.
  /// Clusters errors that are so by the stated ones, because clustering takes long. Throws likewise.
  bool hasErrorOfAxes(std::size_t imu, double deviations) const;
  mtk::S2<> up() const { return *up_; }
  CamerasAt cameras() const;

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
    AxesVariables axes;
    std::vector<BiasJump> jumps;
    std::vector<VarID<vec3>> velocities;                 ///< by image
    std::vector<VarID<vec3>> gyro_biases, force_biases;  ///< by interval
    std::vector<Interval> intervals;
  };
  /// Residuals of an IMU divided by what its noise predicts, as root mean square, without what the fit absorbs.
  struct Ratios {
    double gyro = unknown, force = unknown;
  };

  void insertCameras(const Dataset& data, const CamerasAt& cameras);
  void insert(const StartedImu& started);
  /// Returns the current values of the axes, with the means of the biases.
  static ImuModel<> modelOf(const Imu& imu);
  void insertIntervals(Imu& imu, const StartedImu& started);
  void insertWalk(Imu& imu, const ImuNoise& noise);
  Ratios ratiosOf(const Imu& imu) const;
  /// Returns the time between the middles of interval k - 1 and interval k [s].
  double timeBetween(const Imu& imu, std::size_t k) const;
  std::pair<double, double> expectedSquares(const Imu& imu) const;
  ImuStreamResult resultOf(const Imu& imu) const;
  /// Returns the biases of a sensor before its first jump: that of all intervals if there is none.
  std::vector<VarID<vec3>> biasesBeforeJumps(const Imu& imu, bool is_gyro) const;
  void addStandardDeviations(StreamResult& result);
  Clustered byBlocks() const;
  void addClustered(StreamResult& result);

  const Settings& settings_;
  const std::vector<RigAtImage>& images_;
  double gravity_;
  Loss loss_;
  Estimator est_;
  std::vector<VarID<Lens>> lenses_;
  std::vector<VarID<SE3>> left2camera_;   ///< the first is no variable
  std::map<int, VarID<SE3>> left2world_;  ///< by image
  std::size_t corners_ = 0;
  /// The corners of an image, as a measurement: GaussianPrior(variables, R, b).
  struct Seen {
    std::vector<AnyVarID> variables;
    Eigen::MatrixXd R;  ///< in standard deviations
    AnyMeasID id;
  };
  std::map<int, Seen> seen_;  ///< by image
  VarID<mtk::S2<>> up_;
  VarID<mtk::Scalar<>> board_scale_;  ///< held at 1, except by boardScale
  std::vector<Imu> imus_;
};

}  // namespace slom::calibration
