#include "data.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace {

/// Returns the numbers of a CSV file, without its header line.
std::vector<std::vector<double>> readCsv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<double> row;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

std::vector<Image> readImages(const std::string& folder) {
  std::map<std::pair<int, int>, vec2> right;  // by image and corner
  for (const auto& row : readCsv(folder + "/right_corners.csv")) right[{int(row[0]), int(row[1])}] = vec2(row[5], row[6]);
  std::map<int, Image> images;
  for (const auto& row : readCsv(folder + "/left_corners.csv")) {
    const auto found = right.find({int(row[0]), int(row[1])});
    if (found == right.end()) continue;
    images[int(row[0])].corners.push_back({vec3(row[2], row[3], row[4]), vec2(row[5], row[6]), found->second});
  }
  for (const auto& row : readCsv(folder + "/imu.csv")) {
    const auto found = images.find(int(row[0]));
    if (found == images.end() || row[4] == 0) continue;
    found->second.has_acc = true;
    found->second.acc = vec3(row[1], row[2], row[3]);
  }
  std::vector<Image> result;
  for (const auto& [number, image] : images) result.push_back(image);
  return result;
}

Camera guessCamera() {
  Camera camera;
  camera.head<4>() << 1000, 1000, 640, 480;
  return camera;
}

SE3 guessPose(const Image& image, bool right_camera) {
  const Camera camera = guessCamera();
  Eigen::MatrixXd A(2 * image.corners.size(), 9);
  for (std::size_t i = 0; i < image.corners.size(); ++i) {
    const StereoCorner& corner = image.corners[i];
    const vec2 p = right_camera ? corner.right : corner.left;
    const Eigen::RowVector3d w(corner.world[0], corner.world[1], 1), zero(0, 0, 0);
    const double x = (p[0] - camera[2]) / camera[0], y = (p[1] - camera[3]) / camera[1];
    A.row(2 * i) << w, zero, -x * w;
    A.row(2 * i + 1) << zero, w, -y * w;
  }
  const Eigen::VectorXd h = A.jacobiSvd(Eigen::ComputeFullV).matrixV().col(8);
  Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(h.data());
  H /= (H(2, 2) < 0 ? -1 : 1) * H.col(0).norm();  // the board is in front of the camera
  Eigen::Matrix3d R;
  R << H.col(0), H.col(1), H.col(0).cross(H.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const SE3 world2camera(SO3(svd.matrixU() * svd.matrixV().transpose()), vec3(H.col(2)));
  return world2camera.inverse();
}

SO3 guessImuRotation(const std::vector<Image>& images) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Image& image : images) {
    if (image.has_acc) sum += image.acc * (guessPose(image).orient.inverse() * vec3::UnitZ()).transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return SO3(svd.matrixU() * Eigen::Vector3d(1, 1, handedness).asDiagonal() * svd.matrixV().transpose());
}
