// Dual numbers and packs: derivatives of all functions and manifold operations against central differences in long
// double, at random and at hard points. Several lanes at once agree with one at a time.
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "mtk/build_manifold.hpp"
#include "mtk/mtk.hpp"
#include "mtk/preaccumulation.hpp"
#include "mtk/rebind.hpp"

namespace {

using Long = long double;
using SE2 = mtk::trafo<mtk::SO2<>>;
using SE3 = mtk::trafo<mtk::SO3<>>;
using Vec2 = mtk::vect<2>;
using Vec3 = mtk::vect<3>;
constexpr double kPi = 3.14159265358979323846;

MTK_BUILD_MANIFOLD(PlacedCamera, ((SE3, pose))((Vec3, lens)))

template <class S>
struct Stick {
  mtk::SO3<S> direction;
  S length{};
  std::array<mtk::vect<2, S>, 2> ends;
};

template <class S>
struct Lens : mtk::vect<4, S> {
  const S& focal() const { return (*this)[0]; }
};

/// A function's result as a list of numbers.
template <class R>
auto rowsOf(const R& result) {
  if constexpr (requires {
                  result.size();
                  result[0];
                }) {
    std::vector<std::remove_cvref_t<decltype(result[0])>> rows;
    for (int i = 0; i < static_cast<int>(result.size()); ++i) rows.push_back(result[i]);
    return rows;
  } else {
    return std::vector<R>{result};
  }
}

template <class... X>
constexpr int kColumns = (mtk::DOF_v<X> + ...);

/// f at x moved by h along column c, in long double.
template <class F, class... X>
std::vector<Long> shifted(const F& f, int c, Long h, const X&... x) {
  int first = 0;
  const auto moved = [&](const auto& one) {
    using M = std::remove_cvref_t<decltype(one)>;
    auto y = mtk::lifted<Long>(one);
    using Y = decltype(y);
    mtk::PlainVector<Long, mtk::DOF_v<M>> d;
    d.setZero();
    if (c >= first && c < first + mtk::DOF_v<M>) d[c - first] = h;
    first += mtk::DOF_v<M>;
    mtk::boxplus<Y>(y, d);
    return y;
  };
  const std::tuple<mtk::rebind_t<X, Long>...> all{moved(x)...};
  return rowsOf(std::apply(f, all));
}

/// Central differences, extrapolated (Richardson).
template <class F, class... X>
std::vector<Long> reference(const F& f, int c, const X&... x) {
  const Long h = 1e-4L;
  const auto a = shifted(f, c, h, x...), b = shifted(f, c, -h, x...);
  const auto d = shifted(f, c, h / 2, x...), e = shifted(f, c, -h / 2, x...);
  std::vector<Long> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    result[i] = (4 * (d[i] - e[i]) / h - (a[i] - b[i]) / (2 * h)) / 3;
  return result;
}

template <class D, class... X>
auto seededAll(const X&... x) {
  int next = 0;
  const auto one = [&](const auto& v) {
    using M = std::remove_cvref_t<decltype(v)>;
    return mtk::detail::seededAs<mtk::rebind_t<M, D>>(v, std::exchange(next, next + mtk::DOF_v<M>), D::size);
  };
  return std::tuple<mtk::rebind_t<X, D>...>{one(x)...};
}

/// Derivatives by dual numbers, and by packs of sparse ones, against the reference.
template <class F, class... X>
void expectExact(const std::string& name, const F& f, const X&... x) {
  constexpr int N = kColumns<X...>;
  using D = mtk::Dual<double, N>;
  const auto rows = rowsOf(std::apply(f, seededAll<D>(x...)));
  Eigen::MatrixXd exact(rows.size(), N), expected(rows.size(), N);
  const auto values = rowsOf(f(x...));
  for (int c = 0; c < N; ++c) {
    const auto column = reference(f, c, x...);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      exact(static_cast<int>(i), c) = rows[i].partial(c);
      expected(static_cast<int>(i), c) = static_cast<double>(column[i]);
    }
  }
  const double scale = std::max(1.0, expected.cwiseAbs().maxCoeff());
  EXPECT_LE((exact - expected).cwiseAbs().maxCoeff(), 1e-9 * scale) << name << "\n"
                                                                    << exact << "\n\n"
                                                                    << expected;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NEAR(rows[i].value(), values[i], 1e-14 * std::max(1.0, std::abs(values[i]))) << name;
  }

  // The same in packs.
  using P = mtk::Pack<4>;
  const auto packed = [](const auto& v) {
    using M = std::remove_cvref_t<decltype(v)>;
    mtk::rebind_t<M, P> y{};
    mtk::detail::gatherParts(y, std::array<const M*, 4>{&v, &v, &v, &v});
    return y;
  };
  const auto seeds = [&]<std::size_t... I>(std::index_sequence<I...>) {
    constexpr auto offset = [] {
      std::array<int, sizeof...(X)> result{};
      const int dofs[] = {mtk::DOF_v<X>...};
      for (std::size_t i = 1; i < sizeof...(X); ++i) result[i] = result[i - 1] + dofs[i - 1];
      return result;
    }();
    return std::tuple<mtk::detail::sparse_rebind_t<X, P, offset[I]>...>{
        mtk::detail::seededAs<mtk::detail::sparse_rebind_t<X, P, offset[I]>>(packed(x), offset[I], 64)...};
  }(std::index_sequence_for<X...>{});
  const auto pack_rows = rowsOf(std::apply(f, seeds));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int lane = 0; lane < 4; ++lane) {
      EXPECT_NEAR(pack_rows[i].value()[lane], rows[i].value(),
                  1e-14 * std::max(1.0, std::abs(rows[i].value())))
          << name;
      for (int c = 0; c < N; ++c) {
        EXPECT_NEAR(pack_rows[i].partial(c)[lane], rows[i].partial(c), 1e-14 * scale)
            << name << " column " << c;
      }
    }
  }
}

