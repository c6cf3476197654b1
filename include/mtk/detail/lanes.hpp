/// A fixed number of doubles in the machine's vector registers.
#pragma once

#include <type_traits>
#include <utility>

#include <Eigen/Core>

#include "mtk/detail/cpp20.hpp"

/// Repeats the statement for i = 0, ..., count - 1, written out. Packs and most dual numbers have at most two vectors.
/// A measurement function has thousands of such operations, and compilers take long over as many loops or functions.
#define MTK_EACH_VECTOR(count, i, statement)                       \
  do {                                                             \
    if constexpr ((count) <= 2) {                                  \
      if constexpr ((count) > 0) {                                 \
        constexpr int i = 0;                                       \
        statement;                                                 \
      }                                                            \
      if constexpr ((count) > 1) {                                 \
        constexpr int i = 1;                                       \
        statement;                                                 \
      }                                                            \
    } else {                                                       \
      ::mtk::detail::unrolled<(count)>([&](int i) { statement; }); \
    }                                                              \
  } while (false)

namespace mtk::detail {

/// Calls f(First), ..., f(First + N - 1), written out: arrays with constant indices can stay in registers.
template <int N, int First = 0, class F>
void unrolled(const F& f) {
  if constexpr (N <= 3) {  // the most frequent sizes, without another function
    if constexpr (N > 0) f(First);
    if constexpr (N > 1) f(First + 1);
    if constexpr (N > 2) f(First + 2);
  } else {
    constexpr int most = N < 128 ? N : 128;  // clang refuses longer fold expressions
    [&]<int... I>(std::integer_sequence<int, I...>) {
      (f(First + I), ...);
    }(std::make_integer_sequence<int, most>{});
    if constexpr (N > most) unrolled<N - most, First + most>(f);
  }
}

/// Calls f(i) for the entries of a vector of `size`; Size is the size in the type. Written out unless there are many
/// entries.
template <int Size, class F>
void forEachEntry(Eigen::Index size, const F& f) {
  if constexpr (Size > 0 && Size <= 16) {
    unrolled<Size>(f);
  } else {
    for (int i = 0; i < static_cast<int>(size); ++i) f(i);
  }
}

/// The layout of N numbers of type S: `count` vectors of `lanes` numbers. Unused lanes of the last vector are 0.
template <class S, int N>
struct LaneLayout {
  using Vector = S;
  static constexpr int lanes = 1;
  static constexpr int count = N;
};

#if !defined(EIGEN_DONT_VECTORIZE) && defined(__GNUC__) && EIGEN_MAX_STATIC_ALIGN_BYTES >= 16
#define MTK_HAS_VECTORS 1
inline constexpr int kNativeLanes = EIGEN_MAX_STATIC_ALIGN_BYTES / 8;

/// Returns the lanes of the narrowest registers that hold n numbers at once, or else of the widest registers.
constexpr int lanesFor(int n) {
  int lanes = 2;
  while (lanes < kNativeLanes && lanes < n) lanes *= 2;
  return lanes;
}
template <int Lanes>
struct NativeVector {
  typedef double type __attribute__((vector_size(8 * Lanes)));
};
template <int N>
  requires(N > 1)
struct LaneLayout<double, N> {
  static constexpr int lanes = lanesFor(N);
  using Vector = typename NativeVector<lanes>::type;
  static constexpr int count = (N + lanes - 1) / lanes;
};
#else
inline constexpr int kNativeLanes = 1;
#endif

/// N numbers as an array of vectors. An elementwise operation is a loop over `v`.
template <class S, int N>
struct Lanes {
  using Vector = typename LaneLayout<S, N>::Vector;
  static constexpr int lanes = LaneLayout<S, N>::lanes;
  static constexpr int count = LaneLayout<S, N>::count;

  Vector v[std::size_t{count}];

  // Vectors are copied one by one, so the compiler keeps them in registers; for whole arrays it calls memcpy.
  Lanes() = default;
  Lanes(const Lanes& x) { MTK_EACH_VECTOR(count, i, v[i] = x.v[i]); }
  Lanes& operator=(const Lanes& x) {
    MTK_EACH_VECTOR(count, i, v[i] = x.v[i]);
    return *this;
  }

  static Lanes zero() {
    Lanes x;
    MTK_EACH_VECTOR(count, i, x.v[i] = Vector{});
    return x;
  }
  /// Returns number(i) for i = 0 ... N - 1, assembled in registers.
  template <class F>
  static Lanes generate(const F& number) {
    Lanes x;
    [&]<int... K>(std::integer_sequence<int, K...>) {
      ((x.v[K] = vectorOf(number, std::integral_constant<int, K * lanes>{},
                          std::make_integer_sequence<int, lanes>{})),
       ...);
    }(std::make_integer_sequence<int, count>{});
    return x;
  }
  S get(int i) const {
    if constexpr (lanes == 1) {
      return v[i];
    } else {
      return v[i / lanes][i % lanes];
    }
  }
  void set(int i, const S& x) {
    if constexpr (lanes == 1) {
      v[i] = x;
    } else {
      v[i / lanes][i % lanes] = x;
    }
  }

 private:
  template <class F, int First, int... I>
  static Vector vectorOf(const F& number, std::integral_constant<int, First>,
                         std::integer_sequence<int, I...>) {
    return Vector{(First + I < N ? number(First + I) : S(0))...};
  }
};

}  // namespace mtk::detail
