// Views that repeat others are found and left out. Frames of a camera at rest are no copies.
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_command.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/notes.hpp"

namespace slom::app::calib {
namespace {

using nlohmann::json;
using slom::testing::readFile;
using slom::testing::writeFile;
using testing::RigOptions;
using testing::TemporaryFolder;

struct Copies : ::testing::Test {
  Copies() {
    RigOptions options;
    options.images = 5;
    std::mt19937_64 random(1);
    data = testing::simulateMeasurements(testing::simulateTruth(options, random), options, random);
    left().name = "left", right().name = "right";
    data.imu.reset();
  }
  CameraData& left() { return data.cameras[0]; }
  CameraData& right() { return data.cameras[1]; }
  /// Appends view number `index` of a camera under another image number.
  static View& repeat(CameraData& camera, std::size_t index, int image) {
    View copy = camera.views[index];
    copy.image = image;
    camera.views.push_back(copy);
    return camera.views.back();
  }
  std::string refusal() {
    try {
      leaveOutCopies(data);
    } catch (const DataError& error) {
      EXPECT_EQ(error.id(), "slom.calibration.copies");
      return std::string(error.sentence());
    }
    return "no error";
  }

  Dataset data;
};

TEST_F(Copies, AreNoneAmongDifferentViews) {
  leaveOutCopies(data);
  EXPECT_EQ(left().views.size(), 5u);
  EXPECT_TRUE(left().copies.empty() && right().copies.empty());
}

TEST_F(Copies, UnderOtherNumbersAreLeftOut) {
  repeat(left(), 1, 11);
  repeat(left(), 1, 12);
  leaveOutCopies(data);
  EXPECT_EQ(left().views.size(), 5u);
  ASSERT_EQ(left().copies.size(), 2u);
  EXPECT_EQ(left().copies[1].image, 12);
  EXPECT_EQ(left().copies[1].original, left().views[1].image);
  EXPECT_EQ(left().copies[1].difference_px, 0);
  EXPECT_EQ(left().copies[1].equal_corners, left().copies[1].corners);
  EXPECT_TRUE(right().copies.empty());
}

TEST_F(Copies, OfAllKindsAreFound) {
  View& renumbered = repeat(left(), 0, 11);
  for (Corner& corner : renumbered.corners) corner.number = corner.number % 48 + 1;
  View& changed = repeat(left(), 0, 12);
  changed.corners[3].pixel.x() += 0.3;
  View& incomplete = repeat(left(), 0, 13);
  incomplete.corners.resize(incomplete.corners.size() - 7);
  std::swap(incomplete.corners[0], incomplete.corners[5]);
  View& rounded = repeat(left(), 0, 14);
  for (Corner& corner : rounded.corners) {
    for (double& coordinate : corner.pixel) coordinate = std::round(coordinate * 200) / 200;
  }
  leaveOutCopies(data);
  ASSERT_EQ(left().copies.size(), 4u);
  EXPECT_EQ(left().copies[1].equal_corners + 1, left().copies[1].corners);
  EXPECT_EQ(left().copies[2].equal_corners, left().copies[2].corners);
  EXPECT_GT(left().copies[3].difference_px, 0);
  EXPECT_LT(left().copies[3].difference_px, 0.005);
}

TEST_F(Copies, OfAViewThatHadCornersMissing) {
  repeat(left(), 0, 11);
  left().views[0].corners.erase(left().views[0].corners.begin(), left().views[0].corners.begin() + 5);
  leaveOutCopies(data);
  EXPECT_EQ(left().copies.size(), 1u);
}

/// A view again and again, with the noise of a good detector.
void expectNoCopies(Dataset data, std::size_t corners) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.02);
  CameraData& camera = data.cameras[0];
  View still = camera.views[0];
  still.corners.resize(corners);
  camera.views.clear();
  for (still.image = 1; still.image <= 300; ++still.image) {
    camera.views.push_back(still);
    for (Corner& corner : camera.views.back().corners) corner.pixel += vec2(noise(random), noise(random));
  }
  leaveOutCopies(data);
  EXPECT_EQ(camera.views.size(), 300u) << corners;
}

TEST_F(Copies, AreNotFramesOfACameraAtRest) {
  expectNoCopies(data, left().views[0].corners.size());
  expectNoCopies(data, 4);
}

TEST_F(Copies, OfOneCameraLeaveTheOtherItsView) {
  left().views[3].corners = left().views[0].corners;
  const int image = left().views[3].image;
  leaveOutCopies(data);
  EXPECT_EQ(left().find(image), nullptr);
  EXPECT_NE(right().find(image), nullptr);
  EXPECT_EQ(left().copies.size(), 1u);
}

