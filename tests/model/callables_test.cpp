// Callables as measurements: accepted arguments, sources of derivatives, and agreement of all ways.
#include <array>
#include <limits>
#include <random>
#include <string>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "model/allocations.hpp"
#include "slom/slom.hpp"
#include "support/message_of.hpp"

namespace {

using slom::testing::allocations;
using slom::testing::messageOf;
using SE2 = mtk::trafo<mtk::SO2<>>;
using SE3 = mtk::trafo<mtk::SO3<>>;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;

MTK_BUILD_MANIFOLD(Rig, ((SE3, pose))((Vec3, lens)))
template <class S>
struct FrameOf {
  mtk::SO3<S> orient;
  mtk::S2<S> axis;
  std::array<mtk::SO2<S>, 2> joints;
  S scale{};
};
using Frame = FrameOf<double>;

class Random {
 public:
  double operator()() { return normal_(engine_); }
  Vec3 vec3(double size) { return Vec3(size * (*this)(), size * (*this)(), size * (*this)()); }
  SE3 se3() { return SE3(mtk::SO3<>::exp(vec3(1)), vec3(2)); }

 private:
  std::mt19937 engine_{7};
  std::normal_distribution<double> normal_;
};

/// Gradient and RSS after one linearisation, as sent to the solver.
struct Seen {
  double rss;
  Eigen::MatrixXd information;
};
template <class... Id>
Seen seen(const slom::Estimator& est, const Id&... ids) {
  Seen result{est.getRSS(), {}};
  Eigen::MatrixXd stacked(0, 0);
  const auto add = [&](const Eigen::MatrixXd& block) {
    Eigen::MatrixXd larger =
        Eigen::MatrixXd::Zero(stacked.rows() + block.rows(), stacked.cols() + block.cols());
    larger.topLeftCorner(stacked.rows(), stacked.cols()) = stacked;
    larger.bottomRightCorner(block.rows(), block.cols()) = block;
    stacked = larger;
  };
  (add(est.covariance(ids)), ...);
  result.information = stacked.inverse();
  return result;
}

struct Relative {
  auto operator()(const auto& a, const auto& b) const { return a.inverse() * b; }
};

/// The relative pose by hand: residual (a^-1 b) [-] z and its Jacobians.
struct RelativeByHand {
  Eigen::Matrix<double, 6, 1> operator()(const SE3& a, const SE3& b, const SE3& z) const {
    return mtk::difference(SE3(a.inverse() * b), z);
  }
  template <class JA, class JB>
  void jacobian(const SE3& a, const SE3& b, const SE3& z, JA& by_a, JB& by_b) const {
    const Eigen::Matrix3d Ra = a.orient.toRotationMatrix(), Rb = b.orient.toRotationMatrix();
    const Vec3 p = a.orient.inverse() * (b.pos - a.pos);
    const Vec3 v = mtk::SO3<>::log(z.orient.inverse() * (a.orient.inverse() * b.orient));
    const Eigen::Matrix3d V = cross(v);
    const double t = v.norm(), c = t < 1e-4 ? 1.0 / 12 : (1 - t / 2 / std::tan(t / 2)) / (t * t);
    const Eigen::Matrix3d J = Eigen::Matrix3d::Identity() + 0.5 * V + c * V * V;
    by_a.setZero();
    by_b.setZero();
    by_a.template topLeftCorner<3, 3>() = -Ra.transpose();
    by_a.template topRightCorner<3, 3>() = cross(p);
    by_a.template bottomRightCorner<3, 3>() = -J * Rb.transpose() * Ra;
    by_b.template topLeftCorner<3, 3>() = Ra.transpose();
    by_b.template bottomRightCorner<3, 3>() = J;
  }
  static Eigen::Matrix3d cross(const Vec3& v) {
    return (Eigen::Matrix3d() << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0).finished();
  }
};

/// A chain of poses; `insert(est, a, b, z)` adds one relative measurement.
template <class Insert>
Seen chain(const Insert& insert, int length, std::string* source = nullptr) {
  Random random;
  slom::Estimator est;
  std::vector<slom::VarID<SE3>> poses;
  for (int i = 0; i <= length; ++i) poses.push_back(est.insertRV(random.se3(), i > 0));
  for (int i = 0; i < length; ++i) {
    SE3 z = poses[std::size_t(i)]->inverse() * *poses[std::size_t(i + 1)];
    const Eigen::Matrix<double, 6, 1> d = 0.1 * Eigen::Matrix<double, 6, 1>::Random();
    mtk::boxplus<SE3>(z, d);
    insert(est, poses[std::size_t(i)], poses[std::size_t(i + 1)], z);
  }
  if (source != nullptr) {
    slom::Options none;
    none.max_iterations = 0;
    *source = est.optimize(none).groups[0].derivatives;
  }
  return seen(est, poses.back(), poses[std::size_t(length) / 2 + 1]);
}

TEST(Derivatives, ComeFromWhereTheSummarySaysAndAgree) {
  const auto sigma = slom::StandardDeviation(0.1);
  for (const int length : {1, 2, 3, 4, 5, 9}) {
    std::srand(1);
    std::string source;
    const Seen exact =
        chain([&](auto& est, auto a, auto b,
                  const SE3& z) { est.insertMeasurement(Relative(), a, b, slom::measured(z), sigma); },
              length, &source);
    EXPECT_EQ(source, "exact");
    const auto compare = [&](const char* expected, double tolerance, const auto& insert) {
      std::srand(1);
      const Seen other = chain(insert, length, &source);
      EXPECT_EQ(source, expected);
      EXPECT_NEAR(other.rss, exact.rss, 1e-13 * exact.rss) << length;
      EXPECT_LE((other.information - exact.information).norm(), tolerance * exact.information.norm())
          << length;
    };
    compare("exact", 1e-12, [&](auto& est, auto a, auto b, const SE3& z) {
      est.insertMeasurement(slom::vectorized(Relative()), a, b, slom::measured(z), sigma);
    });
    compare("given", 1e-12, [&](auto& est, auto a, auto b, const SE3& z) {
      est.insertMeasurement(RelativeByHand(), a, b, z, sigma);
    });
    compare("numeric", 1e-8, [&](auto& est, auto a, auto b, const SE3& z) {
      est.insertMeasurement(slom::numeric(Relative()), a, b, slom::measured(z), sigma);
    });
    compare("numeric", 1e-10, [&](auto& est, auto a, auto b, const SE3& z) {
      est.insertMeasurement(slom::numeric(Relative(), slom::Richardson()), a, b, slom::measured(z), sigma);
    });
    compare("numeric", 1e-8, [&](auto& est, auto a, auto b, const SE3& z) {
      est.insertMeasurement(
          [](const SE3& from, const SE3& to, const SE3& datum) -> Eigen::VectorXd {
            return mtk::difference(SE3(from.inverse() * to), datum);
          },
          a, b, z, sigma);
    });
  }
}

double freeFunction(double x, const Vec2& z) { return x * z[0] - z[1]; }
template <class S>
S quadratic(const S& x) {
  return x * x - 2.0;
}
struct Line {
  double slope = 1, offset = 0;
  double at(double x) const { return slope * x + offset; }
};

TEST(Callables, OfAllKindsAreTaken) {
  slom::Estimator est;
  const auto x = est.insertRV(1.5, "x");
  const auto p = est.insertRV(Eigen::Vector2d(1, 2), "p");
  const auto number = est.insertRV(mtk::Scalar<>(3.0), "number");
  est.insertMeasurement(freeFunction, x, Vec2(1, 2), slom::named("free function"));
  est.insertMeasurement(&freeFunction, x, Vec2(1, 2), slom::named("pointer"));
  est.insertMeasurement(quadratic<double>, x, slom::named("template of doubles"));
  est.insertMeasurement([](const auto& v) { return quadratic(v); }, x, slom::named("template"));
  const double captured = 0.5;
  est.insertMeasurement([captured](const auto& v) { return v - captured; }, x, slom::named("capture"));
  est.insertMeasurement(
      [](const auto& v) {
        return std::array{v[0] - 1.0, v[1] * v[0]};
      },
      p, slom::named("array"));
  est.insertMeasurement([](const auto& v) { return v.eval(); }, p, slom::named("vector"));
  est.insertMeasurement([](const auto& v) { return (v * 2.0).eval(); }, p, slom::named("Eigen value"));
  est.insertMeasurement([](const auto& v, const auto& n) { return mtk::vector(v[0] * n, v[1] / n); }, p,
                        number, slom::named("two"));
  est.insertMeasurement([](const auto& v) -> Eigen::VectorXd { return Eigen::VectorXd::Constant(3, v); }, x,
                        slom::named("dynamic"));
  est.insertMeasurement(
      [](const auto& v) {
        Eigen::Matrix<std::remove_cvref_t<decltype(v[0])>, Eigen::Dynamic, 1> r(3);
        r << v[0], v[1], v[0] * v[1];
        return r;
      },
      p, slom::named("dynamic duals"));
  est.insertMeasurement([](const auto& n) { return n; }, number, slom::named("scalar"));
  est.insertMeasurement([](const auto&) { return 1.0; }, x, slom::named("constant"));
  EXPECT_TRUE(slom::checkDerivatives(est).ok()) << slom::checkDerivatives(est).text();
  const slom::Summary summary = est.optimize();
  const char* expected[] = {"numeric", "numeric", "numeric", "exact", "exact", "exact",  "exact",
                            "exact",   "exact",   "numeric", "exact", "exact", "numeric"};
  ASSERT_EQ(summary.groups.size(), std::size(expected));
  for (std::size_t g = 0; g < summary.groups.size(); ++g) {
    EXPECT_EQ(summary.groups[g].derivatives, expected[g]) << summary.groups[g].name;
  }
  EXPECT_TRUE(summary.converged) << slom::report(summary);

  const auto line = est.insertRV(2.0, "slope");
  const auto id =
      est.insertMeasurement(&Line::at, Line{2, 1}, line);  // a member function: the object is a datum
  EXPECT_EQ(est.residual(id)[0], 5);
}

TEST(Callables, PredictOnAnyManifold) {
  Random random;
  const auto expectAgreement = [](auto f, const auto& x, const auto& z) {
    slom::Estimator est;
    const auto id = est.insertRV(x, "x");
    const auto exact = est.insertMeasurement(f, id, slom::measured(z), slom::named("exact"));
    const auto packed =
        est.insertMeasurement(slom::vectorized(f), id, slom::measured(z), slom::named("packed"));
    const auto differences =
        est.insertMeasurement(slom::numeric(f), id, slom::measured(z), slom::named("differences"));
    EXPECT_LE((est.residual(exact) - est.residual(differences)).norm(), 1e-15);
    EXPECT_LE((est.residual(packed) - est.residual(differences)).norm(),
              1e-14 * (1 + est.residual(exact).norm()));
    const slom::DerivativeCheck check = slom::checkDerivatives(est);
    EXPECT_TRUE(check.ok()) << check;
    EXPECT_EQ(check.groups[0].source, slom::DerivativeSource::exact);
    EXPECT_EQ(check.groups[1].source, slom::DerivativeSource::exact);
  };
  const auto same = [](const auto& x) { return x; };
  const auto frame = [&] {
    return Frame{mtk::SO3<>::exp(random.vec3(1)),
                 mtk::S2<>(random.vec3(1)),
                 {mtk::SO2<>(0.4 * random()), mtk::SO2<>(0.4 * random())},
                 2.0};
  };
  for (int k = 0; k < 5; ++k) {
    expectAgreement(same, random(), random());
    expectAgreement(same, random.vec3(1), random.vec3(1));
    expectAgreement(same, mtk::SO2<>(0.4 * random()), mtk::SO2<>(0.4 * random()));
    expectAgreement(same, mtk::SO3<>::exp(random.vec3(0.5)), mtk::SO3<>::exp(random.vec3(0.5)));
    expectAgreement(same, mtk::S2<>(random.vec3(1)), mtk::S2<>(random.vec3(1)));
    expectAgreement(same, random.se3(), random.se3());
    expectAgreement(same, Rig(random.se3(), random.vec3(1)), Rig(random.se3(), random.vec3(1)));
    expectAgreement(same, frame(), frame());
    expectAgreement([](const auto& R) { return R * mtk::S2<>(1, 2, 3); }, mtk::SO3<>::exp(random.vec3(1)),
                    mtk::S2<>(random.vec3(1)));
    expectAgreement([](const auto& T) { return T.inverse() * T.inverse(); },
                    SE2(mtk::SO2<>(0.2 * random()), Vec2(1, 2)), SE2(mtk::SO2<>(0.2 * random()), Vec2(2, 1)));
  }
}

TEST(Derivatives, OfManyAndOfAnUnknownNumberOfUnknownsAreExact) {
  slom::Estimator est;
  const auto dynamic = est.insertRV(mtk::vect<mtk::Dynamic>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, "dynamic");
  const auto pose = est.insertRV(Random().se3(), "pose");
  const auto large = est.insertRV(mtk::vect<40>(mtk::vect<40>::Random()), "large");
  est.insertMeasurement(
      [](const auto& v, const auto& T) {
        using S = mtk::scalar_t<std::remove_cvref_t<decltype(T)>>;
        Eigen::Matrix<S, Eigen::Dynamic, 1> r(2);
        r << v.squaredNorm() * T.pos[1], v[10] * (T * mtk::vect<3, S>(v[0], v[9], v[3]))[0];
        return r;
      },
      dynamic, pose, slom::named("dynamic"));
  est.insertMeasurement([](const auto& v) { return mtk::vector(v.squaredNorm(), v[39] * v[0] * v[17]); },
                        large, slom::named("large"));
  const slom::DerivativeCheck check = slom::checkDerivatives(est);
  EXPECT_TRUE(check.ok()) << check;
  ASSERT_EQ(check.groups.size(), 2u);
  for (const auto& group : check.groups) EXPECT_EQ(group.source, slom::DerivativeSource::exact);
}

/// Rows sin((i + 1) x . p) and, last, one that depends on nothing.
template <int Rows>
void expectExactRows() {
  const auto f = [](const auto& x, const auto& y, const Vec3& p) {
    return [&]<int... I>(std::integer_sequence<int, I...>) {
      return mtk::vector(sin((I + 1.0) * (x[0] * p[0] + x[1] * y * p[1] + x[2] * p[2]))..., 0.25);
    }(std::make_integer_sequence<int, Rows - 1>{});
  };
  const Vec3 p(0.3, -0.7, 1.1);
  slom::Estimator est;
  const auto x = est.insertRV(Vec3(0.4, 0.2, -0.1));
  const auto y = est.insertRV(1.5);
  est.insertMeasurement(f, x, y, p);
  est.insertMeasurement(slom::numeric(f, slom::Richardson()), x, y, p);
  const slom::DerivativeCheck check = slom::checkDerivatives(est);
  ASSERT_EQ(check.groups.size(), 2u);
  EXPECT_EQ(check.groups[0].source, slom::DerivativeSource::exact);
  EXPECT_LT(check.groups[0].error, 1e-8) << check.text();
  EXPECT_NEAR(est.residuals()[0], std::sin(0.4 * 0.3 - 0.2 * 1.5 * 0.7 - 0.1 * 1.1), 1e-15);
  EXPECT_EQ(est.residuals()[Rows - 1], 0.25);
}
template <int... Rows>
void expectExact(std::integer_sequence<int, Rows...>) {
  (expectExactRows<Rows + 2>(), ...);
}

TEST(Derivatives, OfAnyNumberOfRowsAreExact) { expectExact(std::make_integer_sequence<int, 9>{}); }

TEST(Groups, HaveTheNamesTheyAreGiven) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x");
  const auto f = [](const auto& v) { return v - 1.0; };
  est.insertMeasurement(f, x, slom::named("first"));
  est.insertMeasurement(f, x, slom::named("second"), slom::StandardDeviation(0.1));
  est.insertMeasurement(f, x, slom::StandardDeviation(0.1), slom::named("first"));
  est.insertMeasurement(f, x);
  const slom::Summary summary = est.optimize();
  ASSERT_EQ(summary.groups.size(), 3u);
  EXPECT_EQ(summary.groups[0].name, "first");
  EXPECT_EQ(summary.groups[0].measurements, 2);
  EXPECT_EQ(summary.groups[1].name, "second");
  EXPECT_EQ(summary.groups[2].name, "lambda");
  EXPECT_EQ(
      messageOf([&] { est.insertMeasurement(f, x, slom::named("third"), slom::StandardDeviation(-1.0)); }),
      "[slom.not-positive-definite] standard deviation of measurement third #1 is -1; pass positive finite numbers");
}

