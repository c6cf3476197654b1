// The verdict, word for word, for good calibrations and for each thing that can be wrong with one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <slom/calibration.hpp>

namespace slom::calibration {
namespace {

const std::string good_sentence =
    "Calibrated to 0.34 px with 10 images; at the distance of the boards, 0.60 m, the projection is known to 0.20 px in the middle of "
    "the image and to 1.1 px at the worst place, at infinity to 1.9 px";

Result goodResult() {
  Result result;
  result.converged = true;
  result.redundancy = 1000;
  result.rss = 990;
  CameraResult camera;
  camera.name = "left";
  camera.corners = 500;
  camera.rms_px = 0.34;
  result.cameras.push_back(camera);
  for (int i = 1; i <= 10; ++i) {
    ImageResult image;
    image.image = i;
    image.measurements = 100;
    image.chi2 = 95 + i;
    result.images.push_back(image);
  }
  CameraQuality quality;
  quality.projection.push_back({0.6, {0.2, 0.5, 1.1}, 0.2, 0.5, 1.1});
  quality.projection.push_back({std::numeric_limits<double>::infinity(), {0.3, 0.6, 1.9}, 0.3, 0.6, 1.9});
  quality.grid = {33, 25, {640, 480, false}};
  quality.focal_std = 0.002;
  quality.centre_std_px = 1;
  quality.tilt_spread = 0.5;
  result.quality.emplace();
  result.quality->cameras.push_back(quality);
  result.quality->split_half.cameras.push_back({{}, 0.3, 0.9, 0.3, 9, 9, 0.4});
  WorstResidual worst;
  worst.corner.image = 3;
  worst.corner.corner = 12;
  worst.error_px = 1.2;
  result.quality->worst.push_back(worst);
  return result;
}

void expectDoubts(const Result& result, const std::vector<std::string>& doubts) {
  const Verdict verdict = verdictOf(result);
  EXPECT_EQ(verdict.doubts, doubts);
  EXPECT_EQ(verdict.level, Verdict::Level::doubtful);
  EXPECT_EQ(verdict.sentence, fmt::format("{}; but {}.", good_sentence, doubts.front()));
}

TEST(Verdict, OfAGoodCalibration) {
  const Verdict verdict = verdictOf(goodResult());
  EXPECT_EQ(verdict.level, Verdict::Level::trustworthy);
  EXPECT_EQ(verdict.sentence, fmt::format("{}.", good_sentence));
  EXPECT_TRUE(verdict.doubts.empty());
}

TEST(Verdict, NamesABadImage) {
  Result result = goodResult();
  result.images[6].chi2 = 900;
  expectDoubts(result, {"the residuals of image 7 are 3.0 times the usual ones; check the image"});
}

TEST(Verdict, NamesABadCorner) {
  Result result = goodResult();
  result.quality->worst[0].error_px = 4.2;
  expectDoubts(result, {"corner 12 of image 3 of left is 4.2 px off"});
}

TEST(Verdict, NamesAStray) {
  Result result = goodResult();
  result.strays.push_back({"left", 4, 33});
  expectDoubts(result, {"image 4 of camera left contradicts the others by 33 px"});
}

TEST(Verdict, ComparesHalvesWithNoise) {
  Result result = goodResult();
  result.quality->split_half.cameras[0] = {{}, 1.3, 4, 0.3, 80, 9, 1e-12};
  expectDoubts(
      result,
      {"two halves of the images of left disagree by 1.3 px, more than the 0.30 px from noise alone"});
  result.quality->split_half.cameras[0].rms_px = 0.4;  // significant, and of no importance
  EXPECT_EQ(verdictOf(result).level, Verdict::Level::trustworthy);
}

TEST(Verdict, HalvesThatCannotBeComparedAreADoubt) {
  for (const int number : {0, 1, 2}) {
    Result result = goodResult();
    SplitHalfCamera& camera = result.quality->split_half.cameras[0];
    (number == 0 ? camera.rms_px : number == 1 ? camera.expected_rms_px : camera.probability) = unknown;
    expectDoubts(result, {"two halves of the images of left cannot be compared, because one of them gives no "
                          "usable lens"});
  }
}

TEST(Verdict, ComparesResidualsWithTheStatedNoise) {
  Result result = goodResult();
  result.rss = 9000;
  expectDoubts(result, {"the residuals are 3.0 times as large as the stated sigmas predict, so all "
                        "uncertainties here are too small by about that factor"});
}

TEST(Verdict, SeesAnImageThatIsNotCovered) {
  Result result = goodResult();
  result.quality->cameras[0].projection[0].std_px = {0.2, unknown, 1.1, 1.1};
  expectDoubts(
      result,
      {"the lens model of left has no ray for 25 % of its image: it folds over there, outside the corners"});
  result = goodResult();
  result.quality->cameras[0].projection[0].worst_px = 12;
  EXPECT_EQ(verdictOf(result).doubts,
            std::vector<std::string>{"corners do not reach far enough into the image of left, so its "
                                     "projection is uncertain by up to 12 px"});
}

TEST(Verdict, OfFailedFits) {
  Result result = goodResult();
  result.undetermined = "left.fx and left2world can move together";
  EXPECT_EQ(verdictOf(result).level, Verdict::Level::failed);
  EXPECT_EQ(verdictOf(result).sentence,
            "The images do not determine all parameters: left.fx and left2world can move together. The "
            "values below must not be used.");
  result.undetermined = "";
  result.converged = false;
  result.stop_reason = "iteration limit reached";
  EXPECT_EQ(verdictOf(result).sentence,
            "The calibration did not converge: iteration limit reached. The values below must not be used.");
}

}  // namespace
}  // namespace slom::calibration
