// Instructions of tapes for processors with AVX2 and FMA, compiled with these enabled.
#include <immintrin.h>

namespace slom::tape {
namespace {

constexpr int kLanesOfVector = 4;

struct Mask {
  __m256d v;
};
struct Vector {
  __m256d v;
};
inline Vector load(const double* x) { return {_mm256_loadu_pd(x)}; }
inline void store(double* to, Vector x) { _mm256_storeu_pd(to, x.v); }
inline Vector all(double x) { return {_mm256_set1_pd(x)}; }
inline Vector operator+(Vector a, Vector b) { return {_mm256_add_pd(a.v, b.v)}; }
inline Vector operator-(Vector a, Vector b) { return {_mm256_sub_pd(a.v, b.v)}; }
inline Vector operator*(Vector a, Vector b) { return {_mm256_mul_pd(a.v, b.v)}; }
inline Vector operator/(Vector a, Vector b) { return {_mm256_div_pd(a.v, b.v)}; }
inline Vector operator-(Vector a) { return {_mm256_xor_pd(a.v, _mm256_set1_pd(-0.0))}; }
inline Vector absolute(Vector a) { return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)}; }
inline Vector fma(Vector a, Vector b, Vector c) { return {_mm256_fmadd_pd(a.v, b.v, c.v)}; }
inline Vector fms(Vector a, Vector b, Vector c) { return {_mm256_fmsub_pd(a.v, b.v, c.v)}; }
inline Vector fnma(Vector a, Vector b, Vector c) { return {_mm256_fnmadd_pd(a.v, b.v, c.v)}; }
inline Vector squareRoot(Vector a) { return {_mm256_sqrt_pd(a.v)}; }
inline Vector roundToInteger(Vector a) {
  return {_mm256_round_pd(a.v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC)};
}
inline Mask operator<(Vector a, Vector b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LT_OQ)}; }
inline Mask operator<=(Vector a, Vector b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ)}; }
inline Mask operator==(Vector a, Vector b) { return {_mm256_cmp_pd(a.v, b.v, _CMP_EQ_OQ)}; }
inline Mask operator&(Mask a, Mask b) { return {_mm256_and_pd(a.v, b.v)}; }
inline Mask operator|(Mask a, Mask b) { return {_mm256_or_pd(a.v, b.v)}; }
inline bool allOf(Mask a) { return _mm256_movemask_pd(a.v) == 15; }
inline Vector select(Mask m, Vector a, Vector b) { return {_mm256_blendv_pd(b.v, a.v, m.v)}; }
inline Vector ones(Mask m) { return {_mm256_and_pd(m.v, _mm256_set1_pd(1.0))}; }
inline Mask isSet(Vector a) { return {_mm256_cmp_pd(a.v, _mm256_setzero_pd(), _CMP_NEQ_UQ)}; }
struct Block {
  __m256d rows[4];
};
inline __m256i firstOf(int n) {
  return _mm256_cmpgt_epi64(_mm256_set1_epi64x(n), _mm256_setr_epi64x(0, 1, 2, 3));
}
/// Returns the first n numbers from x, then zeros.
inline __m256d loadFirst(const double* x, int n) {
  return n == 4 ? _mm256_loadu_pd(x) : _mm256_maskload_pd(x, firstOf(n));
}
inline void storeFirst(double* to, __m256d x, int n) {
  if (n == 4) {
    _mm256_storeu_pd(to, x);
  } else {
    _mm256_maskstore_pd(to, firstOf(n), x);
  }
}
inline Block transposed(const Block& x) {
  const __m256d ab0 = _mm256_unpacklo_pd(x.rows[0], x.rows[1]),
                ab1 = _mm256_unpackhi_pd(x.rows[0], x.rows[1]);
  const __m256d cd0 = _mm256_unpacklo_pd(x.rows[2], x.rows[3]),
                cd1 = _mm256_unpackhi_pd(x.rows[2], x.rows[3]);
  return {{_mm256_permute2f128_pd(ab0, cd0, 0x20), _mm256_permute2f128_pd(ab1, cd1, 0x20),
           _mm256_permute2f128_pd(ab0, cd0, 0x31), _mm256_permute2f128_pd(ab1, cd1, 0x31)}};
}

}  // namespace
}  // namespace slom::tape

#include "tape/kernels.inl"

namespace slom::tape {
extern const Kernels kAvx2Kernels;
const Kernels kAvx2Kernels = makeKernels();
}  // namespace slom::tape