TEST(Insertion, OfAMillionMeasurementsAllocatesForNoneOfThem) {
  slom::Estimator est;
  const auto x = est.insertRV(1.0, "x"), y = est.insertRV(1.0, "y");
  const auto f = [](const auto& a, const auto& b, double z) { return a * z + b; };
  [[maybe_unused]] const std::size_t before = allocations();
  for (int i = 0; i < 1'000'000; ++i) est.insertMeasurement(f, x, y, i * 1e-6, slom::StandardDeviation(0.1));
#if !defined(MTK_ADDRESS_SANITIZER)
  EXPECT_LT(allocations() - before, 1000u);  // arrays that double their size
#endif
  EXPECT_EQ(est.getM(), 1'000'000);
}

struct WrongSign : RelativeByHand {
  template <class JA, class JB>
  void jacobian(const SE3& a, const SE3& b, const SE3& z, JA& by_a, JB& by_b) const {
    RelativeByHand::jacobian(a, b, z, by_a, by_b);
    by_a = -by_a;
  }
};
/// R p and its derivative by R, changed by Change.
template <class Change>
struct Rotated {
  Vec3 operator()(const mtk::SO3<>& R, const Vec3& p) const { return R * p; }
  void jacobian(const mtk::SO3<>& R, const Vec3& p, auto& by_R) const {
    by_R = -R.toRotationMatrix() * RelativeByHand::cross(p);
    Change()(R, by_R);
  }
};

