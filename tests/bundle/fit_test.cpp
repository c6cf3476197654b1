// Results of the fit, against known truth and against an independent sum of squares.
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <slom/io/bal.hpp>

#include "bundle/bundle_command.hpp"
#include "bundle/scene.hpp"

namespace slom::app::bundle {
namespace {

using Eigen::Vector3d;
using testing::fitted;
using testing::perturbed;
using testing::RawScene;
using testing::simulated;

/// Rotation vectors near 0, near pi and beyond; points around the camera.
RawScene hardPlaces() {
  RawScene scene;
  testing::Noise noise(3);
  const double angles[] = {0, 1e-12, 1e-5, 0.5, 3.1415, 3.14159265358979, 4, 7};
  for (const double angle : angles) {
    Vector3d axis(noise(1), noise(1), noise(1));
    axis *= angle / axis.norm();
    scene.cameras.push_back(
        {axis[0], axis[1], axis[2], noise(1), noise(1), noise(1), 500 + noise(100), noise(0.1), noise(0.02)});
    scene.points.push_back({noise(5), noise(5), noise(5)});
  }
  for (int c = 0; c < 8; ++c) {
    for (int p = 0; p < 8; ++p) scene.observations.push_back({c, p, noise(100), noise(100)});
  }
  return scene;
}

TEST(BundleFit, ResidualIsThatOfTheFormat) {
  const RawScene raw = hardPlaces();
  const Scene scene = io::parseScene("scene.txt", testing::contentOf(raw));
  for (std::size_t i = 0; i < raw.observations.size(); ++i) {
    const auto& o = raw.observations[i];
    const auto pixel = testing::pixelOf(raw.cameras[std::size_t(o.camera)], raw.points[std::size_t(o.point)]);
    const mtk::vect<2> residual = scene.residual(scene.observations[i]);
    const double size = 1e-10 * (1 + std::hypot(pixel[0], pixel[1]));
    EXPECT_NEAR(residual[0], pixel[0] - o.u, size) << "camera " << o.camera << ", point " << o.point;
    EXPECT_NEAR(residual[1], pixel[1] - o.v, size) << "camera " << o.camera << ", point " << o.point;
  }
  EXPECT_NEAR(scene.sumOfSquares(), testing::sumOfSquares(raw), 1e-10 * testing::sumOfSquares(raw));
}

/// The similarity world_T_fit that brings the fitted points to the true ones.
struct Similarity {
  double scale;
  Eigen::Matrix3d Q;
  Vector3d T;
  Vector3d operator*(const Vector3d& x) const { return scale * Q * x + T; }
};
Vector3d vectorOf(const testing::RawPoint& p) { return {p[0], p[1], p[2]}; }
Similarity similarity(const RawScene& from, const RawScene& to) {
  const auto n = Eigen::Index(from.points.size());
  Eigen::Matrix3Xd a(3, n), b(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    a.col(i) = vectorOf(from.points[std::size_t(i)]);
    b.col(i) = vectorOf(to.points[std::size_t(i)]);
  }
  const Eigen::Matrix4d H = Eigen::umeyama(a, b);
  const double scale = std::cbrt(H.topLeftCorner<3, 3>().determinant());
  return {scale, H.topLeftCorner<3, 3>() / scale, H.topRightCorner<3, 1>()};
}
Eigen::Matrix3d rotationOf(const testing::RawCamera& c) {
  Eigen::Matrix3d R;
  for (int k = 0; k < 3; ++k) R.col(k) = testing::rotated({c[0], c[1], c[2]}, Vector3d::Unit(k));
  return R;
}
Vector3d centreOf(const testing::RawCamera& c) {
  return -rotationOf(c).transpose() * Vector3d(c[3], c[4], c[5]);
}

TEST(BundleFit, FindsTheTruthUpToASimilarity) {
  const RawScene truth = simulated(5, 40, 0, 11);
  const auto result = fitted(perturbed(truth, 0.02, 12), {"--tolerance", "1e-12"});
  EXPECT_GT(result.json["initial_rss"], 1e3);
  EXPECT_LT(result.json["final_rss"], 1e-12);
  const Similarity truth_T_fit = similarity(result.scene, truth);
  for (std::size_t i = 0; i < truth.points.size(); ++i) {
    EXPECT_LT((truth_T_fit * vectorOf(result.scene.points[i]) - vectorOf(truth.points[i])).norm(), 1e-6) << i;
  }
  for (std::size_t i = 0; i < truth.cameras.size(); ++i) {
    const auto &camera = result.scene.cameras[i], &expected = truth.cameras[i];
    EXPECT_LT((truth_T_fit * centreOf(camera) - centreOf(expected)).norm(), 1e-6) << i;
    EXPECT_LT((rotationOf(camera) * truth_T_fit.Q.transpose() - rotationOf(expected)).norm(), 1e-6) << i;
    EXPECT_NEAR(camera[6], expected[6], 1e-4) << i;
    EXPECT_NEAR(camera[7], expected[7], 1e-6) << i;
    EXPECT_NEAR(camera[8], expected[8], 1e-6) << i;
  }
}

TEST(BundleFit, RssIsTheSumOfSquaredPixelErrorsAndMinimal) {
  const RawScene start = perturbed(simulated(4, 30, 0.5, 5), 0.02, 6);
  const auto result = fitted(start, {"--tolerance", "1e-12"});
  const double rss = result.json["final_rss"];
  EXPECT_NEAR(result.json["initial_rss"].get<double>(), testing::sumOfSquares(start),
              1e-10 * testing::sumOfSquares(start));
  EXPECT_NEAR(testing::sumOfSquares(result.scene), rss, 1e-10 * rss);
  EXPECT_LT(rss, 2 * 0.25 * 4 * 30);
  RawScene scene = result.scene;
  const auto expectMinimum = [&](double& number, double h) {
    const double x = number, middle = testing::sumOfSquares(scene);
    double side[2];
    for (int k = 0; k < 2; ++k) {
      number = x + (k == 0 ? h : -h);
      side[k] = testing::sumOfSquares(scene);
    }
    number = x;
    const double slope = (side[0] - side[1]) / 2, curvature = side[0] - 2 * middle + side[1];
    EXPECT_LT(slope * slope / (2 * curvature), 1e-6 * rss);
  };
  for (auto& camera : scene.cameras) {
    for (std::size_t k = 0; k < 9; ++k) expectMinimum(camera[k], k == 6 ? 1e-2 : 1e-5);
  }
  for (auto& point : scene.points) {
    for (double& x : point) expectMinimum(x, 1e-5);
  }
}

double huber(double s) { return s <= 1 ? s : 2 * std::sqrt(s) - 1; }

TEST(BundleFit, RobustRssIsTheSumOfTheLosses) {
  RawScene start = perturbed(simulated(4, 30, 0.5, 5), 0.02, 6);
  start.observations[17].u += 40;
  const auto robustRss = [](const RawScene& scene) {
    double sum = 0;
    for (const auto& o : scene.observations) sum += huber(testing::squaredError(scene, o));
    return sum;
  };
  const auto result = fitted(start, {"--robust", "huber:1.0"});
  const double initial = result.json["initial_rss"], rss = result.json["final_rss"];
  EXPECT_NEAR(initial, robustRss(start), 1e-10 * initial);
  EXPECT_NEAR(rss, robustRss(result.scene), 1e-10 * rss);
  EXPECT_LT(rss, initial / 10);
  EXPECT_GT(std::sqrt(testing::squaredError(result.scene, result.scene.observations[17])), 35)
      << "the outlier is left alone";
}

TEST(BundleFit, TheGaugeIsFreeYetTheSceneStaysWhereItStarts) {
  const RawScene start = perturbed(simulated(5, 40, 0.3, 21), 0.005, 22);
  const auto result = fitted(start);
  const Similarity move = similarity(result.scene, start);
  EXPECT_NEAR(move.scale, 1, 0.02);
  EXPECT_LT(move.T.norm(), 0.1);
}

TEST(BundleFit, ThreadsDoNotChangeTheResult) {
  const RawScene start = perturbed(simulated(6, 100, 0.5, 31), 0.01, 32);
  const auto one = fitted(start, {"--threads", "1"}), two = fitted(start, {"--threads", "2"});
  EXPECT_EQ(one.bal, two.bal);
  EXPECT_EQ(one.json["threads"], 1);
  EXPECT_EQ(two.json["threads"], 2);
}

TEST(BundleFit, ASmallerToleranceGoesFurther) {
  const RawScene start = perturbed(simulated(4, 30, 0.5, 5), 0.02, 6);
  const auto coarse = fitted(start, {"--tolerance", "0.5"}), fine = fitted(start, {"--tolerance", "1e-12"});
  EXPECT_LT(coarse.json["iterations"], fine.json["iterations"]);
  EXPECT_EQ(coarse.json["stop_reason"], "relative decrease below tolerance");
  EXPECT_LT(fine.json["final_rss"], coarse.json["final_rss"]);
}

}  // namespace
}  // namespace slom::app::bundle
