// Readers of public maps of landmarks in the plane; shared/data/landmark/README.md has their formats.
#pragma once

#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <Eigen/LU>

#include "initialize/maps.hpp"

namespace slom::testing {

template <int N>
Eigen::Matrix<double, N, N> readCovariance(std::istream& stream) {
  Eigen::Matrix<double, N, N> C;
  for (int i = 0; i < N; ++i) {
    for (int j = i; j < N; ++j) {
      stream >> C(i, j);
      C(j, i) = C(i, j);
    }
  }
  return C;
}

inline Map<Pose2> readVictoriaPark(const std::string& file) {
  Map<Pose2> map;
  std::map<int, int> pose_of, landmark_of;
  const auto pose = [&](int id) {
    const auto [it, is_new] = pose_of.try_emplace(id, int(map.poses.size()));
    if (is_new) map.addPose(Pose2(), map.poses.empty());
    return it->second;
  };
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string tag;
    int i = 0, j = 0;
    double x = 0, y = 0, angle = 0;
    words >> tag >> i >> j >> x >> y;
    const int from = pose(i);
    if (tag == "ODOMETRY") {
      words >> angle;
      const int to = pose(j);
      map.addEdge(from, to, Pose2(mtk::SO2<>(angle), mtk::vect<2>(x, y)), readCovariance<3>(words).inverse());
    } else {
      const auto [it, is_new] = landmark_of.try_emplace(j, int(map.landmarks.size()));
      if (is_new) map.addLandmark();
      map.addSighting(from, it->second, mtk::vect<2>(x, y), readCovariance<2>(words).inverse());
    }
  }
  return map;
}

/// Observations with several numbers count for the first one; those without a number are left out.
inline Map<Pose2> readDlr(const std::string& file) {
  Map<Pose2> map;
  std::map<int, int> landmark_of;
  map.addPose(Pose2(), true);
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string tag, image;
    double x = 0, y = 0, angle = 0, quality = 0;
    words >> tag;
    if (tag == "STEP") {
      Eigen::Matrix3d C;
      words >> image >> x >> y >> angle >> C(0, 0) >> C(0, 1) >> C(1, 1) >> C(0, 2) >> C(1, 2) >> C(2, 2);
      C = C.selfadjointView<Eigen::Upper>();
      const int to = map.addPose();
      map.addEdge(to - 1, to, Pose2(mtk::SO2<>(angle), mtk::vect<2>(x, y)), C.inverse());
    } else if (tag == "LANDMARK_C") {
      words >> x >> y >> quality;
      const Eigen::Matrix2d C = readCovariance<2>(words);
      int id = -1;
      words >> id;
      if (id < 0) continue;
      const auto [it, is_new] = landmark_of.try_emplace(id, int(map.landmarks.size()));
      if (is_new) map.addLandmark();
      map.addSighting(int(map.poses.size()) - 1, it->second, mtk::vect<2>(x, y), C.inverse());
    }
  }
  return map;
}

}  // namespace slom::testing
