// The order of views does not matter: the same bits come out.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "calibration/rig_in_memory.hpp"

namespace slom::calibration {
namespace {

using testing::pinholeWithDistortion;
using testing::rigInMemory;

Dataset shuffled(Dataset data) {
  std::reverse(data.cameras[0].views.begin(), data.cameras[0].views.end());
  std::rotate(data.cameras[1].views.begin(), data.cameras[1].views.begin() + 2, data.cameras[1].views.end());
  return data;
}

std::vector<std::uint64_t> bitsOf(const Result& result) {
  std::vector<std::uint64_t> bits;
  const auto add = [&](double number) { bits.push_back(std::bit_cast<std::uint64_t>(number)); };
  add(result.rss);
  for (const CameraResult& camera : result.cameras) {
    for (const Parameter& p : camera.parameters) add(p.value), add(p.std);
    for (const double x : camera.left2camera.pos) add(x);
    add(camera.rms_px), add(camera.rms_px_single);
  }
  for (const double x : result.imu->acc_bias) add(x);
  for (const ImageResult& image : result.images) {
    bits.push_back(std::uint64_t(image.image));
    add(image.chi2), add(image.worst_corner.error_px);
    for (const double x : image.left2world.pos) add(x);
  }
  return bits;
}

std::vector<std::uint64_t> bitsOf(const Quality& quality) {
  std::vector<std::uint64_t> bits;
  const auto add = [&](double number) { bits.push_back(std::bit_cast<std::uint64_t>(number)); };
  for (const CameraQuality& camera : quality.cameras) {
    for (const CornerResidual& r : camera.residuals) add(r.image), add(r.residual.x()), add(r.residual.y());
    for (const ProjectionUncertainty& map : camera.projection) add(map.middle_px), add(map.worst_px);
  }
  for (const SplitHalfCamera& camera : quality.split_half.cameras) add(camera.rms_px), add(camera.chi2);
  for (const double x : quality.correlations.matrix) add(x);
  for (const FurtherView& view : quality.further_views) add(view.after_px);
  return bits;
}

TEST(Order, OfViewsDoesNotMatter) {
  const Dataset sorted = rigInMemory(), other = shuffled(sorted);
  const Settings settings = pinholeWithDistortion();
  const Result expected = calibrate(sorted, settings), result = calibrate(other, settings);
  EXPECT_EQ(bitsOf(result), bitsOf(expected));
  EXPECT_EQ(bitsOf(assess(other, settings, result)), bitsOf(assess(sorted, settings, expected)));
  const vec2 pixel(100., 50.);
  EXPECT_EQ(PixelUncertainty(other, result).at(1, pixel)->matrix(),
            PixelUncertainty(sorted, expected).at(1, pixel)->matrix());
  const Comparison all = compareModels(sorted, settings, {Model("radial1")}),
                   same = compareModels(other, settings, {Model("radial1")});
  EXPECT_EQ(all.trials[0].held_out_squares, same.trials[0].held_out_squares);
  EXPECT_EQ(all.trials[0].rss, same.trials[0].rss);
}

TEST(Order, OfTheCallerStays) {
  const Dataset data = shuffled(rigInMemory());
  std::set<const CameraData*> reported;
  Progress progress;
  progress.single_camera = [&](const SingleCameraReport& report) { reported.insert(report.camera); };
  calibrate(data, pinholeWithDistortion(), progress);
  EXPECT_EQ(reported, (std::set<const CameraData*>{&data.cameras[0], &data.cameras[1]}));
  EXPECT_EQ(data.cameras[0].views.front().image, 5);
  for (int image = 0; image < 6; ++image) {
    ASSERT_NE(data.cameras[0].find(image), nullptr);
    EXPECT_EQ(data.cameras[0].find(image)->image, image);
  }
  EXPECT_EQ(data.cameras[0].find(6), nullptr);
}

TEST(Order, OfViewsIsRisingWhenCopiesHaveBeenLeftOut) {
  Dataset data = rigInMemory();
  data.cameras[0].views[4].corners = data.cameras[0].views[1].corners;
  data = shuffled(data);
  leaveOutCopies(data);
  ASSERT_EQ(data.cameras[0].copies.size(), 1u);
  EXPECT_EQ(data.cameras[0].copies[0].image, 4);
  EXPECT_EQ(data.cameras[0].copies[0].original, 1);
  std::vector<int> images;
  for (const View& view : data.cameras[0].views) images.push_back(view.image);
  EXPECT_EQ(images, (std::vector<int>{0, 1, 2, 3, 5}));
}

}  // namespace
}  // namespace slom::calibration
