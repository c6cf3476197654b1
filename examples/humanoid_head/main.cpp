// Calibrates the head of a humanoid robot as a whole: two cameras, the IMU between them, the mounting of the cameras on
// the head, and the places of the markers on the hands. One fit combines images of a level checkerboard, gravity, and
// images of the markers. The arms' kinematics gives the poses of the hands.
//
//     example_humanoid_head FOLDER
//
// FOLDER contains the files left_corners.csv, right_corners.csv, imu.csv, left_hand.csv, right_hand.csv and
// initial_guess.csv of the robot Justin (OpenSLAM's repository openslam_MTK; R. Wagner, O. Birbach, U. Frese, "Rapid
// development of manifold-based graph optimization systems for multi-sensor calibration and SLAM", IROS 2011).
//   frames   a2b maps points of a to b. world: frame of the board, z up; left, right: cameras, z forward; head; hand
//   units    m, px, m/s^2
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <slom/analyze/variance_components.hpp>
#include <slom/slom.hpp>

using SO3 = mtk::SO3<>;
using SE3 = mtk::trafo<SO3>;
using vec2 = mtk::vect<2>;
using vec3 = mtk::vect<3>;

/// A camera with f, cx, cy, k: square pixels, and a radial factor 1 / (1 + k r^2).
template <class S = double>
struct Camera : mtk::vect<4, S> {
  static constexpr std::array<std::string_view, 4> component_names{"f", "cx", "cy", "k"};
  using mtk::vect<4, S>::vect;
  auto project(const auto& p) const {
    const auto x = p[0] / p[2], y = p[1] / p[2];
    const auto scale = (*this)[0] / (1.0 + (*this)[3] * (x * x + y * y));
    return mtk::vector(scale * x + (*this)[1], scale * y + (*this)[2]);
  }
};

// The measurement functions return what each sensor should measure.
constexpr auto corner_in_left = [](const auto& camera, const auto& left2world, const vec3& corner) {
  return camera.project(left2world.inverse() * corner);
};
constexpr auto corner_in_right = [](const auto& camera, const auto& left2right, const auto& left2world,
                                    const vec3& corner) {
  return camera.project(left2right * (left2world.inverse() * corner));
};
constexpr auto gravity = [](const auto& left2imu, const auto& left2world) {
  return left2imu * (left2world.orient.inverse() * vec3(0, 0, -9.81));
};
constexpr auto marker_in_left = [](const auto& camera, const auto& left2head, const auto& marker,
                                   const SE3& hand2head) {
  return camera.project(left2head.inverse() * (hand2head * marker));
};
constexpr auto marker_in_right = [](const auto& camera, const auto& left2right, const auto& left2head,
                                    const auto& marker, const SE3& hand2head) {
  return camera.project(left2right * (left2head.inverse() * (hand2head * marker)));
};

/// Returns the rows of a CSV file below its header, with commas replaced by blanks.
std::vector<std::istringstream> rowsOf(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + " cannot be read");
  std::vector<std::istringstream> rows;
  std::string line;
  std::getline(stream, line);
  while (std::getline(stream, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    rows.emplace_back(line);
  }
  return rows;
}

SO3 readRotation(std::istream& is) {
  Eigen::Matrix3d R;
  for (int i = 0; i < 9; ++i) is >> R(i / 3, i % 3);
  return SO3(R);
}
SE3 readPose(std::istream& is) {
  const SO3 orient = readRotation(is);
  vec3 pos;
  is >> pos;
  return SE3(orient, pos);
}

