// Instructions of tapes for any processor. Multiply-adds round twice.
#include <math.h>  // NOLINT: functions of C alone, as in the other kernels

namespace slom::tape {
namespace {

constexpr int kLanesOfVector = 4;

struct Mask {
  bool v[kLanesOfVector];
};
struct Vector {
  double v[kLanesOfVector];
};
#define SLOM_TAPE_EACH(type, expression)                        \
  type r;                                                       \
  for (int i = 0; i < kLanesOfVector; ++i) r.v[i] = expression; \
  return r
inline Vector load(const double* x) { SLOM_TAPE_EACH(Vector, x[i]); }
inline void store(double* to, Vector x) {
  for (int i = 0; i < kLanesOfVector; ++i) to[i] = x.v[i];
}
inline Vector all(double x) { SLOM_TAPE_EACH(Vector, x); }
inline Vector operator+(Vector a, Vector b) { SLOM_TAPE_EACH(Vector, a.v[i] + b.v[i]); }
inline Vector operator-(Vector a, Vector b) { SLOM_TAPE_EACH(Vector, a.v[i] - b.v[i]); }
inline Vector operator*(Vector a, Vector b) { SLOM_TAPE_EACH(Vector, a.v[i] * b.v[i]); }
inline Vector operator/(Vector a, Vector b) { SLOM_TAPE_EACH(Vector, a.v[i] / b.v[i]); }
inline Vector operator-(Vector a) { SLOM_TAPE_EACH(Vector, -a.v[i]); }
inline Vector absolute(Vector a) { SLOM_TAPE_EACH(Vector, ::fabs(a.v[i])); }
inline Vector fma(Vector a, Vector b, Vector c) { SLOM_TAPE_EACH(Vector, a.v[i] * b.v[i] + c.v[i]); }
inline Vector fms(Vector a, Vector b, Vector c) { SLOM_TAPE_EACH(Vector, a.v[i] * b.v[i] - c.v[i]); }
inline Vector fnma(Vector a, Vector b, Vector c) { SLOM_TAPE_EACH(Vector, c.v[i] - a.v[i] * b.v[i]); }
inline Vector squareRoot(Vector a) { SLOM_TAPE_EACH(Vector, ::sqrt(a.v[i])); }
inline Vector roundToInteger(Vector a) { SLOM_TAPE_EACH(Vector, ::nearbyint(a.v[i])); }
inline Mask operator<(Vector a, Vector b) { SLOM_TAPE_EACH(Mask, a.v[i] < b.v[i]); }
inline Mask operator<=(Vector a, Vector b) { SLOM_TAPE_EACH(Mask, a.v[i] <= b.v[i]); }
inline Mask operator==(Vector a, Vector b) { SLOM_TAPE_EACH(Mask, a.v[i] == b.v[i]); }
inline Mask operator&(Mask a, Mask b) { SLOM_TAPE_EACH(Mask, a.v[i] && b.v[i]); }
inline Mask operator|(Mask a, Mask b) { SLOM_TAPE_EACH(Mask, a.v[i] || b.v[i]); }
inline bool allOf(Mask a) { return a.v[0] && a.v[1] && a.v[2] && a.v[3]; }
inline Vector select(Mask m, Vector a, Vector b) { SLOM_TAPE_EACH(Vector, m.v[i] ? a.v[i] : b.v[i]); }
inline Vector ones(Mask m) { SLOM_TAPE_EACH(Vector, m.v[i] ? 1 : 0); }
inline Mask isSet(Vector a) { SLOM_TAPE_EACH(Mask, a.v[i] != 0); }
#undef SLOM_TAPE_EACH
struct Block {
  Vector rows[kLanesOfVector];
};
/// Returns the first n numbers from x, then zeros.
inline Vector loadFirst(const double* x, int n) {
  Vector r = all(0);
  for (int i = 0; i < n; ++i) r.v[i] = x[i];
  return r;
}
inline void storeFirst(double* to, Vector x, int n) {
  for (int i = 0; i < n; ++i) to[i] = x.v[i];
}
inline Block transposed(const Block& x) {
  Block r;
  for (int i = 0; i < kLanesOfVector; ++i) {
    for (int k = 0; k < kLanesOfVector; ++k) r.rows[k].v[i] = x.rows[i].v[k];
  }
  return r;
}

}  // namespace
}  // namespace slom::tape

#include "tape/kernels.inl"

namespace slom::tape {
extern const Kernels kPortableTapeKernels;
const Kernels kPortableTapeKernels = makeKernels();
}  // namespace slom::tape
