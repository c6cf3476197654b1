#include "calibration/quality/uncertainty/information.hpp"

#include <algorithm>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibration/cross_matrix.hpp"
#include "calibration/models/definition.hpp"
#include "calibration/symmetric.hpp"

namespace slom::calibration {
namespace {

void addColumns(SharedColumns& columns, const std::string& name, bool is_free) {
  if (is_free) columns.free.push_back(columns.size);
  columns.names.push_back(name);
  ++columns.size;
}

/// Returns the columns. Fixed parameters and those at a bound have the standard deviation 0.
SharedColumns columnsOf(const Result& result) {
  SharedColumns columns;
  const std::string& reference = result.cameras.front().name;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const CameraResult& camera = result.cameras[c];
    columns.lens.push_back(columns.size);
    for (const int i : Model(camera.model).definition().held_near_zero)
      columns.held_near_zero.push_back(columns.size + i);
    for (const Parameter& p : camera.parameters) addColumns(columns, camera.name + "." + p.name, p.std > 0);
    columns.readout.push_back(camera.readout ? columns.size : -1);
    if (camera.readout) addColumns(columns, camera.name + ".readout", true);
    columns.of_camera.push_back(columns.size - columns.lens.back());
    columns.pose.push_back(c == 0 ? -1 : columns.size);
    if (c == 0) continue;
    const std::string pose = reference + "2" + camera.name;
    for (const char axis : {'x', 'y', 'z'}) addColumns(columns, pose + ".translation." + axis, true);
    for (const char axis : {'x', 'y', 'z'}) addColumns(columns, pose + ".rotation." + axis, true);
  }
  if (!result.imu) return columns;
  columns.imu = columns.size;
  for (const char axis : {'x', 'y', 'z'}) addColumns(columns, std::string("imu.rotation.") + axis, true);
  for (const char axis : {'x', 'y', 'z'})
    addColumns(columns, std::string("imu.acc_bias.") + axis, !result.imu->acc_bias_is_fixed);
  addColumns(columns, "imu.gravity", !result.imu->gravity_is_fixed);
  return columns;
}

/// Returns J^T J of the corners that camera c sees, with J by byCamera() and by left2camera.
Eigen::MatrixXd squareOf(const FittedRig& rig, std::size_t c, const Observation& observation) {
  const std::vector<Corner>& corners = observation.corners[c];
  const SeenBoard board = rig.seenBoard(c, observation.left2world);
  const int n = rig.columns.of_camera[c];
  Eigen::MatrixXd transposed(n + 6, 2 * Eigen::Index(corners.size()));
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const double weight = 1 / (rig.sigma_px * corners[k].sigma);
    const SeenBoard::Rows rows = board.rowsOf(corners[k].world);
    auto columns = transposed.middleCols<2>(2 * Eigen::Index(k));
    columns.topRows(n) = weight * byCamera(rig.columns, c, rows, corners[k]).transpose();
    columns.bottomRows<6>() = weight * rows.byLeft2Camera().transpose();
  }
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(n + 6, n + 6);
  square.selfadjointView<Eigen::Lower>().rankUpdate(transposed);
  square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
  return square;
}

/// Adds the information of the corners that camera c sees to the lower triangle of H. The derivative of a pixel by
/// left2world is that by left2camera, times `pose`.
void addCorners(const FittedRig& rig, std::size_t c, const Observation& observation, Eigen::MatrixXd& H) {
  const Eigen::Matrix3d world2left = observation.left2world.orient.toRotationMatrix().transpose();
  Matrix6 pose = Matrix6::Zero();
  pose.topLeftCorner<3, 3>() = -(rig.left2camera[c].orient.toRotationMatrix() * world2left);
  pose.bottomRightCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  const Eigen::MatrixXd square = squareOf(rig, c, observation);
  const int n = rig.columns.of_camera[c], lens = rig.columns.lens[c], left2camera = rig.columns.pose[c];
  const Matrix6 by_pose = pose.transpose() * square.bottomRightCorner<6, 6>();
  H.block(lens, lens, n, n) += square.topLeftCorner(n, n);
  H.bottomRows<6>().middleCols(lens, n) += pose.transpose().lazyProduct(square.bottomRows<6>().leftCols(n));
  H.bottomRightCorner<6, 6>() += by_pose * pose;
  if (c == 0) return;
  H.block(left2camera, lens, 6, n) += square.bottomRows<6>().leftCols(n);
  H.block<6, 6>(left2camera, left2camera) += square.bottomRightCorner<6, 6>();
  H.bottomRows<6>().middleCols<6>(left2camera) += by_pose;
}

