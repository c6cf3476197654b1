#pragma once
// Truth of simulated devices in JSON, with the keys of the result of `slom calibrate`.

#include <nlohmann/json.hpp>

#include <mtk/mtk.hpp>

#include "simulate/stereo_imu.hpp"

namespace slom::app {

inline nlohmann::ordered_json vectorJson(const mtk::vect<3>& v) { return {v.x(), v.y(), v.z()}; }

/// Returns the rotation matrix by rows.
inline nlohmann::ordered_json rotationJson(const mtk::SO3<>& rotation) {
  auto rows = nlohmann::ordered_json::array();
  const auto R = rotation.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) rows.push_back(R(i, j));
  }
  return rows;
}

inline nlohmann::ordered_json poseJson(const mtk::trafo<mtk::SO3<>>& pose) {
  return {{"rotation", rotationJson(pose.orient)}, {"translation", vectorJson(pose.pos)}};
}

/// Returns the camera; `pose_key` names its pose.
inline nlohmann::ordered_json cameraJson(const SimulatedCamera& camera, const char* pose_key,
                                         const mtk::trafo<mtk::SO3<>>& pose) {
  nlohmann::ordered_json parameters;
  const auto add = [&](const char* name, double value) { parameters[name]["value"] = value; };
  add("fx", camera.fx), add("fy", camera.fy), add("cx", camera.cx), add("cy", camera.cy);
  add("k1", camera.k1), add("k2", camera.k2), add("p1", camera.p1), add("p2", camera.p2);
  add("k3", camera.k3);
  return {{"model", "opencv5"}, {"parameters", parameters}, {pose_key, poseJson(pose)}};
}

}  // namespace slom::app