std::vector<Vec3> rotationVectors() {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto axis = [&] {
    const Vec3 v(normal(random), normal(random), normal(random));
    return Vec3(v / v.norm());
  };
  std::vector<Vec3> all{Vec3(0, 0, 0)};
  for (const double angle : {1e-300, 1e-160, 1e-17, 1e-9, 2e-8, 1e-4, 0.0099, 0.0101, 0.3, 1.0, 2.0, 3.0}) {
    all.push_back(angle * axis());
  }
  for (const double below_pi : {1e-3, 2e-4}) all.push_back((kPi - below_pi) * axis());
  return all;
}

const auto act = [](const auto& T, const auto& p) { return T * p; };
const auto actInverse = [](const auto& T, const auto& p) { return T.inverse() * p; };

TEST(DualNumbers, DifferentiateEveryFunction) {
  const auto check = [](const char* name, const auto& f, std::initializer_list<double> points) {
    for (const double x : points) expectExact(std::string(name) + " at " + std::to_string(x), f, x);
  };
  using std::abs, std::acos, std::acosh, std::asin, std::asinh, std::atan, std::atan2, std::atanh, std::cbrt,
      std::cos, std::cosh, std::erf, std::erfc, std::exp, std::expm1, std::fmax, std::fmin, std::hypot,
      std::log, std::log10, std::log1p, std::log2, std::pow, std::sin, std::sinh, std::sqrt, std::tan,
      std::tanh;
#define CHECK(name, ...) check(#name, [](const auto& x) { return name(x); }, {__VA_ARGS__})
  CHECK(sqrt, 0.01, 1, 7);
  CHECK(cbrt, 0.3, 1, 7, -2);
  CHECK(exp, -3, 0, 2);
  CHECK(expm1, -3, 0, 1e-9, 2);
  CHECK(log, 0.1, 1, 5);
  CHECK(log1p, -0.5, 0, 5);
  CHECK(log2, 0.1, 1, 5);
  CHECK(log10, 0.1, 1, 5);
  CHECK(sin, -3, 0, 2, 1000);
  CHECK(cos, -3, 0, 2, 1000);
  CHECK(tan, -1, 0, 1.2);
  CHECK(asin, -0.9, 0, 0.5);
  CHECK(acos, -0.9, 0, 0.5);
  CHECK(atan, -5, 0, 0.5);
  CHECK(sinh, -2, 0, 1);
  CHECK(cosh, -2, 0, 1);
  CHECK(tanh, -2, 0, 1);
  CHECK(asinh, -2, 0, 1);
  CHECK(acosh, 1.5, 4);
  CHECK(atanh, -0.8, 0, 0.5);
  CHECK(erf, -2, 0, 1);
  CHECK(erfc, -2, 0, 1, 9);
  CHECK(abs, -2, 1);
#undef CHECK
  for (const Vec2& p : {Vec2(1, 2), Vec2(-1, 0.1), Vec2(-3, -4), Vec2(0, 1), Vec2(5, 0.1)}) {
    expectExact(
        "atan2", [](const auto& x) { return atan2(x[1], x[0]); }, p);
    expectExact(
        "hypot", [](const auto& x) { return hypot(x[0], x[1]); }, p);
    expectExact(
        "pow", [](const auto& x) { return pow(x[0] * x[0] + 1.0, x[1]); }, p);
    expectExact(
        "quotients",
        [](const auto& x) { return x[0] / (x[1] * x[1] + 2.0) - 3.0 / (x[0] + 7.0) + x[1] / 2.0; }, p);
    expectExact(
        "sums", [](const auto& x) { return -(1.0 - x[0]) + (x[1] - 2) * 3 + (4 + x[0]) - +x[1]; }, p);
  }
  expectExact(
      "constant power", [](const auto& x) { return pow(x, 3) + pow(x, 0) + pow(x, -1.5); }, 1.7);
}

