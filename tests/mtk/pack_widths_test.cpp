// Packs of every width give in each lane the result of a single number. Sine and cosine computed together equal the
// separate results.
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include <mtk/dual.hpp>
#include <mtk/pack.hpp>

namespace {

template <int W>
struct Sample {
  mtk::Pack<W> pack;
  std::array<double, W> lane;
};

/// Returns numbers of all magnitudes and both signs. Every fifth is one of a few values, so that some are equal.
template <int W>
Sample<W> sample(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Sample<W> s;
  for (int i = 0; i < W; ++i) {
    double& x = s.lane[static_cast<std::size_t>(i)];
    x = random() % 5 == 0 ? static_cast<double>(random() % 3) - 1
                          : uniform(random) * std::pow(10.0, 8 * uniform(random));
    s.pack.set(i, x);
  }
  return s;
}

template <int W>
void checkOperations() {
  using P = mtk::Pack<W>;
  std::mt19937_64 random(W);
  for (int k = 0; k < 300; ++k) {
    const Sample<W> first = sample<W>(random), second = sample<W>(random);
    const P &x = first.pack, &y = second.pack;
    const auto &xs = first.lane, &ys = second.lane;
    const auto equal = [&](const P& result, const auto& f) {
      for (int i = 0; i < W; ++i) {
        const double expected = f(xs[static_cast<std::size_t>(i)], ys[static_cast<std::size_t>(i)]);
        EXPECT_TRUE(result[i] == expected || (std::isnan(result[i]) && std::isnan(expected)))
            << "width " << W << " lane " << i << ": " << result[i] << " instead of " << expected;
      }
    };
    const auto close = [&](const P& result, const auto& f) {
      for (int i = 0; i < W; ++i) {
        const double expected = f(xs[static_cast<std::size_t>(i)], ys[static_cast<std::size_t>(i)]);
        EXPECT_NEAR(result[i], expected, 4e-16 * std::abs(expected)) << "width " << W << " lane " << i;
      }
    };
    equal(x + y, [](double a, double b) { return a + b; });
    equal(x - y, [](double a, double b) { return a - b; });
    equal(x * y, [](double a, double b) { return a * b; });
    equal(x / y, [](double a, double b) { return a / b; });
    equal(-x, [](double a, double) { return -a; });
    equal(P(2.5) - x, [](double a, double) { return 2.5 - a; });
    equal(abs(x), [](double a, double) { return std::abs(a); });
    close(sqrt(abs(y)), [](double, double b) { return std::sqrt(std::abs(b)); });
    close(exp(P(x * 1e-6)), [](double a, double) { return std::exp(a * 1e-6); });
    close(hypot(x, y), [](double a, double b) { return std::hypot(a, b); });

    const auto chosen = [&](const mtk::PackMask<W>& mask, const auto& condition) {
      int count = 0;
      for (int i = 0; i < W; ++i) {
        const bool expected = condition(xs[static_cast<std::size_t>(i)], ys[static_cast<std::size_t>(i)]);
        EXPECT_EQ(mask[i], expected) << "width " << W << " lane " << i;
        count += expected;
      }
      EXPECT_EQ(all(mask), count == W) << "width " << W;
      EXPECT_EQ(any(mask), count > 0) << "width " << W;
      equal(select(mask, x, y), [&](double a, double b) { return condition(a, b) ? a : b; });
    };
    chosen(x < y, [](double a, double b) { return a < b; });
    chosen(x >= y, [](double a, double b) { return a >= b; });
    chosen(x == y, [](double a, double b) { return a == b; });
    chosen(x != x, [](double, double) { return false; });
    chosen(x == x, [](double, double) { return true; });
    chosen(x < y && x > P(0), [](double a, double b) { return a < b && a > 0; });
    chosen(x < y || y > P(0), [](double a, double b) { return a < b || b > 0; });
    chosen(!(x < y), [](double a, double b) { return !(a < b); });

    const auto [sine, cosine] = sinCos(x);
    const P alone_sine = sin(x), alone_cosine = cos(x);
    equal(alone_sine - sine, [](double, double) { return 0.0; });
    equal(alone_cosine - cosine, [](double, double) { return 0.0; });
    for (int i = 0; i < W; ++i) {
      EXPECT_NEAR(sine[i], std::sin(xs[static_cast<std::size_t>(i)]), 4e-16);
      EXPECT_NEAR(cosine[i], std::cos(xs[static_cast<std::size_t>(i)]), 4e-16);
    }
  }
}

TEST(Packs, OfEveryWidthDoInEachLaneWhatANumberDoes) {
  checkOperations<1>();
  checkOperations<2>();
  checkOperations<3>();
  checkOperations<4>();
  checkOperations<5>();
  checkOperations<8>();
  checkOperations<16>();
  checkOperations<33>();
}

/// Two numbers with different sets of derivative columns: all derivatives of sums, products and quotients, whatever the
/// sets share.
template <std::uint64_t A, std::uint64_t B>
void checkColumns() {
  using D = mtk::SparseDual<double, A>;
  using E = mtk::SparseDual<double, B>;
  std::mt19937_64 random(A + 31 * B);
  std::uniform_real_distribution<double> uniform(0.5, 2);
  D a(uniform(random));
  E b(uniform(random));
  for (int i = 0; i < D::size; ++i) a.partials().set(i, uniform(random));
  for (int i = 0; i < E::size; ++i) b.partials().set(i, uniform(random));
  const auto check = [&](const auto& y, double value, double by_a, double by_b) {
    EXPECT_NEAR(y.value(), value, 1e-15 * std::abs(value));
    for (int c = 0; c < 64; ++c) {
      EXPECT_NEAR(y.partial(c), by_a * a.partial(c) + by_b * b.partial(c), 1e-14)
          << "columns " << A << ", " << B << ": " << c;
    }
  };
  const double x = a.value(), z = b.value();
  check(a + b, x + z, 1, 1);
  check(a - b, x - z, 1, -1);
  check(a * b, x * z, z, x);
  check(a / b, x / z, 1 / z, -x / (z * z));
  check(b / a, z / x, -z / (x * x), 1 / x);
  check(atan2(a, b), std::atan2(x, z), z / (x * x + z * z), -x / (x * x + z * z));
  const auto [sine, cosine] = sinCos(a);
  check(sine, std::sin(x), std::cos(x), 0);
  check(cosine, std::cos(x), -std::sin(x), 0);
  check(sin(a) - sine, 0, 0, 0);
  check(cos(a) - cosine, 0, 0, 0);
}

TEST(DualNumbers, OfDifferentColumnsHaveThemAll) {
  checkColumns<0b1, 0b1>();
  checkColumns<0b1, 0b10>();
  checkColumns<0b10, 0b1>();
  checkColumns<0b111, 0b111>();
  checkColumns<0b101, 0b010>();
  checkColumns<0b1, 0b11110>();
  checkColumns<0b11110, 0b1>();
  checkColumns<0b110011, 0b011110>();
  checkColumns<0xff00ff, 0x00ff00>();
  checkColumns<0xffffffff, 0x1>();
  checkColumns<(std::uint64_t{1} << 63) | 5, std::uint64_t{1} << 62>();
  checkColumns<~std::uint64_t{0}, 0b100>();
}

/// The same numbers over packs have in each lane the derivatives of one of double.
TEST(DualNumbers, OverPacksHaveSineAndCosineOfEachLane) {
  using P = mtk::Pack<4>;
  mtk::SparseDual<P, 0b101> x;
  const double angles[] = {0, -2, 3e5, 1e-9};
  for (int lane = 0; lane < 4; ++lane) x.value().set(lane, angles[lane]);
  x.partials() = decltype(x)::Partials::generate([](int i) { return P(i + 1.5); });
  const auto [sine, cosine] = sinCos(x);
  for (int lane = 0; lane < 4; ++lane) {
    mtk::SparseDual<double, 0b101> one(angles[lane]);
    for (int i = 0; i < 2; ++i) one.partials().set(i, i + 1.5);
    const auto [one_sine, one_cosine] = sinCos(one);
    EXPECT_NEAR(sine.value()[lane], one_sine.value(), 2e-16);
    EXPECT_NEAR(cosine.value()[lane], one_cosine.value(), 2e-16);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(sine.partials().get(i)[lane], one_sine.partials().get(i), 1e-15);
      EXPECT_NEAR(cosine.partials().get(i)[lane], one_cosine.partials().get(i), 1e-15);
    }
  }
}

}  // namespace