TEST(DerivativeCheck, GuessesTheCause) {
  slom::Estimator est;
  Random random;
  const auto a = est.insertRV(random.se3(), "a"), b = est.insertRV(random.se3(), "b");
  est.insertMeasurement(WrongSign(), a, b, random.se3(), slom::named("odometry"));
  const slom::DerivativeCheck check = slom::checkDerivatives(est);
  EXPECT_FALSE(check.ok());
  ASSERT_EQ(check.groups.size(), 1u);
  EXPECT_EQ(check.groups[0].guess, "the sign is wrong");
  EXPECT_EQ(check.groups[0].component.substr(0, 2), "a.");
  EXPECT_EQ(check.groups[0].measurement, "odometry #1");
  EXPECT_NEAR(check.groups[0].used, -check.groups[0].reference, 1e-7);
  EXPECT_EQ(check.text().substr(0, 73),
            "odometry: given derivatives of 1 measurement do NOT agree with difference");

  const auto guessFor = [&](auto change) {
    slom::Estimator one;
    const auto R = one.insertRV(mtk::SO3<>::exp(Vec3(0.4, -0.9, 0.3)), "R");
    one.insertMeasurement(Rotated<decltype(change)>(), R, Vec3(1, 2, 3));
    return slom::checkDerivatives(one).groups.at(0).guess;
  };
  EXPECT_EQ(guessFor([](const auto&, auto&) {}), "");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J = J.transpose().eval(); }), "it is transposed");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J = (-J.transpose()).eval(); }),
            "it is transposed, and the sign is wrong");
  EXPECT_EQ(
      guessFor([](const auto& R, auto& J) { J = (J * R.toRotationMatrix().transpose()).eval(); }),
      "it is the derivative by a rotation on the left, exp(d) R; rotations are perturbed on the right, R exp(d): "
      "multiply by the rotation matrix from the right");
  EXPECT_EQ(
      guessFor([](const auto& R, auto& J) { J = (-J * R.toRotationMatrix().transpose()).eval(); }),
      "it is the derivative by a rotation on the left, exp(d) R, with the wrong sign; rotations are perturbed on the "
      "right, R exp(d)");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J *= 57.29577951308232; }),
            "it is too large by the factor 57.2958: degrees instead of radians, or the other way round");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J *= 2; }), "it is too large by the factor 2");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J.setZero(); }),
            "all derivatives by this variable are zero: they were forgotten");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J.col(1).setZero(); }),
            "the derivatives by this component are zero: they were forgotten");
  EXPECT_EQ(guessFor([](const auto&, auto& J) { J(1, 1) += 1; }),
            "no simple cause: compare the formula with the function");
}

