// The manifold axioms for every type of mtk, compounds and users' types, in float and double.
#include <gtest/gtest.h>

#include <mtk/mtk.hpp>
#include <mtk/testing/axioms.hpp>

namespace {

template <class S>
struct Camera : mtk::vect<9, S> {};

template <class S>
struct Rig {
  Camera<S> left;
  mtk::trafo<mtk::SO3<S>> left2right;
  S gravity;
  std::array<mtk::SO2<S>, 2> joints;
};

typedef mtk::vect<2> vec2;
typedef mtk::trafo<mtk::SO3<>> SE3;
MTK_BUILD_MANIFOLD(Macro, ((vec2, point))((SE3, pose)))
MTK_BUILD_MANIFOLD(Nested, ((Macro, inner))((Rig<double>, rig))((mtk::S2<>, up)))

/// A user's type that owes nothing to mtk's: an angle kept in degrees.
struct Heading {
  using scalar = double;
  static constexpr int DOF = 1;
  double degrees = 0;
  void boxplus(mtk::vectview<const double, 1> d, double scale = 1) {
    degrees = std::remainder(degrees + scale * d[0] * 180 / M_PI, 360.0);
  }
  void boxminus(mtk::vectview<double, 1> out, const Heading& y) const {
    out[0] = std::remainder(degrees - y.degrees, 360.0) * M_PI / 180;
  }
  friend std::ostream& operator<<(std::ostream& os, const Heading& h) { return os << h.degrees; }
};

/// A heading whose [-] has the wrong sign: the harness must detect it.
struct Wrong : Heading {
  void boxminus(mtk::vectview<double, 1> out, const Wrong& y) const {
    out[0] = std::remainder(y.degrees - degrees, 360.0) * M_PI / 180;
  }
};

struct PlainCamera : mtk::vect<9> {};
namespace documented {
using Camera = PlainCamera;
struct Head {
  Camera left, right;
  mtk::trafo<mtk::SO3<>> left2right;
  double gravity;
};
}  // namespace documented

template <class M>
class Axioms : public ::testing::Test {};
using Types =
    ::testing::Types<double, float, mtk::Scalar<double>, mtk::Scalar<float>, mtk::vect<1>, mtk::vect<3>,
                     mtk::vect<7, float>, Eigen::Vector2d, mtk::SO2<double>, mtk::SO2<float>,
                     mtk::SO3<double>, mtk::SO3<float>, mtk::S2<double>, mtk::S2<float>,
                     mtk::trafo<mtk::SO2<double>>, mtk::trafo<mtk::SO2<float>>, mtk::trafo<mtk::SO3<double>>,
                     mtk::trafo<mtk::SO3<float>>, std::array<mtk::SO3<double>, 2>, Camera<double>,
                     Rig<double>, Rig<float>, Macro, Nested, Heading, documented::Head>;
TYPED_TEST_SUITE(Axioms, Types);

TYPED_TEST(Axioms, Hold) {
  TypeParam start{};
  if constexpr (std::is_same_v<TypeParam, Eigen::Vector2d>) start.setZero();  // Eigen leaves it uninitialised
  const auto report = mtk::testing::checkAxioms(start);
  EXPECT_TRUE(report.ok()) << report.text();
  EXPECT_GT(report.checks(), 1000);
}

TEST(Axioms, HoldForVectorsBeyondPi) {
  mtk::testing::AxiomOptions options;
  options.radius = std::numeric_limits<double>::infinity();
  const auto report = mtk::testing::checkAxioms(mtk::vect<4>(1e6, 0, -1e-9, 3), options);
  EXPECT_TRUE(report.ok()) << report.text();
}

TEST(Axioms, HoldForDynamicVectorsAndCompoundsOfThem) {
  struct WithDynamic {
    mtk::vect<mtk::Dynamic> coefficients;
    mtk::SO3<> R;
  };
  EXPECT_EQ(mtk::DOF_v<WithDynamic>, mtk::Dynamic);
  const WithDynamic x{mtk::vect<mtk::Dynamic>{1, 2, 3, 4}, {}};
  EXPECT_EQ(mtk::dof(x), 7);
  const auto report = mtk::testing::checkAxioms(x);
  EXPECT_TRUE(report.ok()) << report.text();
  const auto plain = mtk::testing::checkAxioms(Eigen::VectorXd(Eigen::VectorXd::Ones(3)));
  EXPECT_TRUE(plain.ok()) << plain.text();
}

TEST(Axioms, HarnessFindsAWrongSign) {
  const auto report = mtk::testing::checkAxioms(Wrong{});
  EXPECT_FALSE(report.ok());
  EXPECT_NE(report.text().find("(x [+] d) [-] x = d is off by"), std::string::npos) << report.text();
}

TEST(Axioms, NoThing) {
  static_assert(!mtk::Manifold<std::string>);
  static_assert(!mtk::Manifold<int>);
  static_assert(!mtk::Manifold<std::vector<double>>);
  static_assert(!mtk::Manifold<Eigen::RowVector3d>);
  static_assert(!mtk::Manifold<Eigen::Matrix3d>);
  struct Empty {};
  struct WithText {
    mtk::vect<2> a;
    std::string b;
  };
  static_assert(!mtk::Manifold<Empty> && !mtk::Manifold<WithText>);
}

}  // namespace
