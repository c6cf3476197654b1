// Transforms, compounds, names, streaming, statistics.
#include <random>
#include <sstream>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <mtk/mtk.hpp>

#include "support/message_of.hpp"

namespace {

using slom::testing::messageOf;

typedef mtk::vect<2> vec2;
typedef mtk::vect<3> vec3;
typedef mtk::SO3<> SO3;
typedef mtk::trafo<SO3> SE3;
typedef mtk::trafo<mtk::SO2<>> SE2;

struct BareCamera : mtk::vect<9> {};
MTK_BUILD_MANIFOLD(StereoCamera, ((BareCamera, left))((BareCamera, right))((SE3, left2right)))

struct Intrinsics : mtk::vect<4> {
  [[maybe_unused]] static constexpr std::array<std::string_view, 4> component_names{"fx", "fy", "cx", "cy"};
};

struct Head {
  StereoCamera cam;
  Intrinsics lens;
  mtk::SO2<> pan;
  mtk::Scalar<> gravity;
  double bias;
  mtk::S2<> up;
};

TEST(Trafo, ComposesAsMatricesDo) {
  std::mt19937 rng(1);
  std::normal_distribution<double> u(0, 2);
  for (int i = 0; i < 200; ++i) {
    const SE3 a(SO3::exp(vec3(u(rng), u(rng), u(rng))), vec3(u(rng), u(rng), u(rng)));
    const SE3 b(vec3(u(rng), u(rng), u(rng)), SO3::exp(vec3(u(rng), u(rng), u(rng))));
    const vec3 p(u(rng), u(rng), u(rng));
    const Eigen::Matrix4d A = a.matrix(), B = b.matrix();
    EXPECT_LT(((a * b).matrix() - A * B).norm(), 1e-13);
    EXPECT_LT((a.inverse().matrix() - A.inverse()).norm(), 1e-12);
    EXPECT_LT((a * p - (A * p.homogeneous()).head<3>()).norm(), 1e-13);
    EXPECT_LT(((a * b.orient).matrix() - A * SE3(b.orient).matrix()).norm(), 1e-13);
    EXPECT_LT(((a.orient * b).matrix() - SE3(a.orient).matrix() * B).norm(), 1e-13);

    const SE2 c(mtk::SO2<>(u(rng)), vec2(u(rng), u(rng))), d(mtk::SO2<>(u(rng)), vec2(u(rng), u(rng)));
    EXPECT_LT(((c * d).matrix() - c.matrix() * d.matrix()).norm(), 1e-13);
    EXPECT_LT((c.inverse().matrix() - c.matrix().inverse()).norm(), 1e-13);
    const vec2 q(u(rng), u(rng));
    EXPECT_LT((c * q - (c.matrix() * q.homogeneous()).head<2>()).norm(), 1e-13);
  }
}

TEST(Trafo, PerturbsPositionOutsideAndOrientationOnTheRight) {
  SE3 x(SO3::exp(vec3(0.3, -0.2, 0.9)), vec3(1, 2, 3));
  const SE3 before = x;
  x.boxplus((Eigen::Matrix<double, 6, 1>() << 0.1, 0.2, 0.3, 0.4, 0.5, 0.6).finished());
  EXPECT_LT((x.pos - vec3(1.1, 2.2, 3.3)).norm(), 1e-15);
  EXPECT_LT(mtk::difference(x.orient, before.orient * SO3::exp(vec3(0.4, 0.5, 0.6))).norm(), 1e-15);
}

std::string joined(const std::vector<std::string>& names) {
  std::string all;
  for (const auto& name : names) all += (all.empty() ? "" : " ") + name;
  return all;
}

TEST(Names, ComeFromMacroCompilerAndType) {
  EXPECT_EQ(joined(mtk::componentNames(SE3(), "pose")),
            "pose.pos.x pose.pos.y pose.pos.z pose.orient.x pose.orient.y pose.orient.z");
  EXPECT_EQ(joined(mtk::componentNames(SE2())), "pos.x pos.y orient.angle");
  EXPECT_EQ(joined(mtk::componentNames(mtk::Scalar<>(), "g")), "g");
  const auto dynamic = [](int size) { return joined(mtk::componentNames(mtk::vect<mtk::Dynamic>(size))); };
  EXPECT_EQ(dynamic(1), "0");  // as of vectors whose size the type says
  EXPECT_EQ(dynamic(2), "x y");
  EXPECT_EQ(dynamic(3), "x y z");
  EXPECT_EQ(dynamic(4), "0 1 2 3");
  EXPECT_EQ(joined(mtk::componentNames(mtk::vect<1>())), "0");
  const std::vector<std::string> stereo = mtk::componentNames(StereoCamera());
  ASSERT_EQ(stereo.size(), 24u);
  EXPECT_EQ(stereo[0], "left.0");
  EXPECT_EQ(stereo[17], "right.8");
  EXPECT_EQ(stereo[20], "left2right.pos.z");
#if MTK_HAS_MEMBER_NAMES
  EXPECT_EQ(joined(mtk::componentNames(Head{})).substr(0, 30), "cam.left.0 cam.left.1 cam.left");
  const std::vector<std::string> head = mtk::componentNames(Head{}, "head");
  ASSERT_EQ(head.size(), 33u);
  EXPECT_EQ(head[24], "head.lens.fx");
  EXPECT_EQ(head[28], "head.pan.angle");
  EXPECT_EQ(head[29], "head.gravity");
  EXPECT_EQ(head[30], "head.bias");
  EXPECT_EQ(head[32], "head.up.1");
#endif
}

TEST(Compound, HasTheConstructorOfAllMembers) {
  BareCamera left;
  left[3] = 7;
  const StereoCamera cam(left, BareCamera(), SE3(vec3(1, 2, 3)));
  EXPECT_EQ(cam.left[3], 7);
  EXPECT_EQ(cam.left2right.pos[2], 3);
  EXPECT_EQ(StereoCamera().right.norm(), 0);
}

template <class M>
void expectRoundTrip(const M& x) {
  std::stringstream text;
  text.precision(17);
  text << mtk::streamed(x);
  M back = mtk::moved(x, mtk::tangent_t<M>(mtk::tangent_t<M>::Ones(mtk::dof(x))));
  text >> mtk::streamed(back);
  EXPECT_FALSE(text.fail()) << text.str();
  EXPECT_LT(mtk::difference(back, x).norm(), 1e-15) << text.str();
}

TEST(Streaming, BringsEveryTypeBack) {
  Head head{};
  head.cam.left.setRandom();
  head.cam.left2right = SE3(SO3::exp(vec3(1, 2, 3)), vec3(1e-20, 1e20, 3));
  head.pan = mtk::SO2<>(-3);
  head.gravity = 9.81;
  head.bias = 1e-9;
  head.up = mtk::S2<>(1.0, 2.0, 3.0);
  expectRoundTrip(head);
  expectRoundTrip(head.cam);
  expectRoundTrip(SE2(mtk::SO2<>(3), vec2(1, 2)));
  expectRoundTrip(mtk::vect<mtk::Dynamic>{1, 2.5});
  expectRoundTrip(std::array<vec2, 2>{vec2(1, 2), vec2(3, 4)});
  expectRoundTrip(Eigen::Vector3d(1, 2, 3));
}

TEST(Streaming, RefusesWhatIsNoSuchValueAndKeepsTheOldOne) {
  const SO3 before = SO3::exp(vec3(0.1, 0.2, 0.3));
  for (const char* text : {"0 0 0 2", "0 0 0 0", "1 0 nan 0", "1 2 x 4", "0 0 1"}) {
    SO3 R = before;
    std::istringstream in(text);
    in >> R;
    EXPECT_TRUE(in.fail()) << text;
    EXPECT_EQ(R.coeffs(), before.coeffs()) << text;
  }
  vec3 v(1, 2, 3);
  std::istringstream in("4 5 six");
  in >> v;
  EXPECT_TRUE(in.fail());
  EXPECT_EQ(v, vec3(1, 2, 3));
  mtk::vect<mtk::Dynamic> dynamic{1};
  std::istringstream negative("-2 1 1");
  negative >> dynamic;
  EXPECT_TRUE(negative.fail());
  EXPECT_EQ(dynamic.size(), 1);
}

TEST(DynamicVector, RefusesAnotherSize) {
  mtk::vect<mtk::Dynamic> x{1, 2};
  try {
    x.boxplus(Eigen::Vector3d(1, 2, 3));
    FAIL();
  } catch (const mtk::Error& e) {
    EXPECT_STREQ(e.what(),
                 "[mtk.size-mismatch] the operands of x [+] d have 2 and 3 entries; give both the same size");
    EXPECT_EQ(e.id(), "mtk.size-mismatch");
  }
  EXPECT_EQ(x[1], 2);
}

TEST(Statistics, OfRotationsRecoverTheDistribution) {
  std::mt19937 rng(5);
  std::normal_distribution<double> normal;
  const SO3 center = SO3::exp(vec3(3.0, 0.2, -0.1));  // near pi
  const Eigen::Matrix3d L = (Eigen::Matrix3d() << 0.05, 0, 0, 0.02, 0.03, 0, -0.01, 0.01, 0.02).finished();
  std::vector<SO3> samples;
  for (int i = 0; i < 20000; ++i) {
    const vec3 d = L * vec3(normal(rng), normal(rng), normal(rng));
    samples.push_back(mtk::moved(center, d));
  }
  const SO3 mean = mtk::weightedMean(samples);
  // 5 standard errors.
  EXPECT_LT(mtk::difference(mean, center).norm(), 5 * 0.07 / std::sqrt(20000.0));
  const Eigen::Matrix3d covariance = mtk::weightedCovariance(samples, mean);
  EXPECT_LT((covariance - L * L.transpose()).norm(), 5 * 0.004 / std::sqrt(20000.0));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const SO3& R : samples) sum += mtk::difference(R, mean);
  EXPECT_LT(sum.norm() / 20000, 1e-13);
}

