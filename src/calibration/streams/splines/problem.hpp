// Cameras and IMUs together by a motion in continuous time: the pose of the reference camera is a spline, and each reading
// a measurement at its own time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <slom/slom.hpp>
#include <slom/trajectory.hpp>

#include "calibration/streams/problem.hpp"
#include "calibration/streams/splines/stretches.hpp"
#include "calibration/streams/splines/view_in_time.hpp"
#include "calibration/streams/splines/view_on_spline.hpp"
#include "slom/calibration/imu_stream.hpp"

namespace slom::calibration {

/// When a camera sees its corners, as a fit takes it.
struct CameraClock {
  std::int64_t epoch_ns = 0;  ///< zero of its times
  bool is_offset_estimated = false, is_line_delay_estimated = false;
};
/// The values: t_camera = t_reference + offset, each from its epoch on [s]; time between rows [s].
struct CameraTiming {
  double offset = 0, line_delay = 0;
};

/// What does not change between fits of a recording.
struct SplineRecording {
  const Dataset& data;  ///< on the fitted board
  const Settings& settings;
  const std::vector<RigAtImage>& images;
  double gravity = 0;       ///< magnitude [m/s^2]
  double knot_spacing = 0;  ///< of poses [s]
  std::vector<Stretch> stretches;
  /// By camera. Then `images` are those of the reference camera, and views are seen at times of their own. Empty: each
  /// view is seen at the time of its image.
  std::vector<CameraClock> clocks{};
};

/// Values of a fit, and the noise with which the next one begins.
struct SplineValues {
  double sigma_px = 0;
  CamerasAt cameras;
  std::vector<StartedImu> imus;
  mtk::S2<> up;
  /// Control points of an IMU's biases, by their times.
  struct Biases {
    std::function<vec3(double)> gyro, force;
  };
  /// Control points of the stretches by their times; empty: from the poses at the images.
  std::vector<std::function<SE3(double)>> poses{};
  std::vector<Biases> biases{};         ///< by IMU; empty: constant
  std::vector<CameraTiming> timings{};  ///< by camera, if the recording has clocks
};

class SplineProblem {
 public:
  /// Builds the problem and condenses the corners at the values. The recording must outlive it.
  SplineProblem(const SplineRecording& recording, const SplineValues& values);
  SplineProblem(const SplineProblem&) = delete;
  SplineProblem& operator=(const SplineProblem&) = delete;

  Summary optimize(const Options& options);
  /// Returns the present values with the noise of the problem.
  SplineValues values() const;
  /// Returns the noise that the residuals suggest: that of the corners, and of IMUs whose noise the caller has not given.
  SplineValues withEstimatedNoise() const;
  /// Returns values and standard deviations. These stay unknown if the data leave a direction open; `undetermined` then
  /// says why.
  StreamResult result(const Summary& summary);
  /// Fits all values again, now with the size of the board, as StreamProblem::boardScale does.
  BoardScale boardScale(const Options& options);
  /// Returns the data as the cameras of the recording would have seen them at the times of the reference camera's images,
  /// all rows at once. `data` has the images of the recording. Views beside all splines are left out.
  Dataset simultaneous(const Dataset& data) const;
  /// Adds doubts about clocks and shutters of the cameras that this problem holds, if a fit in which they are free moves
  /// them by 5 standard deviations or more, and by 0.2 ms or more over an image.
  void doubtHeldTimings(const Options& options, StreamResult& result) const;

 private:
  using Bias = trajectory::VectorSpline<3, 2>;
  struct Reading {
    const ImuSample* sample = nullptr;
    std::size_t stretch = 0;
    trajectory::Placed gyro, force;
  };
  /// A view on a spline: the variables that are estimated, and its derivatives by them.
  struct PlacedView {
    std::vector<AnyVarID> variables;
    std::function<Eigen::MatrixXd()> jacobian;
  };
  /// The clock and the shutter of a camera.
  struct Timing {
    VarID<mtk::Scalar<>> offset, line_delay;
  };
  /// The segment at a time, and the position of its first control point in the list of the spline.
  struct ControlRange {
    std::int64_t segment = 0;
    std::size_t first = 0;
  };
  /// Residuals divided by what their noise predicts, as root mean square, without what the fit absorbs.
  struct Ratios {
    double gyro = unknown, force = unknown;
  };
  struct Imu {
    const ImuStream* stream = nullptr;
    ImuNoise noise;
    double rate = 0;  ///< of readings [Hz]
    std::vector<BiasJump> jumps{};
    VarID<SE3> left2imu;
    VarID<mtk::Scalar<>> offset;
    AxesVariables axes;
    Bias gyro_bias, force_bias;
    std::vector<Reading> readings;
  };