TEST(DualNumbers, AreFiniteWhereTheArgumentDoesNotMove) {
  using D = mtk::Dual<double, 2>;
  const auto expectValue = [](const D& y, double value) {
    EXPECT_EQ(y.value(), value);
    EXPECT_EQ(y.partial(0), 0);
    EXPECT_EQ(y.partial(1), 0);
  };
  D zero(0.0);
  expectValue(sqrt(zero), 0);
  expectValue(acos(D(1.0)), 0);
  expectValue(asin(D(1.0)), std::asin(1.0));
  expectValue(atan2(zero, zero), 0);
  expectValue(hypot(zero, zero), 0);
  expectValue(pow(zero, 0.5), 0);
  expectValue(pow(zero, 0), 1);
  zero.seed(0, 0);
  expectValue(sqrt(zero * zero), 0);
  expectValue(atan2(zero * zero, zero * zero), 0);
  expectValue(abs(zero), 0);
  const mtk::vect<2, D> origin{zero, zero};
  expectValue(origin.norm(), 0);
  // Where the argument does move, the derivative is what it is.
  EXPECT_EQ(sqrt(zero).partial(0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(sqrt(zero).partial(1), 0);
}

/// Values whose squares are 0 or infinite, and powers of negative numbers.
TEST(DualNumbers, HaveTheDerivativesThatThereAre) {
  using D = mtk::Dual<double, 2>;
  const auto seeded = [](double a, double b) {
    std::array<D, 2> x;
    x[0].seed(a, 0);
    x[1].seed(b, 1);
    return x;
  };
  for (const double size : {1e-300, 1e-170, 1e-150, 1e-20, 1.0, 1e20, 1e150, 1e170, 1e300}) {
    const auto [y, x] = seeded(3 * size, 4 * size);
    const D angle = atan2(y, x), length = hypot(y, x);
    EXPECT_NEAR(angle.partial(0) * size, 0.16, 1e-15) << size;
    EXPECT_NEAR(angle.partial(1) * size, -0.12, 1e-15) << size;
    EXPECT_NEAR(length.partial(0), 0.6, 1e-15) << size;
    EXPECT_NEAR(length.partial(1), 0.8, 1e-15) << size;
  }
  const auto [tiny, none] = seeded(1e-170, 1e-170);
  EXPECT_NEAR(atan2(tiny, none).partial(0) / 5e169, 1, 1e-15);
  const auto [base, exponent] = seeded(-2, 2);
  const D square = pow(base, exponent);
  EXPECT_EQ(square.value(), 4);
  EXPECT_EQ(square.partial(0), -4);
  EXPECT_TRUE(std::isnan(square.partial(1))) << "(-2)^y has no derivative by y";
  EXPECT_EQ(pow(base, D(2)).partial(1), 0);
  EXPECT_EQ(pow(base, D(-1)).partial(0), -0.25);
  EXPECT_EQ(pow(-2.0, D(3)).partial(0), 0);
  EXPECT_EQ(pow(D(0), exponent).partial(1), 0);
  EXPECT_NEAR(hypot(3.0, seeded(4, 0)[0]).partial(0), 0.8, 1e-15);
  EXPECT_NEAR(hypot(seeded(4, 0)[0], 3).partial(0), 0.8, 1e-15);
}

TEST(Packs, TakeNumbersAsBaseAndExponent) {
  using P = mtk::Pack<4>;
  P y;
  for (int lane = 0; lane < 4; ++lane) y.set(lane, lane - 1.5);
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_EQ(pow(2.0, y)[lane], std::pow(2.0, y[lane]));
    EXPECT_EQ(pow(2, y)[lane], std::pow(2.0, y[lane]));
    EXPECT_EQ(hypot(y, 2.0)[lane], std::hypot(y[lane], 2.0));
    EXPECT_NEAR(atan2(1.0, y)[lane], std::atan2(1.0, y[lane]), 1e-15);
  }
  using D = mtk::Dual<P, 1>;
  D x;
  x.seed(y, 0);
  for (int lane = 0; lane < 4; ++lane) {
    EXPECT_NEAR(pow(2.0, x).partial(0)[lane], std::log(2.0) * std::pow(2.0, y[lane]), 1e-15);
  }
}

TEST(DualNumbers, WorkInEigenExpressions) {
  const Eigen::Matrix3d A = (Eigen::Matrix3d() << 4, 1, 0, 2, 5, 1, 0, 1, 3).finished();
  expectExact(
      "products, norms, cross products",
      [&](const auto& v) {
        using S = std::remove_cvref_t<decltype(v[0])>;
        const Eigen::Matrix<S, 3, 1> w = A.cast<S>() * v + v.cross(v * 2.0);
        return Eigen::Matrix<S, 2, 1>(w.norm() + v.dot(w), w.squaredNorm() / v.sum());
      },
      Vec3(1, 2, 3));
  using D = mtk::Dual<double, 3>;
  const auto [v] = seededAll<D>(Vec3(1, 2, 3));
  const Eigen::Matrix<D, 3, 1> by_constants = A * v;  // without a cast
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) EXPECT_EQ(by_constants[i].partial(j), A(i, j));
  }
  const Eigen::Matrix<D, 3, 3> M = v * v.transpose() + A;
  const Eigen::Matrix<D, 3, 3> unit = M * M.inverse();
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(unit(i).value(), i % 4 == 0 ? 1 : 0, 1e-13);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(unit(i).partial(c), 0, 1e-12);
  }
}

