#include "calibration/fit/rig.hpp"

#include <cmath>

#include "calibration/fit/as_fitted.hpp"
#include "calibration/fit/board_corners.hpp"
#include "calibration/fit/imu_precision.hpp"
#include "calibration/fit/lens_constraints.hpp"
#include "calibration/fit/measurements.hpp"
#include "calibration/fit/single_camera.hpp"
#include "calibration/limits.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/rotation_vector.hpp"

namespace slom::calibration {

std::string sentenceOf(const slom::Error& error) {
  const bool names_unknown = error.id() == "slom.rank-deficient" && !error.subject().empty();
  return names_unknown ? "the measurements do not determine " + error.subject() : std::string(error.fault());
}

Options optionsOf(const Settings& settings) {
  Options options;
  options.max_iterations = settings.max_iterations;
  options.deviation_tolerance = enough_deviations;
  applyLimits(settings.limits, options);
  return options;
}

RigProblem::RigProblem(const Dataset& data, const Settings& settings, const std::vector<Lens>& cameras,
                       const RigStart& rig, const std::optional<ImuStart>& imu, const FittedBoard* board)
    : data_(data), settings_(settings) {
  const std::string reference = data.cameras.front().name;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const std::string& name = data.cameras[c].name;
    cameras_.push_back(est_.insertRV(constrained(cameras[c], name, settings), true, name));
    constrain(est_, cameras_.back(), name, settings);
    if (settings.sigma_denominator) addPrior(est_, cameras_.back(), *settings.sigma_denominator);
    insertReadout(data.cameras[c]);
    left2camera_.push_back(c == 0 ? VarID<SE3>()
                                  : est_.insertRV(rig.left2camera[c], true, reference + "2" + name));
  }
  for (const auto& [image, pose] : rig.left2world) {
    left2world_.emplace(image,
                        est_.insertRV(pose, true, reference + "2world[" + std::to_string(image) + "]"));
  }
  if (settings.board_shape == BoardShape::flat) {
    insertCorners();
  } else {
    board_.emplace(est_, data, settings, board);
    insertCornersOfShape();
  }
  if (imu) insertImu(*imu);
}

Summary RigProblem::optimize(const Options& options) {
  Summary summary = board_ ? board_->optimize(options) : est_.optimize(options);
  nameLimit(settings_.limits, summary);
  return summary;
}

std::vector<Lens> RigProblem::cameras() const {
  std::vector<Lens> values;
  for (const auto& id : cameras_) values.push_back(*id);
  return values;
}

RigStart RigProblem::rig() const {
  RigStart rig;
  for (std::size_t c = 0; c < left2camera_.size(); ++c)
    rig.left2camera.push_back(c == 0 ? SE3() : *left2camera_[c]);
  for (const auto& [image, id] : left2world_) rig.left2world[image] = *id;
  return rig;
}

std::optional<FittedBoard> RigProblem::board() const {
  return board_ ? std::optional(board_->board()) : std::nullopt;
}

double RigProblem::rmsOfAll() const {
  double square = 0, corners = 0;
  for (std::size_t c = 0; c < cameras_.size(); ++c)
    square += squaredErrors(c), corners += double(data_.cameras[c].cornerCount());
  return std::sqrt(square / corners);
}

void RigProblem::insertReadout(const CameraData& camera) {
  readout_.emplace_back();
  if (settings_.rolling_shutter && moves(camera))
    readout_.back() = est_.insertRV(mtk::Scalar<>(0), true, camera.name + ".readout");
}

namespace {

/// Inserts corners as a measurement of these variables, and of the readout if there is one. Options
/// follow the variables.
template <class Corners, class... Variables>
void insert(Estimator& estimator, const Corners& corners, const std::optional<VarID<mtk::Scalar<>>>& readout,
            const Variables&... variables_and_options) {
  if (readout)
    estimator.insertMeasurement(WithReadout(corners), *readout, variables_and_options...);
  else
    estimator.insertMeasurement(corners, variables_and_options...);
}

}  // namespace

void RigProblem::insertCorners() {
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    for (const View& view : data_.cameras[c].views) {
      const auto pose = left2world_.at(view.image);
      const StandardDeviation sigma(settings_.sigma_px);
      const Group image = group("image", view.image);
      if (c == 0)
        insert(est_, ViewOfLeft(view), readout_[c], cameras_[c], pose, sigma, image);
      else
        insert(est_, ViewOfOther(view), readout_[c], cameras_[c], left2camera_[c], pose, sigma, image);
    }
  }
}

