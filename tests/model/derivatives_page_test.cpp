// The code of docs/derivatives.md, as it stands there.
// Pages show code of this file as it stands.
// clang-format off
#include <regex>

#include <gtest/gtest.h>

#include "slom/slom.hpp"

namespace {

using SE3 = mtk::trafo<mtk::SO3<>>;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;

template <class S>
struct SimpleCameraOf {
  mtk::trafo<mtk::SO3<S>> pose;
  S focal{}, k1{};
};
using SimpleCamera = SimpleCameraOf<double>;

struct Observation {
  Vec3 operator()(const mtk::SO3<>& R, const Vec3& direction) const { return R * direction; }
  void jacobian(const mtk::SO3<>& R, const Vec3& direction, auto& by_R) const {
    Eigen::Matrix3d cross;
    cross << 0, -direction[2], direction[1], direction[2], 0, -direction[0], -direction[1], direction[0], 0;
    by_R = -R.toRotationMatrix() * cross;
  }
};

struct WrongObservation : Observation {
  void jacobian(const mtk::SO3<>& R, const Vec3& direction, auto& by_R) const {
    Observation::jacobian(R, direction, by_R);
    by_R = -by_R;
  }
};

TEST(PageOfDerivatives, SaysWhatHappens) {
  slom::Estimator est;
  const auto camera = est.insertRV(SimpleCamera{SE3(Vec3(0, 0, 4)), 500, 0.01}, "camera");
  const auto point = est.insertRV(Vec3(0.5, 0.3, 1), "point");
  const auto from = est.insertRV(SE3(), false, "from"), to = est.insertRV(SE3(Vec3(1, 0, 0)), "to");
  const auto R = est.insertRV(mtk::SO3<>::exp(Vec3(0.3, -0.8, 0.4)), "R");
  const SE3 odometry(mtk::SO3<>::exp(Vec3(0, 0, 0.1)), Vec3(1, 0.1, 0));
  est.insertMeasurement(
      [](const auto& camera, const auto& point, const Vec2& pixel) {
        using std::sqrt;
        const auto p = camera.pose * point;
        const auto r = sqrt(p[0] * p[0] + p[1] * p[1]) / p[2];
        const auto scale = camera.focal * (1.0 + camera.k1 * r * r) / p[2];
        return mtk::vector(scale * p[0] - pixel[0], scale * p[1] - pixel[1]);
      },
      camera, point, Vec2(310, 155), slom::StandardDeviation(0.25), slom::named("reprojection"));
  est.insertMeasurement(slom::vectorized([](const auto& a, const auto& b) { return a.inverse() * b; }), from, to,
                        slom::measured(odometry), slom::StandardDeviation(0.1));
  est.insertMeasurement(Observation(), R, Vec3(1, 2, 3));
  const slom::DerivativeCheck check = slom::checkDerivatives(est);
  EXPECT_TRUE(check.ok()) << check;
  ASSERT_EQ(check.groups.size(), 3u);
  EXPECT_EQ(check.groups[0].source, slom::DerivativeSource::exact);
  EXPECT_EQ(check.groups[1].source, slom::DerivativeSource::exact);
  EXPECT_EQ(check.groups[2].source, slom::DerivativeSource::given);
}

TEST(PageOfDerivatives, ShowsWhatTheCheckPrints) {
  slom::Estimator est;
  const auto R = est.insertRV(mtk::SO3<>::exp(Vec3(0.3, -0.8, 0.4)), "R");
  est.insertMeasurement(WrongObservation(), R, Vec3(1, 2, 3), slom::named("observation"));
  EXPECT_EQ(slom::checkDerivatives(est).text(),
            "observation: given derivatives of 1 measurement do NOT agree with differences; worst: d residual[1] / d R.x of observation #1 "
            "is 3.46384, by differences -3.46384\n  guess: the sign is wrong\n");
}

}  // namespace
