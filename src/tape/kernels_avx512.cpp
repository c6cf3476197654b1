// Instructions of tapes for processors with AVX-512, compiled with it enabled.
#include <immintrin.h>

namespace slom::tape {
namespace {

constexpr int kLanesOfVector = 8;

struct Mask {
  __mmask8 v;
};
struct Vector {
  __m512d v;
};
inline Vector load(const double* x) { return {_mm512_loadu_pd(x)}; }
inline void store(double* to, Vector x) { _mm512_storeu_pd(to, x.v); }
inline Vector all(double x) { return {_mm512_set1_pd(x)}; }
inline Vector operator+(Vector a, Vector b) { return {_mm512_add_pd(a.v, b.v)}; }
inline Vector operator-(Vector a, Vector b) { return {_mm512_sub_pd(a.v, b.v)}; }
inline Vector operator*(Vector a, Vector b) { return {_mm512_mul_pd(a.v, b.v)}; }
inline Vector operator/(Vector a, Vector b) { return {_mm512_div_pd(a.v, b.v)}; }
inline Vector operator-(Vector a) { return {_mm512_xor_pd(a.v, _mm512_set1_pd(-0.0))}; }
inline Vector absolute(Vector a) { return {_mm512_andnot_pd(_mm512_set1_pd(-0.0), a.v)}; }
inline Vector fma(Vector a, Vector b, Vector c) { return {_mm512_fmadd_pd(a.v, b.v, c.v)}; }
inline Vector fms(Vector a, Vector b, Vector c) { return {_mm512_fmsub_pd(a.v, b.v, c.v)}; }
inline Vector fnma(Vector a, Vector b, Vector c) { return {_mm512_fnmadd_pd(a.v, b.v, c.v)}; }
inline Vector squareRoot(Vector a) { return {_mm512_maskz_sqrt_pd(0xff, a.v)}; }
inline Vector roundToInteger(Vector a) {
  return {_mm512_maskz_roundscale_pd(0xff, a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
inline Mask mask(__mmask8 m) { return {m}; }
inline Mask operator<(Vector a, Vector b) { return mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ)); }
inline Mask operator<=(Vector a, Vector b) { return mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ)); }
inline Mask operator==(Vector a, Vector b) { return mask(_mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ)); }
inline Mask operator&(Mask a, Mask b) { return {static_cast<__mmask8>(a.v & b.v)}; }
inline Mask operator|(Mask a, Mask b) { return {static_cast<__mmask8>(a.v | b.v)}; }
inline bool allOf(Mask a) { return a.v == 0xff; }
inline Vector select(Mask m, Vector a, Vector b) { return {_mm512_mask_blend_pd(m.v, b.v, a.v)}; }
inline Vector ones(Mask m) { return {_mm512_maskz_mov_pd(m.v, _mm512_set1_pd(1.0))}; }
inline Mask isSet(Vector a) { return mask(_mm512_cmp_pd_mask(a.v, _mm512_setzero_pd(), _CMP_NEQ_UQ)); }
struct Block {
  __m512d rows[8];
};
/// Returns the first n numbers from x, then zeros.
inline __m512d loadFirst(const double* x, int n) {
  return _mm512_maskz_loadu_pd(static_cast<__mmask8>((1 << n) - 1), x);
}
inline void storeFirst(double* to, __m512d x, int n) {
  _mm512_mask_storeu_pd(to, static_cast<__mmask8>((1 << n) - 1), x);
}
inline Block transposed(const Block& x) {
  __m512d pairs[8], quads[8];
  for (int i = 0; i < 8; i += 2) {
    pairs[i] =
        _mm512_maskz_unpacklo_pd(0xff, x.rows[i], x.rows[i + 1]);  // columns 0, 2, 4, 6 of rows i, i + 1
    pairs[i + 1] = _mm512_maskz_unpackhi_pd(0xff, x.rows[i], x.rows[i + 1]);  // columns 1, 3, 5, 7
  }
  for (int half = 0; half < 2; ++half) {  // rows 4 half ... 4 half + 3
    for (int odd = 0; odd < 2; ++odd) {
      const __m512d a = pairs[4 * half + odd], b = pairs[4 * half + 2 + odd];
      quads[4 * half + odd] = _mm512_maskz_shuffle_f64x2(0xff, a, b, 0x88);      // columns odd, odd + 4
      quads[4 * half + 2 + odd] = _mm512_maskz_shuffle_f64x2(0xff, a, b, 0xdd);  // columns odd + 2, odd + 6
    }
  }
  const __m512i low = _mm512_setr_epi64(0, 1, 4, 5, 8, 9, 12, 13),
                high = _mm512_setr_epi64(2, 3, 6, 7, 10, 11, 14, 15);
  Block result;
  for (int c = 0; c < 4; ++c) {
    const __m512d a = quads[2 * (c / 2) + c % 2], b = quads[4 + 2 * (c / 2) + c % 2];
    result.rows[c] = _mm512_maskz_permutex2var_pd(0xff, a, low, b);
    result.rows[c + 4] = _mm512_maskz_permutex2var_pd(0xff, a, high, b);
  }
  return result;
}

}  // namespace
}  // namespace slom::tape

#include "tape/kernels.inl"

namespace slom::tape {
extern const Kernels kAvx512Kernels;
const Kernels kAvx512Kernels = makeKernels();
}  // namespace slom::tape
