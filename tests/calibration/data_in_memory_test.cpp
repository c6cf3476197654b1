// Invalid data of a program are refused by a sentence: which camera, image, corner or reading, the value, and the
// remedy.
#include <functional>
#include <utility>

#include <gtest/gtest.h>

#include "calibration/rig_in_memory.hpp"
#include "support/message_of.hpp"

namespace slom::calibration {
namespace {

using slom::testing::messageOf;
using testing::infinity;
using testing::nan;
using testing::pinholeWithDistortion;
using testing::rigInMemory;

using Spoil = std::function<void(Dataset&)>;

Dataset spoiled(const Spoil& spoil) {
  Dataset data = rigInMemory();
  spoil(data);
  return data;
}

std::string refusal(const Spoil& spoil) {
  return messageOf([&] { calibrate(spoiled(spoil), pinholeWithDistortion()); });
}

TEST(DataInMemory, AreCalibratedWhereTheyMakeSense) {
  EXPECT_EQ(refusal([](Dataset&) {}), "no error");
  EXPECT_TRUE(calibrate(rigInMemory(), pinholeWithDistortion()).success());
}

TEST(DataInMemory, WithoutCameras) {
  EXPECT_EQ(messageOf([] { calibrate({}, {}); }),
            "[slom.calibration.bad-settings] the data set has no camera; add one");
  EXPECT_EQ(messageOf([] { compareModels({}, {}, {Model("opencv4")}); }),
            "[slom.calibration.bad-settings] the data set has no camera; add one");
  EXPECT_EQ(messageOf([] { assess({}, {}, {}); }),
            "[slom.calibration.bad-settings] the data set has no camera; add one");
  Dataset none;
  EXPECT_EQ(messageOf([&] { leaveOutCopies(none); }), "no error");
}

TEST(DataInMemory, NamesOfCameras) {
  EXPECT_EQ(
      refusal([](Dataset& data) { data.cameras[1].name = "left"; }),
      "[slom.calibration.bad-camera] cameras[0] and cameras[1] are both called left; give each camera a "
      "name of its own");
  EXPECT_EQ(refusal([](Dataset& data) { data.cameras[1].name.clear(); }),
            "[slom.calibration.bad-camera] cameras[1] has no name; give it one for results and messages");
}

TEST(DataInMemory, ImageSizes) {
  const auto refusalOf = [](ImageSize size) {
    return refusal([size](Dataset& data) { data.cameras[1].image_size = size; });
  };
  const std::string remedy = " px; give both sides from 1 to 100000 px, or leave image_size empty";
  const std::string fault = "[slom.calibration.bad-camera] the image size of camera right is ";
  EXPECT_EQ(refusalOf({-5, 3}), fault + "-5 x 3" + remedy);
  EXPECT_EQ(refusalOf({0, 0}), fault + "0 x 0" + remedy);
  EXPECT_EQ(refusalOf({640, 100'001}), fault + "640 x 100001" + remedy);
}

TEST(DataInMemory, ViewsWithoutContent) {
  EXPECT_EQ(refusal([](Dataset& data) { data.cameras[1].views.clear(); }),
            "[slom.calibration.too-few-views] camera right: has no corners; add some");
  EXPECT_EQ(
      refusal([](Dataset& data) { data.cameras[1].views[2].corners.clear(); }),
      "[slom.calibration.bad-view] image 2 of camera right has no corners; add at least 4, or remove the "
      "view");
  EXPECT_EQ(
      refusal([](Dataset& data) { data.cameras[1].views[2].corners.resize(3); }),
      "[slom.calibration.bad-view] camera right: image 2 has only 3 corners; a pose needs at least 4, so "
      "add corners or remove the image");
  EXPECT_EQ(refusal([](Dataset& data) { data.cameras[1].views.resize(1); }),
            "[slom.calibration.too-few-views] camera right: image 0 is the only one of camera right; its "
            "intrinsics need at least 2 images from different directions, so add images");
  const Spoil flat = [](Dataset& data) {  // a board whose squares have no size
    for (Corner& corner : data.cameras[0].views[0].corners) corner.world = vec3(0., 0., 0.);
  };
  EXPECT_EQ(
      refusal(flat),
      "[slom.calibration.bad-view] camera left: image 0: all world points, or all but one, lie on a line; "
      "a pose needs at least two points off the line, so add corners or remove the image");
}

TEST(DataInMemory, AnImageTwice) {
  EXPECT_EQ(refusal([](Dataset& data) { data.cameras[1].views[4].image = 1; }),
            "[slom.calibration.bad-view] camera right has image 1 twice, as views[1] and views[4]; put the "
            "corners of an image into one view, or correct the number");
}

TEST(DataInMemory, ACornerTwice) {
  const Spoil repeat = [](Dataset& data) {
    View& view = data.cameras[0].views[3];
    view.corners.push_back(view.corners[5]);
  };
  EXPECT_EQ(
      refusal(repeat),
      "[slom.calibration.bad-view] camera left: corner 5 of image 3 repeats corner 5, the same point of "
      "the board at the same pixel; remove one of the two");
  const Spoil contradict = [](Dataset& data) {
    View& view = data.cameras[0].views[3];
    view.corners[5].pixel = vec2(300., 200.);
    view.corners.push_back(view.corners[5]);
    view.corners.back().pixel = vec2(17.5, 20.);
  };
  EXPECT_EQ(
      refusal(contradict),
      "[slom.calibration.bad-view] camera left: corner 5 of image 3 is there twice, at the pixels (300, "
      "200) and (17.5, 20); remove one of the two");
}

TEST(DataInMemory, PixelsAndPlacesThatAreNoNumbers) {
  const auto refusalOf = [](const std::function<void(Corner&)>& change) {
    return refusal([&](Dataset& data) { change(data.cameras[1].views[2].corners[7]); });
  };
  const std::string corner = "[slom.calibration.bad-corner] corner 7 of image 2 of camera right is at ";
  const std::string px = "; give finite coordinates of magnitude 1e+06 px at most, or remove the corner",
                    m = "; give finite coordinates of magnitude 1e+06 m at most, or remove the corner";
  EXPECT_EQ(refusalOf([](Corner& c) { c.pixel = vec2(nan, 240.); }), corner + "the pixel (nan, 240)" + px);
  EXPECT_EQ(refusalOf([](Corner& c) { c.pixel = vec2(3., -infinity); }), corner + "the pixel (3, -inf)" + px);
  EXPECT_EQ(refusalOf([](Corner& c) { c.pixel = vec2(1e300, 0.); }), corner + "the pixel (1e+300, 0)" + px);
  EXPECT_EQ(refusalOf([](Corner& c) { c.world = vec3(0.1, nan, 0.); }),
            corner + "(0.1, nan, 0) m in the world" + m);
  EXPECT_EQ(refusalOf([](Corner& c) { c.world = vec3(0.1, 0.2, 2e6); }),
            corner + "(0.1, 0.2, 2e+06) m in the world" + m);
}

TEST(DataInMemory, ImagesThatAreTooSmallForTheirCorners) {
  // A few corners outside are gross ones, which the fit leaves out; more than a twentieth are not.
  const auto withOutside = [](std::size_t fewest, const vec2& pixel) {
    return [fewest, pixel](Dataset& data) {
      CameraData& camera = data.cameras[1];
      camera.image_size = ImageSize{2000, 1000};
      std::size_t changed = 0;
      for (std::size_t k = 0; changed < fewest; ++k) {
        for (std::size_t v = 0; v < camera.views.size() && changed < fewest; ++v, ++changed)
          camera.views[v].corners[7 + k].pixel = pixel + vec2(0., 1e-3 * double(changed));
      }
    };
  };
  Dataset data = rigInMemory();
  const std::size_t all = data.cameras[1].cornerCount(), few = all / 20;
  const auto expected = [&](const std::string& pixel, const std::string& question) {
    return "[slom.calibration.bad-corner] corner 7 of image 0 of camera right is at the pixel " + pixel +
           ", outside the image of 2000 x 1000 px, like " + std::to_string(few + 1) + " of " +
           std::to_string(all) + " corners" + question + "; correct the size or the corners";
  };
  EXPECT_EQ(refusal(withOutside(few + 1, {2001.5, 3.})), expected("(2001.5, 3)", ""));
  EXPECT_EQ(refusal(withOutside(few + 1, {-1.5, 3.})), expected("(-1.5, 3)", ""));
  EXPECT_EQ(refusal(withOutside(few + 1, {3., -1.5})), expected("(3, -1.5)", ""));
  EXPECT_EQ(refusal(withOutside(few + 1, {3., 1001.5})),
            expected("(3, 1001.5)", " (are width and height exchanged?)"));
  withOutside(few, {2001.5, 3.})(data);
  EXPECT_NO_THROW(calibrate(data, pinholeWithDistortion()));
}

TEST(DataInMemory, CornersWithoutNumbersAreNamedByTheirIndex) {
  const Spoil spoil = [](Dataset& data) {
    for (Corner& corner : data.cameras[0].views[1].corners) corner.number = 0;
    data.cameras[0].views[1].corners[9].pixel = vec2(1., nan);
  };
  EXPECT_EQ(
      refusal(spoil),
      "[slom.calibration.bad-corner] corners[9] of image 1 of camera left is at the pixel (1, nan); give "
      "finite coordinates of magnitude 1e+06 px at most, or remove the corner");
}

TEST(DataInMemory, CornersThatComeFromFilesAreNamedByTheirLine) {
  const Spoil spoil = [](Dataset& data) {
    data.cameras[0].file = "left.csv";
    Corner& corner = data.cameras[0].views[1].corners[9];
    corner.line = 46, corner.pixel = vec2(1., nan);
  };
  EXPECT_EQ(
      refusal(spoil),
      "[slom.calibration.bad-corner] left.csv:46: corner 9 of image 1 of camera left is at the pixel (1, "
      "nan); give finite coordinates of magnitude 1e+06 px at most, or remove the corner");
}

TEST(DataInMemory, AnImuWithoutReadings) {
  EXPECT_EQ(refusal([](Dataset& data) { data.imu.emplace(); }),
            "[slom.calibration.imu-open] imu: there are no readings; add some, or leave the IMU out");
  EXPECT_EQ(refusal([](Dataset& data) {
              data.imu = ImuData{"wrist.csv", {}};
            }),
            "[slom.calibration.imu-open] wrist.csv: there are no readings; add some, or leave the IMU out");
}

TEST(DataInMemory, ReadingsThatMakeNoSense) {
  const auto refusalOf = [](const std::function<void(ImuReading&)>& change) {
    return refusal([&](Dataset& data) { change(data.imu->readings[4]); });
  };
  EXPECT_EQ(
      refusalOf([](ImuReading& r) { r.acc = vec3(0., nan, 9.8); }),
      "[slom.calibration.bad-reading] imu.readings[4]: the reading of image 4 is (0, nan, 9.8) m/s^2; give "
      "finite numbers of magnitude 1e+06 m/s^2 at most, or leave the reading out");
  EXPECT_EQ(
      refusalOf([](ImuReading& r) { r.acc = vec3(0., 0., infinity); }),
      "[slom.calibration.bad-reading] imu.readings[4]: the reading of image 4 is (0, 0, inf) m/s^2; give "
      "finite numbers of magnitude 1e+06 m/s^2 at most, or leave the reading out");
  EXPECT_EQ(refusalOf([](ImuReading& r) { r.image = 1; }),
            "[slom.calibration.bad-reading] imu.readings[4]: image 1 already has a reading, "
            "imu.readings[1]; keep one, or the mean of both");
}

TEST(DataInMemory, ReadingsAreNamedByTheirIndexOrTheirLine) {
  EXPECT_EQ(refusal([](Dataset& data) { data.imu->readings[4].image = 70; }),
            "[slom.calibration.imu-images] imu.readings[4]: there are no corners of image 70 in any camera; "
            "correct the number, or leave the reading out");
  const auto refusalOf = [](const std::string& file, int line) {
    return refusal([&](Dataset& data) {
      data.imu->file = file;
      data.imu->readings[4].image = 70, data.imu->readings[4].line = line;
    });
  };
  const std::string sentence =
      ": there are no corners of image 70 in any camera; correct the number, or leave the reading out";
  EXPECT_EQ(refusalOf("wrist", 0), "[slom.calibration.imu-images] wrist, imu.readings[4]" + sentence);
  EXPECT_EQ(refusalOf("wrist.csv", 6), "[slom.calibration.imu-images] wrist.csv:6" + sentence);
  EXPECT_EQ(refusalOf("", 6), "[slom.calibration.imu-images] imu:6" + sentence);
  EXPECT_EQ(
      refusal([](Dataset& data) { data.imu->readings.resize(1); }),
      "[slom.calibration.imu-open] imu.readings[0]: 1 valid reading of tilts that spread by 0 deg do not "
      "determine the orientation of the IMU, acc_bias, gravity; add readings at other tilts, about more "
      "than one axis");
}

TEST(DataInMemory, AreAskedByEveryFunctionThatTakesThem) {
  const Settings settings = pinholeWithDistortion();
  const Dataset good = rigInMemory();
  const Result result = calibrate(good, settings);
  const auto expectRefused = [&](const std::string& sentence, const Spoil& spoil) {
    Dataset bad = spoiled(spoil);
    EXPECT_EQ(messageOf([&] { calibrate(bad, settings); }), sentence);
    EXPECT_EQ(messageOf([&] { compareModels(bad, settings, {Model("opencv4")}); }), sentence);
    EXPECT_EQ(messageOf([&] { assess(bad, settings, result); }), sentence);
    EXPECT_EQ(messageOf([&] { PixelUncertainty(bad, result); }), sentence);
    EXPECT_EQ(messageOf([&] { leaveOutCopies(bad); }), sentence);
  };
  expectRefused(
      "[slom.calibration.bad-view] image 2 of camera right has no corners; add at least 4, or remove "
      "the view",
      [](Dataset& data) { data.cameras[1].views[2].corners.clear(); });
  expectRefused("[slom.calibration.imu-open] imu: there are no readings; add some, or leave the IMU out",
                [](Dataset& data) { data.imu.emplace(); });
}

TEST(DataInMemory, StayAsTheyWereWhereCopiesCannotBeLeftOut) {
  Dataset data = rigInMemory();
  std::swap(data.cameras[0].views[0], data.cameras[0].views[5]);
  data.cameras[0].views[1].corners = data.cameras[0].views[2].corners;  // a copy, to be left out
  CameraData& right = data.cameras[1];
  for (View& view : right.views) view.corners = right.views[0].corners;  // copies without another view
  EXPECT_EQ(messageOf([&] { leaveOutCopies(data); }),
            "[slom.calibration.copies] camera right: all 6 images of camera right repeat image 0, to within "
            "0.000 px; a copy is not a second measurement, so add images from other directions");
  ASSERT_EQ(data.cameras[0].views.size(), 6u);
  EXPECT_TRUE(data.cameras[0].copies.empty());
  EXPECT_EQ(data.cameras[0].views[0].image, 5);
  EXPECT_EQ(data.cameras[0].views[1].corners.size(), 35u);
}

TEST(BoardInMemory, IsRefusedWhereItDeterminesNothing) {
  EXPECT_EQ(messageOf([] { fitPlane({}); }),
            "[slom.calibration.bad-view] too few corners for a plane: 0; pass at least 3");
  EXPECT_EQ(messageOf([] { outlineOf(View()); }),
            "[slom.calibration.bad-view] too few corners for a plane: 0; pass at least 3");
  const Corner corner{1, vec3(nan, 0., 0.), vec2(1., 1.)};
  EXPECT_EQ(
      messageOf([&] {
        fitPlane({corner, corner, corner});
      }),
      "[slom.calibration.bad-corner] the corners do not lie in a plane, because their coordinates are not "
      "finite or too large; give coordinates of magnitude 1e+06 m at most");
  EXPECT_EQ(messageOf([] { fullestView({}); }),
            "[slom.calibration.too-few-views] there is no view in the data set; add some");
  const std::vector<vec2> three(3, vec2(1., 1.)), four(4, vec2(1., 1.));
  EXPECT_EQ(
      messageOf([&] { findHomography(four, three); }),
      "[slom.calibration.bad-view] a homography cannot be found from points: 4 of the board, and 3 of the "
      "image; pass as many of both, and at least 4");
  EXPECT_EQ(
      messageOf([&] { findHomography(three, three); }),
      "[slom.calibration.bad-view] a homography cannot be found from points: 3 of the board, and 3 of the "
      "image; pass as many of both, and at least 4");
  EXPECT_TRUE(onLineButOne({}, 1e-3));
  EXPECT_TRUE(onLineButOne(three, 1e-3));
}

}  // namespace
}  // namespace slom::calibration
