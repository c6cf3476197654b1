// Between arrays and packs: every entry arrives, and nothing is written beside it.
#include <mtk/detail/transpose.hpp>

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

namespace {

template <int N, int W>
void expectTransposed() {
  // Source w holds 100 w + i; targets are `stride` apart, and what lies between them is -1.
  std::vector<std::vector<double>> sources(W);
  std::array<const double*, W> x;
  for (int w = 0; w < W; ++w) {
    for (int i = 0; i < N; ++i) sources[std::size_t(w)].push_back(100 * w + i);
    x[std::size_t(w)] = sources[std::size_t(w)].data();
  }
  mtk::detail::Lanes<double, W> packs[N];
  mtk::detail::interleave<N>(x, packs);
  for (int i = 0; i < N; ++i) {
    for (int w = 0; w < W; ++w) EXPECT_EQ(packs[i].get(w), 100 * w + i) << N << " x " << W;
  }
  for (const int stride : {N, N + 3}) {
    std::vector<double> out(std::size_t(W * stride + 5), -1.0);
    mtk::detail::deinterleave<N>(packs, out.data(), stride);
    for (int k = 0; k < W * stride + 5; ++k) {
      const int w = k / stride, i = k % stride;
      EXPECT_EQ(out[std::size_t(k)], w < W && i < N ? 100 * w + i : -1) << N << " x " << W << " at " << k;
    }
  }
}

template <int W, int... N>
void expectAllTransposed(std::integer_sequence<int, N...>) {
  (expectTransposed<N + 1, W>(), ...);
}

TEST(Transposition, MovesEveryEntryAndNoOther) {
  expectAllTransposed<2>(std::make_integer_sequence<int, 9>{});
  expectAllTransposed<4>(std::make_integer_sequence<int, 9>{});
  expectAllTransposed<8>(std::make_integer_sequence<int, 9>{});
}

}  // namespace
