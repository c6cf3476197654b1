// Transposition between arrays and packs: every entry arrives, and nothing outside is written.
#include <array>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <mtk/detail/transpose.hpp>

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

/// Rows of derivatives, any number of them, become the columns of a Jacobian.
template <int Rows, int Columns>
void expectColumns() {
  mtk::detail::Lanes<double, Columns> rows[Rows];
  for (int i = 0; i < Rows; ++i) {
    for (int c = 0; c < Columns; ++c) rows[i].set(c, 100 * c + i);
  }
  std::vector<double> J(std::size_t(Rows * Columns + 5), -1.0);
  mtk::detail::deinterleave<Rows>(rows, J.data(), Rows);
  for (int k = 0; k < Rows * Columns + 5; ++k) {
    const int c = k / Rows, i = k % Rows;
    EXPECT_EQ(J[std::size_t(k)], c < Columns ? 100 * c + i : -1) << Rows << " x " << Columns << " at " << k;
  }
}
template <int Rows, int... C>
void expectAllColumns(std::integer_sequence<int, C...>) {
  (expectColumns<Rows, C + 1>(), ...);
}

TEST(Transposition, WritesNoMoreColumnsThanThereAre) {
  expectAllColumns<1>(std::make_integer_sequence<int, 17>{});
  expectAllColumns<4>(std::make_integer_sequence<int, 17>{});
  expectAllColumns<7>(std::make_integer_sequence<int, 17>{});
  expectColumns<6, 30>();
}

}  // namespace