TEST_F(Copies, TakeReadingsOfTheirImagesAlong) {
  data.imu = ImuData{"imu.csv", {}};
  for (const int image : {1, 2, 3, 4, 5, 11, 99})
    data.imu->readings.push_back({image, vec3(0, 0, 9.81), image});
  repeat(left(), 0, 11);
  left().views[3].corners = left().views[1].corners;  // right has a view of its own then
  leaveOutCopies(data);
  std::vector<int> images;
  for (const ImuReading& reading : data.imu->readings) images.push_back(reading.image);
  EXPECT_EQ(images, (std::vector<int>{1, 2, 3, 4, 5, 99})) << "99 is a mistake that others name";
  EXPECT_FALSE(left().copies[0].has_reading);
  EXPECT_TRUE(left().copies[1].has_reading);
}

TEST_F(Copies, OfOneImageAloneAreRefused) {
  left().views.resize(1);
  for (int image = 11; image <= 17; ++image) repeat(left(), 0, image);
  EXPECT_EQ(
      refusal(),
      "camera.csv: all 8 images of camera left repeat image 1, to within 0.000 px; a copy is not a second "
      "measurement, so add images from other directions");
}

TEST_F(Copies, InTwoCamerasAreRefused) {
  right().views = left().views;
  EXPECT_EQ(refusal(),
            "cameras left and right have the same corners in 5 of 5 images: image 1 of right is image 1 "
            "of left; these are photographs of one camera, so correct the files of the other camera, or "
            "leave it out");
}

TEST_F(Copies, InTwoCamerasUnderOtherNumbersAreRefused) {
  right().views = left().views;
  for (View& view : right().views) view.image += 100, view.photo = "r.png";
  right().views.pop_back();
  right().views.back().corners.resize(4);
  EXPECT_TRUE(refusal().starts_with("cameras left and right have the same corners in 4 of 4 images"));
}

TEST_F(Copies, InTwoCamerasOfFewImagesAreNotRefused) {
  right().views[0] = left().views[0];
  EXPECT_EQ(refusal(), "no error");
}

TEST_F(Copies, AreFoundAmongThousandsOfViews) {
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 0.02);
  for (int image = 101; image <= 2100; ++image) {
    View& view = repeat(left(), 0, image);
    for (Corner& corner : view.corners) corner.pixel += vec2(noise(random), noise(random));
  }
  repeat(left(), 1000, 3000);
  leaveOutCopies(data);
  EXPECT_EQ(left().copies.size(), 1u);
}

TEST_F(Copies, AreNamedInReportJsonAndPage) {
  repeat(left(), 1, 11).photo = "b.png";
  left().views[1].photo = "a.png";
  for (int image = 12; image < 30; ++image) repeat(right(), 0, image);
  const TemporaryFolder folder;
  const std::string photos = "# photo 2: a.png\n# photo 11: b.png\n";
  writeFile(folder / "left.csv", photos + testing::cornerFile(left()));
  writeFile(folder / "right.csv", testing::cornerFile(right()));
  const auto result =
      testing::runCalibrate({"--camera", "left=" + (folder / "left.csv").string(), "--camera",
                             "right=" + (folder / "right.csv").string(), "--intrinsics", "radial1", "--json",
                             (folder / "r.json").string(), "--report", (folder / "r.html").string()});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("  left: left out, because it repeats another image: b.png\n"),
            std::string::npos)
      << result.output;
  EXPECT_NE(result.output.find("image 22, image 23 and 6 more\n"), std::string::npos) << result.output;
  const json found = json::parse(readFile(folder / "r.json"));
  const std::string left_note =
      "Camera left: image 11 (b.png) repeats image 2 (a.png) to within 0.000 px, so it is left out; a "
      "copy is not a second measurement.";
  ASSERT_GE(found["notes"].size(), 2u);
  EXPECT_EQ(found["notes"][0], left_note);
  EXPECT_EQ(found["notes"][1],
            "Camera right: image 12 repeats image 1, image 13 repeats image 1, image 14 repeats image 1, "
            "image 15 repeats image 1, image 16 repeats image 1, image 17 repeats image 1, image 18 "
            "repeats image 1, image 19 repeats image 1 and 10 more repeat others to within 0.000 px, so "
            "they are left out; a copy is not a second measurement.");
  EXPECT_NE(readFile(folder / "r.html").find(left_note), std::string::npos);
  EXPECT_EQ(found["cameras"]["left"]["images"], 5);
  EXPECT_EQ(found["cameras"]["left"]["copies"][0]["repeats"], 2);
  EXPECT_EQ(found["cameras"]["right"]["copies"].size(), 18u);
}

TEST_F(Copies, OfOneCornerInAnImageAreRefused) {
  left().views[2].corners.push_back(left().views[2].corners[4]);
  left().views[2].corners.back().number = 1000;
  const TemporaryFolder folder;
  writeFile(folder / "left.csv", testing::cornerFile(left()));
  const auto result = testing::runCalibrate({"--camera", "left=" + (folder / "left.csv").string()});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find(": corner 1000 of image 3 repeats corner 5 of line "), std::string::npos)
      << result.errors;
  EXPECT_NE(
      result.errors.find(", the same point of the board at the same pixel; remove one of the two rows\n"),
      std::string::npos);
}

}  // namespace
}  // namespace slom::app::calib