void RigProblem::insertCornersOfShape() {
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    for (const View& view : data_.cameras[c].views) {
      const auto pose = left2world_.at(view.image);
      for (const Corner& corner : view.corners) {
        const auto shape = board_->of(corner);
        const StandardDeviation sigma(settings_.sigma_px * corner.sigma);
        if (c == 0)
          insert(est_, CornerOfShapeInLeft(corner, board_->basis()), readout_[c], cameras_[c], pose, shape,
                 sigma);
        else
          insert(est_, CornerOfShapeInOther(corner, board_->basis()), readout_[c], cameras_[c],
                 left2camera_[c], pose, shape, sigma);
      }
    }
  }
}

void RigProblem::insertImu(const ImuStart& start) {
  left2imu_ = est_.insertRV(start.left2imu, true, data_.cameras.front().name + "2imu");
  acc_bias_ = est_.insertRV(start.acc_bias, !settings_.fixed.acc_bias, "acc_bias");
  gravity_ = est_.insertRV(mtk::Scalar<>(start.gravity), !settings_.fixed.gravity, "gravity");
  for (const ImuReading& reading : data_.imu->readings) {
    insertReading(est_, left2world_.at(reading.image), left2imu_, acc_bias_, gravity_, reading.acc,
                  settings_.sigma_acc);
  }
}

vec2 RigProblem::residual(std::size_t camera, int image, const Corner& corner) const {
  const SE3 left2camera = camera == 0 ? SE3() : *left2camera_[camera];
  const vec3 world = board_ ? board_->worldOf(corner) : corner.world;
  vec2 predicted = CornerInOther()(*cameras_[camera], left2camera, *left2world_.at(image), world);
  if (readout_[camera]) predicted += double(**readout_[camera]) * corner.by_readout;
  return predicted - corner.pixel;
}

double RigProblem::squaredErrors(std::size_t camera) const {
  double sum = 0;
  for (const View& view : data_.cameras[camera].views) {
    for (const Corner& corner : view.corners) sum += residual(camera, view.image, corner).squaredNorm();
  }
  return sum;
}

vec3 RigProblem::gravityResidual(const ImuReading& reading) const {
  return calibration::gravityResidual(*left2world_.at(reading.image), *left2imu_, *acc_bias_, *gravity_,
                                      reading.acc);
}

CameraResult RigProblem::cameraResult(std::size_t index) const {
  const CameraData& data = data_.cameras[index];
  const Lens& lens = *cameras_[index];
  CameraResult result;
  result.name = data.name;
  result.file = data.file;
  result.image_size = data.image_size;
  result.unused = data.unused;
  result.copies = data.copies;
  result.excluded = data.excluded;
  result.board_symmetry = data.board_symmetry;
  result.model = lens.model().name();
  for (int i = 0; i < lens.parameters(); ++i)
    result.parameters.push_back({lens.componentNames()[std::size_t(i)], lens[i]});
  const ModelDefinition& model = lens.model().definition();
  result.camera_matrix = model.camera_matrix(lens.numbers());
  result.distortion = model.distortion(lens.numbers());
  if (index > 0) result.left2camera = *left2camera_[index];
  if (readout_[index]) result.readout = Readout{**readout_[index]};
  result.images = data.views.size();
  result.corners = data.cornerCount();
  result.rms_px = std::sqrt(squaredErrors(index) / double(result.corners));
  return result;
}

ImuResult RigProblem::imuResult() const {
  ImuResult imu;
  imu.file = data_.imu->file;
  imu.readings = data_.imu->readings.size();
  imu.left2imu = *left2imu_;
  imu.acc_bias = *acc_bias_;
  imu.gravity = *gravity_;
  imu.acc_bias_is_fixed = settings_.fixed.acc_bias.has_value();
  imu.gravity_is_fixed = settings_.fixed.gravity.has_value();
  double square = 0;
  for (const ImuReading& reading : data_.imu->readings) square += gravityResidual(reading).squaredNorm();
  imu.rms_acc = std::sqrt(square / double(imu.readings));
  return imu;
}

ImageResult RigProblem::imageResult(int image) const {
  ImageResult result;
  result.image = image;
  result.left2world = *left2world_.at(image);
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    const View* view = data_.cameras[c].find(image);
    result.rms_px.emplace_back();
    if (!view) continue;
    double square = 0, weighted = 0;
    for (const Corner& corner : view->corners) {
      const double error = residual(c, image, corner).norm();
      square += error * error;
      weighted += error * error / (corner.sigma * corner.sigma);
      if (error > result.worst_corner.error_px) {
        result.worst_corner = {c, corner.number, corner.line, error, data_.cameras[c].place(*view, corner)};
      }
    }
    result.rms_px.back() = std::sqrt(square / double(view->corners.size()));
    result.chi2 += weighted / (settings_.sigma_px * settings_.sigma_px);
    result.measurements += 2 * int(view->corners.size());
  }
  if (!data_.imu) return result;
  for (const ImuReading& reading : data_.imu->readings) {
    if (reading.image != image) continue;
    result.acc_error = gravityResidual(reading).norm();
    result.chi2 += std::pow(*result.acc_error / settings_.sigma_acc, 2);
    result.measurements += 3;
  }
  return result;
}

