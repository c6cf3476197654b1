// Calibrations as ROS and Kalibr read them, read back by Python's yaml.
#include "calibrate/output/formats.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::sourcePath;
using slom::testing::TemporaryFolder;

/// Returns the content of a YAML file as JSON; null without Python's yaml.
json readYaml(const std::filesystem::path& file) {
  const auto result = slom::testing::runCommand(
      {"/usr/bin/python3", "-c",
       "import json, sys, yaml; print(json.dumps(yaml.safe_load(open(sys.argv[1]))))", file.string()});
  return result.exit_code == 0 ? json::parse(result.output) : json();
}

/// The OpenCV samples with a model; the result as JSON.
json calibrated(const TemporaryFolder& folder, const std::string& model, const std::string& output) {
  const auto data = sourcePath("data/opencv_stereo");
  const auto result = testing::runCalibrate(
      {"--camera", "left=" + (data / "left_corners.csv").string(), "--camera",
       "right=" + (data / "right_corners.csv").string(), "--intrinsics", model, "--image-size", "640x480",
       "--output", (folder / output).string(), "--json", (folder / "result.json").string(), "--quiet"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return json::parse(slom::testing::readFile(folder / "result.json"));
}

json parameters(const json& result, const std::string& camera, const std::vector<std::string>& names) {
  json values = json::array();
  for (const std::string& name : names)
    values.push_back(name == "0" ? json(0) : result["cameras"][camera]["parameters"][name]["value"]);
  return values;
}

TEST(RosFormat, HasWhatCameraInfoHas) {
  const std::vector<std::tuple<std::string, std::string, std::vector<std::string>>> models{
      {"opencv4", "plumb_bob", {"k1", "k2", "p1", "p2", "0"}},
      {"opencv5", "plumb_bob", {"k1", "k2", "p1", "p2", "k3"}},
      {"fisheye", "equidistant", {"k1", "k2", "k3", "k4"}}};
  for (const auto& [model, ros_model, names] : models) {
    const TemporaryFolder folder;
    const json result = calibrated(folder, model, "{name}_info.yaml");
    for (const std::string camera : {"left", "right"}) {
      const json yaml = readYaml(folder / (camera + "_info.yaml"));
      if (yaml.is_null()) GTEST_SKIP() << "needs Debian's python3-yaml";
      EXPECT_EQ(yaml["image_width"], 640);
      EXPECT_EQ(yaml["image_height"], 480);
      EXPECT_EQ(yaml["camera_name"], camera);
      EXPECT_EQ(yaml["distortion_model"], ros_model);
      EXPECT_EQ(yaml["distortion_coefficients"],
                json({{"rows", 1}, {"cols", names.size()}, {"data", parameters(result, camera, names)}}));
      const json p = parameters(result, camera, {"fx", "fy", "cx", "cy"});
      EXPECT_EQ(yaml["camera_matrix"],
                json({{"rows", 3}, {"cols", 3}, {"data", {p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1}}}));
      EXPECT_EQ(yaml["rectification_matrix"],
                json({{"rows", 3}, {"cols", 3}, {"data", {1, 0, 0, 0, 1, 0, 0, 0, 1}}}));
      EXPECT_EQ(yaml["projection_matrix"],
                json({{"rows", 3}, {"cols", 4}, {"data", {p[0], 0, p[2], 0, 0, p[1], p[3], 0, 0, 0, 1, 0}}}));
    }
  }
}

TEST(RosFormat, HasTheRationalModel) {
  CameraResult camera;
  camera.name = "left";
  camera.model = "opencv8";
  const std::vector<double> distortion{0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  const std::vector<std::string>& names = Model("opencv8").parameters();
  for (std::size_t i = 0; i < names.size(); ++i)
    camera.parameters.push_back({names[i], i < 4 ? 100. * double(i) : distortion[i - 4]});
  camera.camera_matrix << 500, 0, 320, 0, 501, 240, 0, 0, 1;
  camera.image_size = ImageSize{640, 480};
  const TemporaryFolder folder;
  slom::testing::writeFile(folder / "left.yaml", toRosYaml(camera));
  const json yaml = readYaml(folder / "left.yaml");
  if (yaml.is_null()) GTEST_SKIP() << "needs Debian's python3-yaml";
  EXPECT_EQ(yaml["distortion_model"], "rational_polynomial");
  EXPECT_EQ(yaml["distortion_coefficients"]["cols"], 8);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(yaml["distortion_coefficients"]["data"][i], distortion[i]);
}

TEST(KalibrFormat, IsACamchain) {
  for (const auto& [model, kalibr_model, names] :
       {std::tuple("opencv4", "radtan", std::vector<std::string>{"k1", "k2", "p1", "p2"}),
        {"fisheye", "equidistant", {"k1", "k2", "k3", "k4"}}}) {
    const TemporaryFolder folder;
    const json result = calibrated(folder, model, "camchain.yaml");
    const json yaml = readYaml(folder / "camchain.yaml");
    if (yaml.is_null()) GTEST_SKIP() << "needs Debian's python3-yaml";
    ASSERT_EQ(yaml.size(), 2u);
    for (const auto& [key, camera] : {std::pair("cam0", "left"), {"cam1", "right"}}) {
      EXPECT_EQ(yaml[key]["camera_model"], "pinhole");
      EXPECT_EQ(yaml[key]["distortion_model"], kalibr_model);
      EXPECT_EQ(yaml[key]["distortion_coeffs"], parameters(result, camera, names));
      EXPECT_EQ(yaml[key]["intrinsics"], parameters(result, camera, {"fx", "fy", "cx", "cy"}));
      EXPECT_EQ(yaml[key]["resolution"], json({640, 480}));
    }
    EXPECT_FALSE(yaml["cam0"].contains("T_cn_cnm1"));
    const json& T = yaml["cam1"]["T_cn_cnm1"];
    const json& pose = result["cameras"]["right"]["pose_from_left"];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) EXPECT_NEAR(T[i][j], pose["rotation"][3 * i + j], 1e-15);
      EXPECT_NEAR(T[i][3], pose["translation"][i], 1e-15);
    }
    EXPECT_EQ(T[3], json({0, 0, 0, 1}));
  }
}

}  // namespace
}  // namespace slom::app::calib