  /// Returns the control points of a sensor's bias before its first jump: all if there is none.
  static std::vector<VarID<vec3>> biasesBeforeJumps(const Imu& imu, bool is_gyro);
  void insertCameras();
  void insertTimings();
  void insertStretch(const Stretch& stretch, const std::function<SE3(double)>& start);
  void insertViews();
  void insertView(std::size_t camera, const View& view, LensRows& rows);
  void insertMovingView(std::size_t camera, const View& view, LensRows& rows);
  void insertBand(std::size_t camera, const RowTime& time, const std::vector<Corner>& corners,
                  LensRows& rows);
  /// Inserts a measurement of control points, and of other variables with whether they are estimated.
  template <class Measurement, class... T>
  void place(const Measurement& measurement, std::size_t stretch, std::size_t first_control,
             const Group& time, const std::pair<VarID<T>, bool>&... others);
  void insert(const StartedImu& started);
  void insertReadings(Imu& imu);
  void insertReading(Imu& imu, std::size_t stretch, const ImuSample& sample, const Group& time);
  /// Returns the current values of the axes, with the means of the biases.
  static ImuModel<> modelOf(const Imu& imu);
  void insertWalk(const Imu& imu, const std::vector<BiasJump>& jumps);
  Group timeGroup(double time) const;
  SE3 poseAt(std::size_t image) const;
  /// Returns whether the fit has a pose for an image.
  bool hasPose(std::size_t image) const { return timings_.empty() || stretch_of_[image].has_value(); }
  /// Returns the stretch of a time, also of one shortly before or after it.
  std::optional<std::size_t> stretchAt(double time) const;
  /// Returns the time in the clock of the reference camera.
  double timeOf(std::size_t camera, const RowTime& time) const;
  /// Returns a view with its corners where the camera would see them all at a time in the clock of the reference camera.
  View movedTo(double to, std::size_t camera, View view) const;
  RowTime rowTimeOf(std::size_t camera, const View& view, double row) const;
  /// Returns the pose at a time on a stretch, of the segment nearest to it.
  SE3 poseAt(std::size_t stretch, double time) const;
  void addTimings(StreamResult& result) const;
  void eachTiming(StreamResult& result, const auto& each) const;
  /// Returns the controls around a covered time.
  template <class Segment>
  static ControlRange controlsAt(const trajectory::Spline<Segment>& spline, double time) {
    const trajectory::Knots& knots = spline.knots();
    const std::int64_t first = knots.segmentAt(spline.firstTime());
    const std::int64_t last = first + std::int64_t(spline.controls().size()) - Segment::order;
    const std::int64_t segment = std::clamp(knots.segmentAt(time), first, last);
    return {segment, std::size_t(segment - first)};
  }
  double cornersRatio() const;
  Ratios ratiosOf(const Imu& imu) const;
  /// Returns the covariances of the predictions of a reading: angular velocity and specific force.
  std::pair<Eigen::Matrix3d, Eigen::Matrix3d> predictedCovariances(const Imu& imu,
                                                                   const Reading& reading) const;
  ImuStreamResult resultOf(const Imu& imu) const;
  void addMeanResiduals(const Imu& imu, ImuStreamResult& result) const;
  void addStandardDeviations(StreamResult& result);
  Clustered byBlocks() const;
  void addClustered(StreamResult& result);
  /// Fits a copy in which all clocks and shutters of the cameras are free. Returns those that this problem holds: how far
  /// they move, with stated standard deviations. Returns none if that fit does not converge. Throws slom::Error if the
  /// data leave something open.
  std::vector<CameraStreamResult> heldTimings(const Options& options) const;

  const SplineRecording& recording_;
  const SplineValues start_;
  Estimator est_;
  VarID<mtk::S2<>> up_;
  VarID<mtk::Scalar<>> board_scale_;  ///< held at 1, except by boardScale
  std::vector<VarID<Lens>> lenses_;
  std::vector<VarID<SE3>> left2camera_;                 ///< the first is not a variable
  std::vector<RigSpline> splines_;                      ///< by stretch
  std::map<int, std::size_t> index_of_;                 ///< of images, by their numbers
  std::vector<std::optional<std::size_t>> stretch_of_;  ///< by image; nothing: a pose of its own
  std::vector<VarID<SE3>> left2world_;                  ///< by image, of those with a pose of their own
  std::vector<Timing> timings_;                         ///< by camera, if the recording has clocks
  std::vector<AnyMeasID> views_;
  std::vector<PlacedView> views_on_splines_;
  std::vector<Imu> imus_;
};

}  // namespace slom::calibration