int main(int argc, char** argv) try {
  if (argc != 2)
    throw std::runtime_error("usage: example_humanoid_head FOLDER, with the files that main.cpp names");
  const std::string folder = std::string(argv[1]) + "/";

  slom::Estimator est;
  slom::VarID<Camera<>> left, right;
  slom::VarID<SE3> left2right, left2head;
  slom::VarID<SO3> left2imu;
  std::map<std::string, slom::VarID<vec3>> marker;  // on each hand
  std::vector<slom::VarID<SE3>> left2world;         // one per image
  for (std::istringstream& row : rowsOf(folder + "initial_guess.csv")) {
    std::string name;
    row >> name;
    if (name.starts_with("i_")) {
      Camera<> start;
      row >> start;
      (name == "i_left" ? left : right) = est.insertRV(start, name == "i_left" ? "left" : "right");
    } else if (name == "left2imu") {
      left2imu = est.insertRV(readRotation(row), name);
    } else if (name.starts_with("p_hand")) {
      marker[name.back() == 'l' ? "left_hand" : "right_hand"] =
          est.insertRV(vec3(0, 0, 0), name.back() == 'l' ? "left marker" : "right marker");
    } else {
      const auto id = est.insertRV(readPose(row), name == "cam2head" ? "left2head" : name);
      if (name == "left2right") left2right = id;
      if (name == "cam2head") left2head = id;
      if (name.starts_with("left2world")) left2world.push_back(id);
    }
  }

  std::size_t image = 0, number = 0, valid = 0;
  vec3 corner, acc;
  vec2 pixel, pixel_right;
  const slom::StandardDeviation corner_sigma(0.25), acc_sigma(0.05), marker_sigma(1.0);
  for (std::istringstream& row : rowsOf(folder + "left_corners.csv")) {
    row >> image >> number >> corner >> pixel;
    est.insertMeasurement(corner_in_left, left, left2world.at(image - 1), corner, slom::measured(pixel),
                          corner_sigma, slom::named("left corner"));
  }
  for (std::istringstream& row : rowsOf(folder + "right_corners.csv")) {
    row >> image >> number >> corner >> pixel;
    est.insertMeasurement(corner_in_right, right, left2right, left2world.at(image - 1), corner,
                          slom::measured(pixel), corner_sigma, slom::named("right corner"));
  }
  for (std::istringstream& row : rowsOf(folder + "imu.csv")) {
    row >> image >> acc >> valid;
    if (valid == 1)
      est.insertMeasurement(gravity, left2imu, left2world.at(image - 1), slom::measured(acc), acc_sigma,
                            slom::named("accelerometer"));
  }
  for (const auto& [hand, position] : marker) {
    for (std::istringstream& row : rowsOf(folder + hand + ".csv")) {
      row >> image >> number >> pixel >> pixel_right;
      const SE3 hand2head = readPose(row);
      est.insertMeasurement(marker_in_left, left, left2head, position, hand2head, slom::measured(pixel),
                            marker_sigma, slom::named("marker in left"));
      est.insertMeasurement(marker_in_right, right, left2right, left2head, position, hand2head,
                            slom::measured(pixel_right), marker_sigma, slom::named("marker in right"));
    }
  }

  const slom::Summary summary = est.optimize();
  std::cout << (summary.converged ? "converged" : summary.message) << ": " << summary.measurements
            << " residuals, " << summary.unknowns << " unknowns\n";
  std::cout.precision(5);
  for (const slom::GroupSummary& group : summary.groups) {
    std::cout << "  " << group.name << ": RMS " << std::sqrt(group.final_rss / group.residuals)
              << " standard deviations\n";
  }
  std::cout << slom::varianceComponents(est).report();  // size of their errors, relative to the stated size
  std::cout.precision(4);
  const slom::Marginals marginals = est.marginals();
  const auto show = [&](const auto& id) {
    std::cout << est.nameOf(id) << ": " << *id << "\n  +- "
              << marginals.covariance(id).diagonal().cwiseSqrt().transpose().format({3, Eigen::DontAlignCols})
              << "\n";
  };
  show(left), show(right), show(left2right), show(left2imu), show(left2head);
  for (const auto& [hand, position] : marker) show(position);
} catch (const std::exception& error) {
  std::cerr << "example_humanoid_head: " << error.what() << "\n";
  return 2;
}