TEST(DualNumbers, DoNotBecomeNumbersWithoutDerivatives) {
  using D = mtk::Dual<double, 2>;
  static_assert(!std::is_convertible_v<D, double>);
  static_assert(!std::is_convertible_v<mtk::vect<2, D>, Eigen::Vector2d>);
  static_assert(!std::is_convertible_v<mtk::vect<2, D>, Vec2>);
  static_assert(!std::is_convertible_v<mtk::rebind_t<SE3, D>, SE3>);
  static_assert(!std::is_invocable_v<double (*)(const Eigen::Vector2d&), mtk::vect<2, D>>);
  static_assert(std::is_convertible_v<SE3, mtk::rebind_t<SE3, D>>);
  static_assert(std::is_same_v<mtk::rebind_t<Eigen::Vector3d, D>, mtk::vect<3, D>>);
  static_assert(std::is_same_v<mtk::rebind_t<Stick<double>, D>, Stick<D>>);
  struct NoTemplate {
    Vec3 a;
  };
  static_assert(mtk::Manifold<NoTemplate> && !mtk::is_rebindable_v<NoTemplate>);
}

TEST(DerivativesOfManifolds, AgreeWithLongDoubleAtHardPoints) {
  const Vec3 p(0.3, -2, 5);
  const SE3 fixed(mtk::SO3<>::exp(Vec3(0.3, -0.2, 0.9)), Vec3(1, 2, 3));
  for (const Vec3& v : rotationVectors()) {
    const std::string at = " at |v| = " + std::to_string(v.norm());
    const mtk::SO3<> R = mtk::SO3<>::exp(v);
    const SE3 T(R, Vec3(3, 2, 1)), other(mtk::SO3<>::exp(Vec3(1, -1, 0.5)), Vec3(-1, 0, 2));
    expectExact("R p" + at, act, R, p);
    expectExact("R^-1 p" + at, actInverse, R, p);
    expectExact("T p" + at, act, T, p);
    expectExact("T^-1 p" + at, actInverse, T, p);
    expectExact(
        "T constant" + at, [](const auto& x) { return x * Vec3(1, 2, 3); }, T);
    expectExact(
        "constant T p" + at, [&](const auto& x, const auto& q) { return fixed * (x * (fixed.orient * q)); },
        T, p);
    expectExact(
        "product" + at, [](const auto& a, const auto& b) { return (a.inverse() * b * a) * Vec3(1, 2, 3); }, T,
        other);
    expectExact(
        "exp" + at,
        [](const auto& x) { return mtk::SO3<std::remove_cvref_t<decltype(x[0])>>::exp(x) * Vec3(1, 2, 3); },
        v);
    expectExact(
        "exp by the name of plain rotations" + at,
        [](const auto& angle, const auto& axis) {
          return mtk::SO3<>::exp(angle * axis.vector()) * Vec3(1, 2, 3);
        },
        v.norm(), mtk::S2<>(v.norm() > 0 ? v : Vec3(1, 0, 0)));
    expectExact(
        "exp of an expression" + at,
        [](const auto& angle) {
          const Eigen::Matrix<std::remove_cvref_t<decltype(angle)>, 3, 1> axis(0, 0.6, 0.8);
          return mtk::SO3<>::exp(angle * axis) * Vec3(1, 2, 3);
        },
        v.norm());
    expectExact(
        "log by the name of plain rotations" + at,
        [](const auto& a, const auto& b) { return mtk::SO3<>::log(a.inverse() * b); },
        mtk::SO3<>::exp(Vec3(0.1, 0.2, 0.3)), mtk::SO3<>::exp(Vec3(0.1, 0.2, 0.3)) * R);
    expectExact(
        "log" + at,
        [](const auto& a, const auto& b) {
          const auto relative = a.inverse() * b;
          return std::remove_cvref_t<decltype(relative)>::log(relative);
        },
        mtk::SO3<>::exp(Vec3(0.1, 0.2, 0.3)), mtk::SO3<>::exp(Vec3(0.1, 0.2, 0.3)) * R);
    expectExact(
        "coefficients" + at, [](const auto& a) { return a.coeffs(); }, R);
    expectExact(
        "matrix" + at,
        [](const auto& a) {
          const auto M = a.toRotationMatrix();
          using S = std::remove_cvref_t<decltype(M(0, 0))>;
          return Eigen::Matrix<S, 4, 1>(M(0, 0), M(2, 1), M(0, 2), M(1, 1));
        },
        R);
    expectExact(
        "direction" + at, [](const auto& a, const auto& s) { return (a * s).vector(); }, R,
        mtk::S2<>(1, -2, 0.5));
  }
}

