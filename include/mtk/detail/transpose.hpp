/// Conversion between arrays of numbers and packs: small matrices transposed in registers.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "mtk/detail/lanes.hpp"

namespace mtk::detail {

#if defined(__has_builtin) && defined(MTK_HAS_VECTORS)
#if __has_builtin(__builtin_shufflevector)
#define MTK_HAS_SHUFFLES 1
#endif
#endif
#if defined(MTK_HAS_SHUFFLES)
inline constexpr bool kCanShuffle = true;

template <int Lanes>
struct UnalignedVector {
  typedef double type __attribute__((vector_size(8 * Lanes), aligned(8), may_alias));
};
inline auto loadPair(const double* x) {
  return NativeVector<2>::type(*reinterpret_cast<const UnalignedVector<2>::type*>(x));
}
template <int Lanes, class V>
void storeUnaligned(double* x, const V& v) {
  *reinterpret_cast<typename UnalignedVector<Lanes>::type*>(x) = v;
}
/// Returns x[0][i], x[0][i + 1], x[2][i], x[2][i + 1], x[4][i], ...
template <int Lanes>
typename NativeVector<Lanes>::type loadPairs(const double* const* x, int i) {
  if constexpr (Lanes == 2) {
    return loadPair(x[0] + i);
  } else if constexpr (Lanes == 4) {
    return __builtin_shufflevector(loadPairs<2>(x, i), loadPairs<2>(x + 2, i), 0, 1, 2, 3);
  } else {
    return __builtin_shufflevector(loadPairs<4>(x, i), loadPairs<4>(x + 4, i), 0, 1, 2, 3, 4, 5, 6, 7);
  }
}
/// Returns (a0, b0, a2, b2, ...).
template <class V>
V unpackLow(const V& a, const V& b) {
  if constexpr (sizeof(V) == 16) {
    return __builtin_shufflevector(a, b, 0, 2);
  } else if constexpr (sizeof(V) == 32) {
    return __builtin_shufflevector(a, b, 0, 4, 2, 6);
  } else {
    return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  }
}
/// Returns (a1, b1, a3, b3, ...).
template <class V>
V unpackHigh(const V& a, const V& b) {
  if constexpr (sizeof(V) == 16) {
    return __builtin_shufflevector(a, b, 1, 3);
  } else if constexpr (sizeof(V) == 32) {
    return __builtin_shufflevector(a, b, 1, 5, 3, 7);
  } else {
    return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  }
}
/// Stores lanes 0, 2, 4, ... of two numbers, t = (a0, b0, a2, b2, ...), to out, out + 2 stride, ...
template <class V>
void storePairs(const V& t, double* out, std::ptrdiff_t stride) {
  if constexpr (sizeof(V) == 16) {
    storeUnaligned<2>(out, t);
  } else if constexpr (sizeof(V) == 32) {
    storeUnaligned<2>(out, __builtin_shufflevector(t, t, 0, 1));
    storeUnaligned<2>(out + 2 * stride, __builtin_shufflevector(t, t, 2, 3));
  } else {
    storePairs(__builtin_shufflevector(t, t, 0, 1, 2, 3), out, stride);
    storePairs(__builtin_shufflevector(t, t, 4, 5, 6, 7), out + 4 * stride, stride);
  }
}
/// Stores lanes 0, 2, 4, ... of four numbers; s and t hold two each.
template <class V>
void storeQuads(const V& s, const V& t, double* out, std::ptrdiff_t stride) {
  if constexpr (sizeof(V) == 16) {
    storeUnaligned<2>(out, s);
    storeUnaligned<2>(out + 2, t);
  } else if constexpr (sizeof(V) == 32) {
    storeUnaligned<4>(out, __builtin_shufflevector(s, t, 0, 1, 4, 5));
    storeUnaligned<4>(out + 2 * stride, __builtin_shufflevector(s, t, 2, 3, 6, 7));
  } else {
    const V front = __builtin_shufflevector(s, t, 0, 1, 8, 9, 2, 3, 10, 11);
    const V back = __builtin_shufflevector(s, t, 4, 5, 12, 13, 6, 7, 14, 15);
    storeUnaligned<4>(out, __builtin_shufflevector(front, front, 0, 1, 2, 3));
    storeUnaligned<4>(out + 2 * stride, __builtin_shufflevector(front, front, 4, 5, 6, 7));
    storeUnaligned<4>(out + 4 * stride, __builtin_shufflevector(back, back, 0, 1, 2, 3));
    storeUnaligned<4>(out + 6 * stride, __builtin_shufflevector(back, back, 4, 5, 6, 7));
  }
}
#else
inline constexpr bool kCanShuffle = false;
#endif

/// Sets out[i] := (x[0][i], ..., x[W - 1][i]) for i < N.
template <int N, std::size_t W>
void interleave(const std::array<const double*, W>& x, Lanes<double, static_cast<int>(W)>* out) {
  using Packed = Lanes<double, static_cast<int>(W)>;
  constexpr int in_pairs = kCanShuffle ? N / 2 * 2 : 0;
#if defined(MTK_HAS_SHUFFLES)
  unrolled<in_pairs / 2>([&](int pair) {
    unrolled<Packed::count>([&](int v) {
      const double* const* const own = x.data() + v * Packed::lanes;
      const auto even = loadPairs<Packed::lanes>(own, 2 * pair),
                 odd = loadPairs<Packed::lanes>(own + 1, 2 * pair);
      out[2 * pair].v[v] = unpackLow(even, odd);
      out[2 * pair + 1].v[v] = unpackHigh(even, odd);
    });
  });
#endif
  unrolled<N - in_pairs>([&](int i) {
    out[in_pairs + i] =
        Packed::generate([&](int lane) { return x[static_cast<std::size_t>(lane)][in_pairs + i]; });
  });
}

#if defined(MTK_HAS_SHUFFLES)
/// Returns one half of a vector of 4 or 8.
template <bool High, class V>
auto halfOf(const V& v) {
  constexpr int first = High ? static_cast<int>(sizeof(V) / 16) : 0;
  if constexpr (sizeof(V) == 32) {
    return __builtin_shufflevector(v, v, first, first + 1);
  } else {
    return __builtin_shufflevector(v, v, first, first + 1, first + 2, first + 3);
  }
}
/// Sets out[lane * stride + i] := x(i)[lane] for i < N and the first Count lanes.
template <int N, int Count, class X>
void storeLanes(const X& x, double* out, std::ptrdiff_t stride) {
  constexpr int lanes = static_cast<int>(sizeof(x(0)) / sizeof(double)), half = lanes / 2;
  constexpr int in_quads = N / 4 * 4, in_pairs = N / 2 * 2;
  if constexpr (Count == lanes) {
    unrolled<in_quads / 4>([&](int quad) {
      const int i = 4 * quad;
      const auto &a = x(i), &b = x(i + 1), &c = x(i + 2), &d = x(i + 3);
      storeQuads(unpackLow(a, b), unpackLow(c, d), out + i, stride);
      storeQuads(unpackHigh(a, b), unpackHigh(c, d), out + stride + i, stride);
    });
    unrolled<(in_pairs - in_quads) / 2>([&](int) {
      const auto &a = x(in_quads), &b = x(in_quads + 1);
      storePairs(unpackLow(a, b), out + in_quads, stride);
      storePairs(unpackHigh(a, b), out + stride + in_quads, stride);
    });
    unrolled<N - in_pairs>(
        [&](int) { unrolled<lanes>([&](int lane) { out[lane * stride + in_pairs] = x(in_pairs)[lane]; }); });
  } else if constexpr (lanes == 2) {
    unrolled<N>([&](int i) { out[i] = x(i)[0]; });
  } else {
    storeLanes<N, (Count < half ? Count : half)>([&](int i) { return halfOf<false>(x(i)); }, out, stride);
    if constexpr (Count > half) {
      storeLanes<N, Count - half>([&](int i) { return halfOf<true>(x(i)); }, out + half * stride, stride);
    }
  }
}
#endif

/// Sets out[lane * stride + i] := x[i][lane] for i < N and all W lanes.
template <int N, int W>
void deinterleave(const Lanes<double, W>* x, double* out, std::ptrdiff_t stride) {
  constexpr int lanes = Lanes<double, W>::lanes, whole = W / lanes;
#if defined(MTK_HAS_SHUFFLES)
  if constexpr (lanes > 1) {
    unrolled<whole>([&](int v) {
      storeLanes<N, lanes>([&](int i) -> const auto& { return x[i].v[v]; }, out + v * lanes * stride, stride);
    });
    if constexpr (W > whole * lanes) {
      storeLanes<N, W - whole * lanes>([&](int i) -> const auto& { return x[i].v[whole]; },
                                       out + whole * lanes * stride, stride);
    }
    return;
  }
#endif
  unrolled<N>([&](int i) { unrolled<W>([&](int lane) { out[lane * stride + i] = x[i].get(lane); }); });
}

}  // namespace mtk::detail