/// Adds the information of a reading.
void addReading(const FittedRig& rig, const Observation& observation, Eigen::MatrixXd& H) {
  const auto [by_imu, by_pose] = differentiateReading(rig, observation);
  const double weight = 1 / (rig.sigma_acc * rig.sigma_acc);
  H.block<7, 7>(rig.columns.imu, rig.columns.imu) += weight * by_imu.transpose() * by_imu;
  H.bottomRows<6>().middleCols<7>(rig.columns.imu) += weight * by_pose.transpose() * by_imu;
  H.bottomRightCorner<6, 6>() += weight * by_pose.transpose() * by_pose;
}

/// Adds, to the lower triangle of H, the derivatives by the unknowns of the board for the corners that camera c sees.
/// In H, these unknowns follow the shared parameters.
void addBoard(const FittedRig& rig, std::size_t c, const Observation& observation, Eigen::MatrixXd& H) {
  const SeenBoard board = rig.seenBoard(c, observation.left2world);
  const int n = rig.columns.of_camera[c], left2camera = rig.columns.pose[c];
  for (const Corner& corner : observation.corners[c]) {
    const double sigma = rig.sigma_px * corner.sigma;
    const SeenBoard::Rows rows = board.rowsOf(corner.world);
    const auto [first, map] = rig.board->of(corner.world);
    const Eigen::Matrix<double, 2, 3> by_board = rows.by_point * *map, weighted = by_board / (sigma * sigma);
    const Eigen::Index row = rig.columns.size + first;
    H.block(row, rig.columns.lens[c], 3, n).noalias() +=
        weighted.transpose().lazyProduct(byCamera(rig.columns, c, rows, corner));
    if (c > 0) H.block<3, 6>(row, left2camera).noalias() += weighted.transpose() * rows.byLeft2Camera();
    H.block<3, 3>(row, row).noalias() += weighted.transpose() * by_board;
    H.bottomRows<6>().middleCols<3>(row).noalias() += rows.byLeft2World().transpose() * weighted;
  }
}

/// Adds up H of one image. Returns the part of its pose block that comes from corners.
Matrix6 addEquations(const FittedRig& rig, const Observation& observation, Eigen::MatrixXd& H) {
  for (std::size_t c = 0; c < observation.corners.size(); ++c) {
    if (!observation.corners[c].empty()) addCorners(rig, c, observation, H);
  }
  const Matrix6 from_corners = H.bottomRightCorner<6, 6>();
  if (observation.acc) addReading(rig, observation, H);
  return from_corners;
}

}  // namespace

ByCamera byCamera(const SharedColumns& columns, std::size_t camera, const SeenBoard::Rows& rows,
                  const Corner& corner) {
  ByCamera by_camera(2, columns.of_camera[camera]);
  by_camera.leftCols(rows.seen.by_parameters.cols()) = rows.seen.by_parameters;
  if (columns.readout[camera] >= 0) by_camera.rightCols<1>() = corner.by_readout;
  return by_camera;
}

void setByShared(const SharedColumns& columns, std::size_t camera, const SeenBoard::Rows& rows,
                 const Corner& corner, const Eigen::Matrix<double, 6, Eigen::Dynamic>& pose_by_shared,
                 Eigen::Matrix<double, Eigen::Dynamic, 2>& by_shared) {
  by_shared.noalias() = -pose_by_shared.transpose() * rows.byLeft2World().transpose();
  by_shared.middleRows(columns.lens[camera], columns.of_camera[camera]) +=
      byCamera(columns, camera, rows, corner).transpose();
  if (camera > 0) by_shared.middleRows<6>(columns.pose[camera]) += rows.byLeft2Camera().transpose();
}