TEST(DerivativesOfManifolds, OfLogAndExpAreInverseToEachOtherAtPi) {
  // Differences across the cut at pi mean nothing; that exp(log(R)) is R does.
  using D = mtk::Dual<double, 3>;
  for (const double missing : {0.0, 1e-16, 1e-12, 1e-9, 1e-6}) {
    for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, -1), Vec3(2.0 / 3, -1.0 / 3, 2.0 / 3)}) {
      const mtk::SO3<> R = mtk::SO3<>::exp(Vec3((kPi - missing) * axis));
      const auto seeded = mtk::detail::seededAs<mtk::SO3<D>>(R, 0, 3);
      const mtk::SO3<D> back = mtk::SO3<D>::exp(mtk::SO3<D>::log(seeded));
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
          EXPECT_NEAR(back.partials()[std::size_t(i)].get(j), i == j ? 1 : 0, 1e-12) << missing;
      }
    }
  }
}

TEST(DerivativesOfManifolds, InThePlaneAndOnTheSphere) {
  for (const double angle : {0.0, 1e-300, 1e-9, 0.5, -2.0, 3.1, kPi - 1e-3}) {
    const SE2 T(mtk::SO2<>(angle), Vec2(1, 2)), other(mtk::SO2<>(0.7), Vec2(-1, 0.5));
    expectExact("T p", act, T, Vec2(3, 4));
    expectExact(
        "relative pose",
        [](const auto& a, const auto& b) {
          const auto relative = a.inverse() * b;
          return mtk::vector(relative.pos[0], relative.pos[1], relative.orient.angle());
        },
        other, SE2(mtk::SO2<>(0.7), Vec2(1, 1)) * T);
  }
  for (const double arc : {0.0, 1e-300, 1e-160, 1e-9, 1e-4, 0.5, 2.0, 3.0}) {
    for (const mtk::S2<>& from : {mtk::S2<>(1, 2, 3), mtk::S2<>(0, 0, 1), mtk::S2<>(0, 0.1, -1)}) {
      mtk::S2<> to = from;
      to.boxplus(Vec2(arc * 0.6, arc * 0.8));
      expectExact(
          "y [-] x by y",
          [&](const auto& y) {
            using S = std::remove_cvref_t<decltype(y.x())>;
            mtk::vect<2, S> out;
            y.boxminus(out, mtk::lifted<S>(from));
            return out;
          },
          to);
      expectExact(
          "x [+] d",
          [](const auto& d) {
            using S = std::remove_cvref_t<decltype(d[0])>;
            mtk::S2<S> y = mtk::lifted<S>(mtk::S2<>(1, 2, 3));
            y.boxplus(d);
            return y.vector();
          },
          Vec2(arc * 0.6, arc * 0.8));
    }
  }
}