namespace {

void copyStandardDeviations(const Result& from, Result& to) {
  for (std::size_t c = 0; c < to.cameras.size(); ++c) {
    const CameraResult& source = from.cameras[c];
    CameraResult& camera = to.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i)
      camera.parameters[i].std = source.parameters[i].std;
    if (camera.readout && source.readout) camera.readout->std = source.readout->std;
    camera.translation_std = source.translation_std;
    camera.rotation_std = source.rotation_std;
    camera.rotation_vector_std = source.rotation_vector_std;
  }
  for (std::size_t i = 0; to.board && from.board && i < to.board->corners.size(); ++i)
    to.board->corners[i].std = from.board->corners[i].std;
}

}  // namespace

Result RigProblem::result(const Summary& summary, const Result* similar) {
  Result result;
  result.converged = summary.converged;
  result.stop_reason = toString(summary.stop_reason);
  result.message = summary.message;
  result.iterations = summary.iterations;
  result.measurements = summary.measurements;
  result.unknowns = summary.unknowns;
  result.redundancy = summary.redundancy;
  result.rss = summary.final_rss;
  result.active_bounds = summary.active_bounds;
  result.sigma_denominator = settings_.sigma_denominator;
  result.sigma_px = settings_.sigma_px;
  result.sigma_acc = settings_.sigma_acc;
  for (std::size_t c = 0; c < cameras_.size(); ++c) result.cameras.push_back(cameraResult(c));
  if (data_.imu) result.imu = imuResult();
  result.board = board();
  for (const int image : data_.images()) result.images.push_back(imageResult(image));
  if (similar) {
    copyStandardDeviations(*similar, result);
    return result;
  }
  try {
    addStandardDeviations(result);
  } catch (const slom::Error& error) {
    result.declareUndetermined(sentenceOf(error));
  }
  return result;
}

void RigProblem::addStandardDeviations(Result& result) {
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    CameraResult& camera = result.cameras[c];
    const Eigen::VectorXd std = est_.standardDeviation(cameras_[c]);
    for (std::size_t i = 0; i < camera.parameters.size(); ++i)
      camera.parameters[i].std = std[Eigen::Index(i)];
    if (camera.readout) camera.readout->std = est_.standardDeviation(*readout_[c])[0];
    const Eigen::MatrixXd pose = c == 0 ? Eigen::MatrixXd::Zero(6, 6) : est_.covariance(left2camera_[c]);
    camera.translation_std = pose.diagonal().head<3>().cwiseSqrt();
    camera.rotation_std = pose.diagonal().tail<3>().cwiseSqrt();
    camera.rotation_vector_std = rotationVectorStd(camera.left2camera.orient, pose.bottomRightCorner<3, 3>());
  }
  if (result.imu) addImuStandardDeviations(*result.imu);
  if (result.board) board_->addStandardDeviations(*result.board);
}

void RigProblem::addImuStandardDeviations(ImuResult& imu) {
  Eigen::MatrixXd covariance(7, 7);  // rotation, acc_bias, gravity
  covariance << est_.covariance(left2imu_), est_.covariance(left2imu_, acc_bias_),
      est_.covariance(left2imu_, gravity_), est_.covariance(acc_bias_, left2imu_), est_.covariance(acc_bias_),
      est_.covariance(acc_bias_, gravity_), est_.covariance(gravity_, left2imu_),
      est_.covariance(gravity_, acc_bias_), est_.covariance(gravity_);
  imu.rotation_std = covariance.diagonal().head<3>().cwiseSqrt();
  imu.rotation_vector_std = rotationVectorStd(imu.left2imu, covariance.topLeftCorner<3, 3>());
  imu.acc_bias_std = covariance.diagonal().segment<3>(3).cwiseSqrt();
  imu.gravity_std = std::sqrt(covariance(6, 6));
  imu.precision = precisionOf(covariance);
  imu.if_acc_bias_fixed = precisionOf(imu.acc_bias_is_fixed ? covariance : whenKnown(covariance, 3, 3));
  imu.if_gravity_fixed = precisionOf(imu.gravity_is_fixed ? covariance : whenKnown(covariance, 6, 1));
}

}  // namespace slom::calibration