BoardColumns::BoardColumns(const FittedBoard& board)
    : basis_(board.shape,
             [&] {
               std::vector<Corner> points;
               for (const MovedCorner& corner : board.corners)
                 points.push_back({corner.number, corner.world, {}});
               return points;
             }()),
      sigma_(board.sigma) {
  for (const MovedCorner& corner : board.corners) {
    const vec3 at(corner.world + corner.displacement);
    fitted_.emplace(keyOf(at), basis_.find(corner.world));
  }
}

std::pair<int, const Eigen::Matrix3d*> BoardColumns::of(const vec3& world) const {
  const int point = fitted_.at(keyOf(world));
  return {3 * basis_.block(point), &basis_.map(point)};
}

FittedRig::FittedRig(const Result& result)
    : imu(result.imu),
      sigma_px(result.sigma_px),
      sigma_acc(result.sigma_acc),
      sigma_denominator(result.sigma_denominator),
      columns(columnsOf(result)) {
  if (result.board) board.emplace(*result.board);
  for (const CameraResult& camera : result.cameras) {
    lenses.push_back(lensOf(camera));
    left2camera.push_back(camera.left2camera);
  }
  for (const ImageResult& image : result.images) left2world[image.image] = image.left2world;
}

ReadingJacobian differentiateReading(const FittedRig& rig, const Observation& observation) {
  const Eigen::Matrix3d left2world = observation.left2world.orient.toRotationMatrix();
  const Eigen::Matrix3d imu2left = rig.imu->left2imu.toRotationMatrix().transpose();
  const Eigen::Vector3d in_left = imu2left * (*observation.acc - rig.imu->acc_bias);
  ReadingJacobian J;
  J.by_imu << left2world * crossMatrix(in_left), -left2world * imu2left, Eigen::Vector3d(0, 0, -1);
  J.by_pose << Eigen::Matrix3d::Zero(), -left2world * crossMatrix(in_left);
  return J;
}

namespace {

ImageEquations equationsFor(const FittedRig& rig, const Observation& observation, int of_board) {
  const int n = rig.columns.size + of_board;
  ImageEquations all{Eigen::MatrixXd::Zero(n + 6, n + 6), {}, {}};
  addEquations(rig, observation, all.H);
  for (std::size_t c = 0; of_board > 0 && c < observation.corners.size(); ++c)
    addBoard(rig, c, observation, all.H);
  const Eigen::LDLT<Matrix6> pose(all.H.bottomRightCorner<6, 6>());
  all.pose_by_shared = pose.solve(all.H.bottomRows<6>().leftCols(n));
  all.pose_inverse = pose.solve(Matrix6::Identity());
  return all;
}

}  // namespace

ImageEquations equationsOf(const FittedRig& rig, const Observation& observation) {
  return equationsFor(rig, observation, 0);
}

ImageEquations equationsWithBoard(const FittedRig& rig, const Observation& observation) {
  return equationsFor(rig, observation, rig.board ? rig.board->unknowns() : 0);
}

Information::Information(const SharedColumns& columns) : free_(columns.free), all_(columns.size) {
  const auto n = Eigen::Index(free_.size());
  shared_.setZero(n, n);
  motion_shared_.setZero(6, n);
}

void Information::add(const Information& images) {
  shared_ += images.shared_;
  motion_shared_ += images.motion_shared_;
  motion_ += images.motion_;
  noise_ += images.noise_;
}

void Information::setSum(const Information& a, const Information& b) {
  shared_ = a.shared_ + b.shared_;
  motion_shared_ = a.motion_shared_ + b.motion_shared_;
  motion_ = a.motion_ + b.motion_;
  noise_ = a.noise_ + b.noise_;
}

void Information::addPrior(const FittedRig& rig) {
  if (!rig.sigma_denominator) return;
  for (const int column : rig.columns.held_near_zero) {
    const auto at = std::find(free_.begin(), free_.end(), column);
    if (at == free_.end()) continue;
    const auto k = Eigen::Index(at - free_.begin());
    shared_(k, k) += 1 / (*rig.sigma_denominator * *rig.sigma_denominator);
  }
}

Eigen::MatrixXd Information::covariance() const { return Posterior(*this).covarianceOfShared(); }