TEST(DerivativesOfManifolds, OfCompoundsAndUsersTypes) {
  const PlacedCamera camera(SE3(mtk::SO3<>::exp(Vec3(0.2, 0.3, -1)), Vec3(0.1, 0.2, 4)),
                            Vec3(500, 0.1, -0.02));
  const auto project = [](const auto& c, const auto& X) {
    return mtk::preaccumulate(c.pose * X, [&](const auto& p) {
      const auto& [f, k1, k2] = c.lens;
      const auto x = p[0] / p[2], y = p[1] / p[2], r2 = x * x + y * y;
      const auto scale = f * (1.0 + r2 * (k1 + r2 * k2));
      return mtk::vector(scale * x, scale * y);
    });
  };
  expectExact("camera", project, camera, Vec3(1, 2, 3));
  expectExact(
      "a number through a preaccumulation",
      [](const auto& T, const auto& X) {
        return mtk::preaccumulate(T * X, [&](const auto& p) { return p[0] * p[1] / p[2] + X[0]; });
      },
      camera.pose, Vec3(1, 2, 3));
  const Stick<double> stick{mtk::SO3<>::exp(Vec3(1, 2, 0.5)), 2.0, {Vec2(1, 2), Vec2(3, 4)}};
  expectExact(
      "stick",
      [](const auto& s) {
        const auto tip = s.direction * Vec3(1, 0, 0);
        return mtk::vector(s.length * tip[0] + s.ends[0][1], tip[2] * s.ends[1][0]);
      },
      stick);
  Lens<double> lens;
  lens << 500, 0.1, 0.2, 0.3;
  expectExact(
      "lens", [](const auto& l) { return mtk::vector(l.focal() * l[1], l[2] / l[3]); }, lens);
  expectExact(
      "scalar", [](const auto& x) { return 2.0 * x * x - 1.0 / x; }, mtk::Scalar<>(3.0));
}

