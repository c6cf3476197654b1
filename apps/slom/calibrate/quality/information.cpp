#include "calibrate/quality/information.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "calibrate/cross_matrix.hpp"

namespace slom::app::calib {
namespace {

void addColumns(SharedColumns& columns, const std::string& name, bool is_free) {
  if (is_free) columns.free.push_back(columns.size);
  columns.names.push_back(name);
  ++columns.size;
}

/// Fixed parameters and those at a bound have the standard deviation 0.
SharedColumns columnsOf(const Result& result) {
  SharedColumns columns;
  const std::string& reference = result.cameras.front().name;
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    const CameraResult& camera = result.cameras[c];
    columns.lens.push_back(columns.size);
    for (const Parameter& p : camera.parameters) addColumns(columns, camera.name + "." + p.name, p.std > 0);
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

/// J^T J of one image: the shared parameters, then the pose.
class ArrowBlock {
 public:
  explicit ArrowBlock(int shared) : H(Eigen::MatrixXd::Zero(shared + 6, shared + 6)) {}

  /// Rows of a Jacobian that have entries in these ranges of columns alone.
  struct Part {
    int first;
    Eigen::MatrixXd J;
  };
  void add(const std::vector<Part>& parts) {
    for (const Part& a : parts) {
      for (const Part& b : parts)
        H.block(a.first, b.first, a.J.cols(), b.J.cols()).noalias() += a.J.transpose() * b.J;
    }
  }

  Eigen::MatrixXd H;
};

void addCorners(const FittedRig& rig, std::size_t c, const Sight& sight, ArrowBlock& block) {
  const SharedColumns& columns = rig.columns;
  const Eigen::Matrix3d world2left = sight.left2world.orient.toRotationMatrix().transpose();
  const Eigen::Matrix3d left2camera = rig.left2camera[c].orient.toRotationMatrix();
  const SE3 to_left = sight.left2world.inverse();
  // All corners of the camera as the rows of one Jacobian: lens, camera to camera, pose of the image.
  const Eigen::Index n = rig.lenses[c]->parameters(), rows = 2 * Eigen::Index(sight.points[c].size());
  Eigen::MatrixXd lens(rows, n), pose(rows, 6), image(rows, 6);
  for (std::size_t k = 0; k < sight.points[c].size(); ++k) {
    const vec3 in_left = to_left * sight.points[c][k];
    const Lens::Projection q = rig.lenses[c]->differentiate(rig.left2camera[c] * in_left);
    const Eigen::Index row = 2 * Eigen::Index(k);
    const Eigen::Matrix<double, 2, 3> by_camera = q.by_point / rig.sigma_px,
                                      by_left = by_camera * left2camera;
    lens.middleRows<2>(row) = q.by_parameters / rig.sigma_px;
    pose.middleRows<2>(row) << by_camera, -by_left * crossMatrix(in_left);
    image.middleRows<2>(row) << -by_left * world2left, by_left * crossMatrix(in_left);
  }
  if (c == 0) {
    block.add({{columns.lens[c], lens}, {columns.size, image}});
  } else {
    block.add({{columns.lens[c], lens}, {columns.pose[c], pose}, {columns.size, image}});
  }
}

/// residual = R(left2world) left2imu^-1 (acc - bias) - gravity e_z
void addReading(const FittedRig& rig, const Sight& sight, ArrowBlock& block) {
  const Eigen::Matrix3d left2world = sight.left2world.orient.toRotationMatrix();
  const Eigen::Matrix3d imu2left = rig.imu->left2imu.toRotationMatrix().transpose();
  const Eigen::Vector3d in_left = imu2left * (*sight.acc - rig.imu->acc_bias);
  Eigen::MatrixXd imu = Eigen::MatrixXd::Zero(3, 7), pose = Eigen::MatrixXd::Zero(3, 6);
  imu << left2world * crossMatrix(in_left), -left2world * imu2left, Eigen::Vector3d(0, 0, -1);
  pose.rightCols<3>() = -left2world * crossMatrix(in_left);
  block.add({{rig.columns.imu, imu / rig.sigma_acc}, {rig.columns.size, pose / rig.sigma_acc}});
}

}  // namespace

FittedRig::FittedRig(const Result& result)
    : imu(result.imu), sigma_px(result.sigma_px), sigma_acc(result.sigma_acc), columns(columnsOf(result)) {
  for (const CameraResult& camera : result.cameras) {
    lenses.push_back(makeLens(camera));
    left2camera.push_back(camera.left2camera);
  }
  for (const ImageResult& image : result.images) left2world[image.image] = image.left2world;
}

ImageInformation informationOf(const FittedRig& rig, const Sight& sight) {
  const int n = rig.columns.size;
  ArrowBlock block(n);
  for (std::size_t c = 0; c < sight.points.size(); ++c) {
    if (!sight.points[c].empty()) addCorners(rig, c, sight, block);
  }
  ImageInformation result;
  result.pose_from_corners = block.H.bottomRightCorner<6, 6>();
  if (sight.acc) addReading(rig, sight, block);
  result.pose = block.H.bottomRightCorner<6, 6>();
  result.pose_shared = block.H.bottomLeftCorner(6, n);
  result.shared = block.H.topLeftCorner(n, n) -
                  result.pose_shared.transpose() * result.pose.ldlt().solve(result.pose_shared);
  result.motion.setZero();
  result.motion.topLeftCorner<3, 3>() = -sight.left2world.orient.toRotationMatrix();
  result.motion.bottomRightCorner<3, 3>() = -Eigen::Matrix3d::Identity();
  return result;
}

Information::Information(const SharedColumns& columns)
    : free_(columns.free),
      shared_(Eigen::MatrixXd::Zero(columns.size, columns.size)),
      motion_shared_(Eigen::MatrixXd::Zero(6, columns.size)) {}

void Information::add(const ImageInformation& image) {
  shared_ += image.shared;
  const Matrix6 PtH = image.motion.transpose() * image.pose_from_corners;
  const auto H_ff = image.pose.ldlt();
  motion_ += PtH * image.motion;
  noise_ += PtH * H_ff.solve(PtH.transpose());
  motion_shared_ += PtH * H_ff.solve(image.pose_shared);
}

Eigen::MatrixXd Information::covariance() const {
  // Units differ by orders of magnitude: scaled to a unit diagonal the inverse keeps its digits.
  const Eigen::MatrixXd S = shared_(free_, free_);
  const Eigen::VectorXd scale = S.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * S * scale.asDiagonal();
  const Eigen::MatrixXd inverse = scaled.llt().solve(Eigen::MatrixXd::Identity(S.rows(), S.cols()));
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(shared_.rows(), shared_.cols());
  C(free_, free_) = scale.asDiagonal() * inverse * scale.asDiagonal();
  return C;
}

Eigen::MatrixXd Information::motionByShared() const { return motion_.ldlt().solve(motion_shared_); }

Matrix6 Information::motionNoise() const {
  const auto G = motion_.ldlt();
  const Matrix6 left = G.solve(noise_);
  return G.solve(Matrix6(left.transpose()));
}

std::map<int, Sight> sightsOf(const Dataset& data, const FittedRig& rig) {
  std::map<int, Sight> sights;
  for (const auto& [image, pose] : rig.left2world) {
    Sight sight{pose, std::vector<std::vector<vec3>>(data.cameras.size()), {}};
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      const View* view = data.cameras[c].find(image);
      if (!view) continue;
      for (const Corner& corner : view->corners) sight.points[c].push_back(corner.world);
    }
    sights.emplace(image, std::move(sight));
  }
  if (!data.imu || !rig.imu) return sights;
  for (const ImuReading& reading : data.imu->readings) sights.at(reading.image).acc = reading.acc;
  return sights;
}

}  // namespace slom::app::calib
