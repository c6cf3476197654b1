// The full problem: intrinsics of all cameras, camera to camera, the rig's pose in each image, and the IMU.
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
  /// `data` and `settings` must live as long as the problem. `imu` where data has one; `board`: of an earlier fit, where there is one.
  RigProblem(const Dataset& data, const Settings& settings, const std::vector<Lens>& cameras,
             const RigStart& rig, const std::optional<ImuStart>& imu, const FittedBoard* board = nullptr);
  RigProblem(const RigProblem&) = delete;
  RigProblem& operator=(const RigProblem&) = delete;

  Summary optimize(const Options& options);
  Result result(const Summary& summary);
  /// As they are fitted now.
  std::vector<Lens> cameras() const;
  RigStart rig() const;
  std::optional<FittedBoard> board() const;
  /// The RMS distance of all projected corners from their measured pixels [px].
  double rmsOfAll() const;

 private:
  void insertCorners();
  void insertCornersOfShape();
  void insertImu(const ImuStart& start);
  vec2 residual(std::size_t camera, int image, const Corner& corner) const;
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
  std::vector<VarID<SE3>> left2camera_;  ///< the first, the identity, is in no measurement and not a variable
  std::map<int, VarID<SE3>> left2world_;
  VarID<SO3> left2imu_;
  VarID<vec3> acc_bias_;
  VarID<mtk::Scalar<>> gravity_;
  std::optional<BoardUnknowns> board_;  ///< where its shape is estimated
};

/// The fault alone, without the library's id and without the remedy, which is for programmers.
std::string sentenceOf(const slom::Error& error);

}  // namespace slom::calibration