TEST(Packs, AgreeWithTheLibraryOfC) {
  using P = mtk::Pack<4>;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  double of_sin = 0, of_cos = 0, of_atan2 = 0;
  for (int k = 0; k < 200000; ++k) {
    P x, y;
    const double scale = std::pow(10.0, 6 * uniform(random) - 1);
    for (int lane = 0; lane < 4; ++lane) {
      x.set(lane, k < 40 ? (k - 20) * kPi / 4 : scale * uniform(random));
      y.set(lane, k < 40 ? lane - 2 : std::pow(10.0, 8 * uniform(random)) * uniform(random));
    }
    const P s = sin(x), c = cos(x), a = atan2(y, x);
    for (int lane = 0; lane < 4; ++lane) {
      const Long exact_sin = std::sin(Long(x[lane])), exact_atan2 = std::atan2(Long(y[lane]), Long(x[lane]));
      if (exact_sin != 0) of_sin = std::max(of_sin, double(std::abs((s[lane] - exact_sin) / exact_sin)));
      of_cos = std::max(of_cos, double(std::abs(c[lane] - std::cos(Long(x[lane])))));
      if (exact_atan2 != 0)
        of_atan2 = std::max(of_atan2, double(std::abs((a[lane] - exact_atan2) / exact_atan2)));
    }
  }
  EXPECT_LE(of_sin, 4e-16);
  EXPECT_LE(of_cos, 4e-16);
  EXPECT_LE(of_atan2, 4e-16);
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  P x, y;
  const double xs[] = {inf, 0, nan, -inf}, ys[] = {1, 0, 1, inf};
  for (int lane = 0; lane < 4; ++lane) x.set(lane, xs[lane]), y.set(lane, ys[lane]);
  for (int lane = 0; lane < 4; ++lane) {
    const double expected = std::atan2(ys[lane], xs[lane]);
    EXPECT_TRUE(atan2(y, x)[lane] == expected || (std::isnan(expected) && std::isnan(atan2(y, x)[lane])))
        << lane;
    EXPECT_TRUE(sin(x)[lane] == std::sin(xs[lane]) ||
                (std::isnan(std::sin(xs[lane])) && std::isnan(sin(x)[lane])));
  }
}

TEST(Packs, ChooseByLane) {
  using P = mtk::Pack<4>;
  P x;
  for (int lane = 0; lane < 4; ++lane) x.set(lane, lane - 1.5);
  const P y = select(x < P(0.0), -x, x * 10.0);
  const double expected[] = {1.5, 0.5, 5, 15};
  for (int lane = 0; lane < 4; ++lane) EXPECT_EQ(y[lane], expected[lane]);
  EXPECT_TRUE(any(x < P(0.0)) && !all(x < P(0.0)) && all(x < P(2.0)) && !any(x > P(2.0)));
  EXPECT_TRUE(all(!(x < P(0.0)) || (x < P(0.0))) && !any(!(x < P(0.0)) && (x < P(0.0))));
  // Each lane takes its own branch of the functions of the library.
  mtk::SO3<P> R;
  const mtk::SO3<> each[] = {mtk::SO3<>(), mtk::SO3<>::exp(Vec3(1e-10, 0, 0)),
                             mtk::SO3<>::exp(Vec3(3, 0.1, 0)), mtk::SO3<>::exp(Vec3(0, 1, 2))};
  mtk::detail::gatherParts(R, std::array<const mtk::SO3<>*, 4>{&each[0], &each[1], &each[2], &each[3]});
  const auto v = mtk::SO3<P>::log(R);
  for (int lane = 0; lane < 4; ++lane) {
    const Vec3 one = mtk::SO3<>::log(each[lane]);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(v[i][lane], one[i], 1e-15);
  }
}

}  // namespace
