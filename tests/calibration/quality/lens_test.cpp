// Rays of pixels, and derivatives of the projection.
#include "calibration/models/lens.hpp"

#include <gtest/gtest.h>

#include <slom/calibration.hpp>

namespace slom::calibration {
namespace {

CameraResult camera(const std::string& model, const std::vector<double>& values) {
  CameraResult result;
  result.model = model;
  for (const double value : values) result.parameters.push_back({"", value, 1});
  return result;
}
const CameraResult barrel = camera("opencv5", {600, 610, 330, 245, -0.25, 0.08, 0.001, -0.0005, 0.01});

TEST(Lens, DerivativesAreThoseOfTheProjection) {
  for (const CameraResult& one :
       {barrel, camera("opencv4", {500, 510, 320, 240, 0.1, -0.2, 0.002, 0.001}),
        camera("radial1", {700, 300, 200, -0.1}),
        camera("opencv8", {500, 510, 320, 240, 0.3, -0.1, 0.001, -0.002, 0.02, 0.5, -0.05, 0.01}),
        camera("fisheye", {300, 310, 320, 240, 0.05, -0.01, 3e-3, -4e-4}),
        camera("double_sphere", {300, 310, 320, 240, -0.2, 0.6})}) {
    const auto lens = lensOf(one);
    const vec3 point(0.3, -0.2, 1.1);
    const Lens::Projection at = lens.differentiate(point);
    EXPECT_TRUE(at.pixel.isApprox(lens.project(point), 1e-14));
    for (int i = 0; i < 3; ++i) {
      vec3 more = point, less = point;
      more[i] += 1e-6, less[i] -= 1e-6;
      EXPECT_LT((at.by_point.col(i) - (lens.project(more) - lens.project(less)) / 2e-6).norm(), 1e-5)
          << one.model << i;
    }
    ASSERT_EQ(at.by_parameters.cols(), lens.parameters());
    for (int i = 0; i < lens.parameters(); ++i) {
      CameraResult more = one, less = one;
      more.parameters[std::size_t(i)].value += 1e-6, less.parameters[std::size_t(i)].value -= 1e-6;
      const Eigen::Vector2d difference = (lensOf(more).project(point) - lensOf(less).project(point)) / 2e-6;
      EXPECT_LT((at.by_parameters.col(i) - difference).norm(), 1e-5) << one.model << i;
    }
  }
}

TEST(Lens, TheRayOfAPixelIsProjectedToIt) {
  const auto lens = lensOf(barrel);
  for (double u = 0; u <= 640; u += 40) {
    for (double v = 0; v <= 480; v += 40) {
      const auto ray = lens.unproject(vec2(u, v));
      ASSERT_TRUE(ray) << u << ", " << v;
      EXPECT_NEAR(ray->norm(), 1, 1e-12);
      EXPECT_LT((lens.project(*ray) - vec2(u, v)).norm(), 1e-6);
    }
  }
}

TEST(Lens, APixelBeyondTheFoldHasNoRay) {
  // r (1 - 0.5 r^2) is largest, 0.544, at r = 0.816: no ray reaches 600 * 0.544 = 327 px from the centre.
  const auto lens = lensOf(camera("radial1", {600, 320, 240, -0.5}));
  EXPECT_TRUE(lens.unproject(vec2(320 + 300, 240)));
  EXPECT_FALSE(lens.unproject(vec2(320 + 330, 240)));
  EXPECT_FALSE(lens.unproject(vec2(0, 0)));
}

/// Models of angles have rays beyond 90 degrees, in all directions of the image, those along its y axis included.
TEST(Lens, WideLensesHaveRaysBehindTheirPlane) {
  for (const CameraResult& one : {camera("fisheye", {300, 310, 640, 480, 0.01, -0.002, 0, 0}),
                                  camera("double_sphere", {300, 310, 640, 480, -0.1, 0.6})}) {
    const auto lens = lensOf(one);
    for (const double degree : {60.0, 89.9, 90.0, 95.0, 110.0}) {
      for (int k = 0; k < 16; ++k) {
        const double angle = degree * M_PI / 180, azimuth = 2 * M_PI * k / 16;
        const vec3 truth(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
                         std::cos(angle));
        const vec2 pixel = lens.project(truth);
        ASSERT_TRUE(pixel.allFinite()) << one.model << degree;
        const auto ray = lens.unproject(pixel);
        ASSERT_TRUE(ray) << one.model << ", " << degree << " degrees, azimuth " << azimuth;
        EXPECT_LT((*ray - truth).norm(), 1e-6) << one.model << degree;
      }
    }
  }
}

}  // namespace
}  // namespace slom::calibration