TEST(DerivativeCheck, LooksAtFreeVariablesAlone) {
  slom::Estimator est;
  Random random;
  const auto a = est.insertRV(random.se3(), false, "a"), b = est.insertRV(random.se3(), "b");
  est.insertMeasurement(WrongSign(), a, b, random.se3());
  EXPECT_TRUE(slom::checkDerivatives(est).ok()) << slom::checkDerivatives(est).text();
  est.optimizeRV(b, false);
  EXPECT_TRUE(slom::checkDerivatives(est).groups.empty());
}

/// A distance by hand: one row, several unknowns in each block.
struct DistanceByHand {
  double operator()(const Vec3& a, const Vec2& b, double z) const {
    return std::hypot(a[0] - b[0], a[1] - b[1]) + a[2] - z;
  }
  template <class JA, class JB>
  void jacobian(const Vec3& a, const Vec2& b, double, JA& by_a, JB& by_b) const {
    const Vec2 way = (Vec2(a[0], a[1]) - b).normalized();
    by_a << way[0], way[1], 1;
    by_b << -way[0], -way[1];
  }
};
TEST(GivenDerivatives, OfAScalarByManyUnknowns) {
  slom::Estimator est;
  const auto a = est.insertRV(Vec3(1, 2, 0.5), "a");
  const auto b = est.insertRV(Vec2(-2, 5), "b");
  est.insertMeasurement(DistanceByHand(), a, b, 4.0);
  const slom::DerivativeCheck check = slom::checkDerivatives(est);
  EXPECT_TRUE(check.ok()) << check.text();
  EXPECT_EQ(check.groups.at(0).source, slom::DerivativeSource::given);
  est.prior(a, *a, 1);
  est.prior(b, *b, 1);
  const slom::Summary summary = est.optimize();
  EXPECT_TRUE(summary.converged);
  EXPECT_TRUE(summary.warnings.empty());
}

