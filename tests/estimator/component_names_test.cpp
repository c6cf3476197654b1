// Components of a manifold of the user's own have the names that it states: docs/manifolds.md.
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include <slom/slom.hpp>

#include "support/message_of.hpp"

namespace {

// clang-format off
struct Tilt {
  using scalar = double;
  static constexpr int DOF = 2;
  static constexpr std::array<std::string_view, 2> component_names{"roll", "pitch"};
  double roll = 0, pitch = 0;  // [rad]
  void boxplus(mtk::vectview<const double, 2> d, double scale = 1) {
    roll += scale * d[0];
    pitch += scale * d[1];
  }
  void boxminus(mtk::vectview<double, 2> out, const Tilt& y) const {
    out[0] = roll - y.roll;
    out[1] = pitch - y.pitch;
  }
};
// clang-format on

MTK_BUILD_MANIFOLD(Arm, ((Tilt, mount))((double, length)))

TEST(ComponentNames, AreThoseThatTheTypeStates) {
  slom::Estimator est;
  // clang-format off
  const auto tilt = est.insertRV(Tilt(), "tilt");
  est.fix(tilt, "pitch");  // the report lists tilt.roll alone
  // clang-format on
  est.insertMeasurement([](const Tilt& t) { return mtk::vector(t.roll - 0.1, t.pitch); }, tilt,
                        slom::StandardDeviation(0.01));
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged) << summary;
  ASSERT_EQ(summary.parameters.size(), 1u);
  EXPECT_EQ(summary.parameters[0].name, "tilt.roll");
  EXPECT_NEAR(tilt->roll, 0.1, 1e-9);
  EXPECT_EQ(slom::testing::messageOf([&] { est.fix(tilt, "yaw"); }),
            "[slom.no-component] variable tilt has no component \"yaw\"; pass one of roll, pitch");
  const auto arm = est.insertRV(Arm(), "arm");
  est.fix(arm, "mount.roll");
  EXPECT_EQ(est.getN(), 3);
}

}  // namespace