TEST(Statistics, WeightsCountAsRepetition) {
  const std::vector<mtk::SO2<>> samples{mtk::SO2<>(3.0), mtk::SO2<>(-3.0), mtk::SO2<>(3.1)};
  const std::vector<mtk::SO2<>> repeated{samples[0], samples[1], samples[1],
                                         samples[2], samples[2], samples[2]};
  const std::vector<double> weights{1, 2, 3};
  const auto mean = mtk::weightedMean(samples, weights);
  EXPECT_NEAR(mtk::difference(mean, mtk::weightedMean(repeated))[0], 0, 1e-15);
  EXPECT_NEAR(mtk::weightedCovariance(samples, mean, weights)(0, 0),
              mtk::weightedCovariance(repeated, mean)(0, 0), 1e-15);
}

TEST(Statistics, NameASampleThatIsNotFinite) {
  const std::vector<mtk::vect<2>> samples{mtk::vect<2>(1, 2), mtk::vect<2>(0, NAN), mtk::vect<2>(3, 4)};
  try {
    mtk::weightedMean(samples, {1, 5, 1});
    FAIL();
  } catch (const mtk::Error& e) {
    EXPECT_STREQ(
        e.what(),
        "[mtk.no-mean] sample 1 of 3 is not finite, or infinitely far from the others; leave such samples out");
  }
}

TEST(Statistics, SayWhatIsWrong) {
  const std::vector<double> none, two{1, 2}, negative{1, -1}, zeros{0, 0}, one{1};
  EXPECT_EQ(messageOf([&] { mtk::weightedMean(none); }),
            "[mtk.no-samples] the mean of no samples does not exist; pass at least one");
  EXPECT_EQ(messageOf([&] { mtk::weightedMean(two, one); }),
            "[mtk.weight-count] 1 weights for 2 samples; pass one weight for each sample, or none");
  EXPECT_EQ(messageOf([&] { mtk::weightedMean(two, negative); }),
            "[mtk.bad-weight] weight 1 is -1.000000; weights must be finite and not negative");
  EXPECT_EQ(messageOf([&] { mtk::weightedMean(two, zeros); }),
            "[mtk.bad-weight] all weights are zero; at least one must be positive");
}

}  // namespace