struct Unset
    : Rotated<decltype([](const auto&, auto& J) { J(2, 1) = std::numeric_limits<double>::quiet_NaN(); })> {};

TEST(GivenDerivatives, ThatAreLeftUnsetAreFound) {
  slom::Estimator est;
  est.insertMeasurement(Unset(), est.insertRV(mtk::SO3<>(), "R"), Vec3(1, 2, 3), slom::named("sight"));
  EXPECT_EQ(
      messageOf([&] { est.optimize(); }),
      "[slom.not-finite] a derivative of measurement sight #1 is not finite at R = (0 0 0 1); check its data, the "
      "function where it divides, takes roots or logarithms or leaves an entry of its result unset, and the start "
      "values");
  EXPECT_EQ(slom::checkDerivatives(est).groups.at(0).guess,
            "an entry is not finite: the function that gives the derivatives left it unset");
}

TEST(ThePapersOutlook, CompilesAsWritten) {
  slom::Estimator est;
  struct Dat1 {
    double value;
    explicit Dat1(double d) : value(d) {}  // which C++20 makes by itself, but not every compiler
  };
  const auto measurement = [](const auto& a, const auto& b, const Dat1& d) { return a * b - d.value; };
  const auto v1 = est.registerRV(1.0), v2 = est.registerRV(2.0, false);
  est.registerMeasurement(measurement, v1, v2, Dat1(3.0));
  const slom::Summary summary = est.optimize();
  EXPECT_EQ(summary.groups[0].derivatives, "exact");
  EXPECT_NEAR(*v1, 1.5, 1e-12);
}

}  // namespace
