// The full problem: intrinsics of all cameras, poses between cameras, the rig's pose in each image, and the IMU.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <slom/slom.hpp>

#include "calibration/fit/board_unknowns.hpp"
#include "calibration/initialization/imu.hpp"
#include "calibration/initialization/rig.hpp"
#include "calibration/models/lens.hpp"
#include "slom/calibration/result.hpp"

namespace slom::calibration {

class RigProblem {
 public:
  /// Builds the problem. `data` and `settings` must outlive it. `imu`: set if the data have an IMU; `board`: from an
  /// earlier fit, if there is one.
  RigProblem(const Dataset& data, const Settings& settings, const std::vector<Lens>& cameras,
             const RigStart& rig, const std::optional<ImuStart>& imu, const FittedBoard* board = nullptr);
  RigProblem(const RigProblem&) = delete;
  RigProblem& operator=(const RigProblem&) = delete;

  Summary optimize(const Options& options);
  /// Returns the values with their standard deviations. `similar`: a result of nearly the same data, whose standard
  /// deviations are taken instead; that saves as much time as an iteration or two.
  Result result(const Summary& summary, const Result* similar = nullptr);
  /// Returns the lenses in their current state.
  std::vector<Lens> cameras() const;
  RigStart rig() const;
  std::optional<FittedBoard> board() const;
  /// Returns the RMS distance between projected and measured pixels of all corners [px].
  double rmsOfAll() const;

  /// The problem, for measurements of further sensors. Views are in groups "image".
  Estimator& estimator() { return est_; }
  const std::map<int, VarID<SE3>>& poses() const { return left2world_; }
  const std::vector<VarID<Lens>>& lenses() const { return cameras_; }
  /// Returns the poses left2camera of all cameras but the first.
  std::vector<VarID<SE3>> camerasOnRig() const { return {left2camera_.begin() + 1, left2camera_.end()}; }

 private:
  void insertReadout(const CameraData& camera);
  void insertCorners();
  void insertCornersOfShape();
  void insertImu(const ImuStart& start);
  vec2 residual(std::size_t camera, int image, const Corner& corner) const;
  double squaredErrors(std::size_t camera) const;
  CameraResult cameraResult(std::size_t index) const;
  ImuResult imuResult() const;
  ImageResult imageResult(int image) const;
  vec3 gravityResidual(const ImuReading& reading) const;
  void addStandardDeviations(Result& result);
  void addImuStandardDeviations(ImuResult& imu);

  const Dataset& data_;
  const Settings& settings_;
  Estimator est_;
  std::vector<VarID<Lens>> cameras_;
  std::vector<std::optional<VarID<mtk::Scalar<>>>>
      readout_;  ///< of cameras whose corners are known to move, if it is estimated
  std::vector<VarID<SE3>>
      left2camera_;  ///< the first is the identity: it is neither in a measurement nor a variable
  std::map<int, VarID<SE3>> left2world_;
  VarID<SO3> left2imu_;
  VarID<vec3> acc_bias_;
  VarID<mtk::Scalar<>> gravity_;
  std::optional<BoardUnknowns> board_;  ///< set if the shape is estimated
};

/// Returns the options of a fit of the rig: the limits of the settings, and enough_deviations as its tolerance.
Options optionsOf(const Settings& settings);

/// Returns the fault only. Leaves out the library's id and its remedy, which addresses programmers.
std::string sentenceOf(const slom::Error& error);

}  // namespace slom::calibration