Information informationOf(const FittedRig& rig, const Observation& observation) {
  const int n = rig.columns.size;
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n + 6, n + 6);
  const Matrix6 from_corners = addEquations(rig, observation, H);
  const Eigen::LDLT<Matrix6> pose(H.bottomRightCorner<6, 6>());
  Matrix6 motion = Matrix6::Zero();  // P
  motion.topLeftCorner<3, 3>() = -observation.left2world.orient.toRotationMatrix();
  motion.bottomRightCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  const Matrix6 from_motion = motion.transpose() * from_corners;

  Information share(rig.columns);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> pose_shared = H.bottomRows<6>()(Eigen::all, share.free_);
  const Eigen::Matrix<double, 6, Eigen::Dynamic> solved = pose.solve(pose_shared);
  share.shared_ = H(share.free_, share.free_);  // 0 above the diagonal, which is not read
  share.shared_.noalias() -= pose_shared.transpose() * solved;
  share.motion_shared_.noalias() = from_motion * solved;
  share.motion_ = from_motion * motion;
  share.noise_ = from_motion * pose.solve(from_motion.transpose());
  return share;
}

Posterior::Posterior(const Information& information)
    : free_(information.free_),
      all_(information.all_),
      scale_(information.shared_.diagonal().cwiseSqrt().cwiseInverse()),
      factor_(scaledOnBothSides(information.shared_, scale_)) {
  const Matrix6 inverse = information.motion_.ldlt().solve(Matrix6::Identity());
  motion_by_shared_ = inverse.lazyProduct(information.motion_shared_);
  const Matrix6 L = information.noise_.llt().matrixL();
  noise_root_ = L.transpose() * inverse;
}

Posterior::Posterior(const Information& information, const Eigen::MatrixXd& covariance)
    : Posterior(information) {
  // In units of the stated deviations, so that the eigenvalues keep their digits.
  const Eigen::MatrixXd own = covariance(free_, free_);
  const Eigen::VectorXd scale = own.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0 ? 1 / s : 0.0; });
  const SymmetricEigen eigen = eigenOf(scaledOnBothSides(own, inverse));
  root_ =
      scale.asDiagonal() * eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
}

Eigen::MatrixXd Posterior::whitened(const Eigen::MatrixXd& by_shared,
                                    const Eigen::MatrixXd& by_motion) const {
  const auto n = Eigen::Index(free_.size());
  Eigen::MatrixXd w(n + 6, by_motion.rows());
  auto shared = w.topRows(n);
  shared.noalias() = motion_by_shared_.transpose() * by_motion.transpose();
  for (Eigen::Index i = 0; i < n; ++i) shared.row(i) += by_shared.col(free_[std::size_t(i)]).transpose();
  if (root_.size() > 0) {
    shared = (root_.transpose() * shared).eval();
  } else {
    shared = scale_.asDiagonal() * shared;
    factor_.matrixL().solveInPlace(shared);
  }
  w.bottomRows<6>().noalias() = noise_root_ * by_motion.transpose();
  return w;
}

Eigen::VectorXd Posterior::solve(const Eigen::VectorXd& by_free) const {
  return scale_.cwiseProduct(factor_.solve(scale_.cwiseProduct(by_free)));
}

Eigen::MatrixXd Posterior::covarianceOfShared() const {
  const auto n = Eigen::Index(free_.size());
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(all_, all_);
  if (root_.size() > 0) {
    C(free_, free_) = root_ * root_.transpose();
    return C;
  }
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  C(free_, free_) = scaledOnBothSides(factor_.solve(identity), scale_);
  return C;
}

std::map<int, Observation> observationsOf(const Dataset& data, const FittedRig& rig) {
  std::map<int, Observation> observations;
  for (const auto& [image, pose] : rig.left2world) {
    Observation& observation = observations[image];
    observation.left2world = pose;
    for (const CameraData& camera : data.cameras) {
      const View* const view = camera.find(image);
      observation.corners.push_back(view ? view->corners : std::vector<Corner>());
    }
  }
  if (!data.imu || !rig.imu) return observations;
  for (const ImuReading& reading : data.imu->readings) observations.at(reading.image).acc = reading.acc;
  return observations;
}

}  // namespace slom::calibration
