/// Several numbers in the lanes of vector registers (SIMD), on which operations work at once.
///   state      Width doubles; every operation works lane by lane
///   branches   a comparison gives a mask: use `select(mask, a, b)` in place of `if`
///   functions  those of <cmath>: mtk/pack_functions.hpp
#pragma once

#include <type_traits>

#include <Eigen/Core>

#include "mtk/detail/lanes.hpp"
#include "mtk/scalar.hpp"

namespace mtk {

/// Default number of doubles in a pack: 4, or 8 if the registers are that wide.
inline constexpr int kPackWidth = detail::kNativeLanes == 8 ? 8 : 4;

/// One condition for each lane. There is no conversion to bool: use select, all or any.
template <int Width>
struct PackMask {
  using Vector = typename detail::Lanes<double, Width>::Vector;
  using Native = decltype(Vector{} < Vector{});
  static constexpr int count = detail::Lanes<double, Width>::count;
  Native v[std::size_t{count}];

  /// Returns whether the condition holds in this lane.
  bool operator[](int lane) const {
    if constexpr (kLanes == 1) {
      return v[lane];
    } else {
      return v[lane / kLanes][lane % kLanes] != 0;
    }
  }
  friend PackMask operator&&(const PackMask& a, const PackMask& b) {
    PackMask r;
    MTK_EACH_VECTOR(count, i, r.v[i] = a.v[i] & b.v[i]);
    return r;
  }
  friend PackMask operator||(const PackMask& a, const PackMask& b) {
    PackMask r;
    MTK_EACH_VECTOR(count, i, r.v[i] = a.v[i] | b.v[i]);
    return r;
  }
  friend PackMask operator!(const PackMask& a) {
    PackMask r;
    if constexpr (std::is_same_v<Native, bool>) {
      MTK_EACH_VECTOR(count, i, r.v[i] = !a.v[i]);
    } else {
      MTK_EACH_VECTOR(count, i, r.v[i] = ~a.v[i]);
    }
    return r;
  }
  friend bool all(const PackMask& a) {
    bool result = true;
    MTK_EACH_VECTOR(count, i, result &= (bits(a.v[i]) & used(i)) == used(i));
    return result;
  }
  friend bool any(const PackMask& a) {
    int result = 0;
    MTK_EACH_VECTOR(count, i, result |= bits(a.v[i]) & used(i));
    return result != 0;
  }

 private:
  static constexpr int kLanes = detail::Lanes<double, Width>::lanes;
  /// Returns the bits of vector i that are lanes of the pack; the last vector may have unused ones.
  static constexpr int used(int i) {
    return i + 1 < count || Width % kLanes == 0 ? (1 << kLanes) - 1 : (1 << Width % kLanes) - 1;
  }
  /// Returns a bit for each lane of one vector.
  static int bits(const Native& mask) {
    if constexpr (kLanes == 1) {
      return mask ? 1 : 0;
#if defined(__AVX__)
    } else if constexpr (kLanes == 4) {
      return __builtin_ia32_movmskpd256(reinterpret_cast<const Vector&>(mask));
#endif
#if defined(__SSE2__)
    } else if constexpr (kLanes == 2) {
      return __builtin_ia32_movmskpd(reinterpret_cast<const Vector&>(mask));
#endif
    } else {
      int result = 0;
      for (int i = 0; i < kLanes; ++i) result |= mask[i] != 0 ? 1 << i : 0;
      return result;
    }
  }
};

template <int Width>
class Pack {
 public:
  using Numbers = detail::Lanes<double, Width>;
  static constexpr int width = Width;
  static constexpr int count = Numbers::count;

  Numbers lanes;

  Pack() = default;
  /// Sets the same number in all lanes.
  template <class T>
    requires std::is_arithmetic_v<T>
  Pack(const T& x) {  // NOLINT(google-explicit-constructor): a constant
    MTK_EACH_VECTOR(count, i, lanes.v[i] = typename Numbers::Vector{} + static_cast<double>(x));
  }
  explicit Pack(const Numbers& x) : lanes(x) {}

  double operator[](int lane) const { return lanes.get(lane); }
  /// Replaces the number in one lane.
  void set(int lane, double x) { lanes.set(lane, x); }

  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  Pack& operator/=(const Pack& b) { return *this = *this / b; }

  friend Pack operator-(const Pack& a) {
    Pack r;
    MTK_EACH_VECTOR(count, i, r.lanes.v[i] = -a.lanes.v[i]);
    return r;
  }
  friend Pack operator+(const Pack& a) { return a; }
#define MTK_PACK_OPERATOR(op)                                               \
  friend Pack operator op(const Pack& a, const Pack& b) {                   \
    Pack r;                                                                 \
    MTK_EACH_VECTOR(count, i, r.lanes.v[i] = a.lanes.v[i] op b.lanes.v[i]); \
    return r;                                                               \
  }
  MTK_PACK_OPERATOR(+)
  MTK_PACK_OPERATOR(-)
  MTK_PACK_OPERATOR(*)
  MTK_PACK_OPERATOR(/)
#undef MTK_PACK_OPERATOR
#define MTK_PACK_COMPARE(op)                                          \
  friend PackMask<Width> operator op(const Pack& a, const Pack& b) {  \
    PackMask<Width> r;                                                \
    MTK_EACH_VECTOR(count, i, r.v[i] = a.lanes.v[i] op b.lanes.v[i]); \
    return r;                                                         \
  }
  MTK_PACK_COMPARE(==)
  MTK_PACK_COMPARE(!=)
  MTK_PACK_COMPARE(<)
  MTK_PACK_COMPARE(<=)
  MTK_PACK_COMPARE(>)
  MTK_PACK_COMPARE(>=)
#undef MTK_PACK_COMPARE
};

template <int W>
inline constexpr bool is_scalar_v<Pack<W>> = true;

/// Returns a where the mask is set, b elsewhere.
template <int W>
Pack<W> select(const PackMask<W>& mask, const Pack<W>& a, const Pack<W>& b) {
  Pack<W> r;
  MTK_EACH_VECTOR(Pack<W>::count, i, r.lanes.v[i] = mask.v[i] ? a.lanes.v[i] : b.lanes.v[i]);
  return r;
}

}  // namespace mtk

namespace Eigen {

template <int W>
struct NumTraits<mtk::Pack<W>> : NumTraits<double> {
  using Real = mtk::Pack<W>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
  enum { RequireInitialization = 0 };
};
template <int W, class T, class Op>
  requires std::is_arithmetic_v<T>
struct ScalarBinaryOpTraits<T, mtk::Pack<W>, Op> {
  using ReturnType = mtk::Pack<W>;
};
template <int W, class T, class Op>
  requires std::is_arithmetic_v<T>
struct ScalarBinaryOpTraits<mtk::Pack<W>, T, Op> {
  using ReturnType = mtk::Pack<W>;
};

}  // namespace Eigen

#include "mtk/pack_functions.hpp"
