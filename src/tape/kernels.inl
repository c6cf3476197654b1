// Instructions of tapes on lanes. Each kernels_*.cpp includes this file once, after it has defined kLanesOfVector and
// the type Vector with loads, stores, arithmetic, comparisons and selections.
// Multiply-adds are written out, so compilers do not change the bits.
//   source   sine, cosine and arc tangent: see mtk/pack_functions.hpp

#include <math.h>  // NOLINT: functions of C alone, which are compiled elsewhere

#include "tape/instructions.hpp"
#include "tape/kernels.hpp"

namespace slom::tape {
namespace {

using Registers = double*;

template <int N>
Vector polynomial(Vector x, const double (&c)[N]) {
  Vector sum = all(c[N - 1]);
  for (int i = N - 1; i-- > 0;) sum = fma(sum, x, all(c[i]));
  return sum;
}

struct Sine {
  Vector sine, cosine;
};
inline Sine sineOf(Vector x, const double* from) {
  const Vector turns = roundToInteger(x * all(0.63661977236758134308));
  Vector r = fnma(turns, all(1.57079632673412561417e+00), x);
  r = fnma(turns, all(6.07710050630396597660e-11), r);
  r = fnma(turns, all(2.02226624879595063154e-21), r);
  const Vector r2 = r * r;
  static constexpr double s[] = {-1.0 / 6,        1.0 / 120,          -1.0 / 5040,           1.0 / 362880,
                                 -1.0 / 39916800, 1.0 / 6227020800.0, -1.0 / 1307674368000.0};
  static constexpr double c[] = {
      1.0 / 24,          -1.0 / 720,           1.0 / 40320,           -1.0 / 3628800,
      1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};
  const Vector sin_r = fma(r * r2, polynomial(r2, s), r);
  const Vector half = r2 * all(0.5);
  const Vector cos_r = all(1.0) - fnma(r2 * r2, polynomial(r2, c), half);
  // Quadrant q = turns mod 4, one of -1, 0, 1, 2: odd ones swap sine and cosine.
  const Vector q = fnma(all(4.0), roundToInteger(fnma(all(-0.25), turns, all(-0.0625))), turns);
  const Mask plus_one = q == all(1.0), minus_one = q == all(-1.0), two = q == all(2.0);
  const Mask odd = plus_one | minus_one;
  const Vector a = select(odd, cos_r, sin_r), b = select(odd, sin_r, cos_r);
  Sine result{select(minus_one | two, -a, a), select(plus_one | two, -b, b)};
  const Mask near = (x <= all(1e5)) & (all(-1e5) <= x);
  if (!allOf(near)) {  // where the reduction loses digits
    double sine[kLanesOfVector], cosine[kLanesOfVector];
    for (int i = 0; i < kLanesOfVector; ++i) {
      sine[i] = ::sin(from[i]);
      cosine[i] = ::cos(from[i]);
    }
    result.sine = select(near, result.sine, load(sine));
    result.cosine = select(near, result.cosine, load(cosine));
  }
  return result;
}

inline Vector arcTangent(Vector y, Vector x, const double* from_y, const double* from_x) {
  const Vector width = absolute(x), height = absolute(y);
  const Mask steep = width < height;
  const Vector small = select(steep, width, height), large = select(steep, height, width);
  const Mask beyond = large * all(0.4142135623730950488) < small;
  Vector divisor = select(beyond, small + large, large);
  divisor = select(divisor == all(0.0), all(1.0), divisor);
  const Vector t = select(beyond, small - large, small) / divisor;
  const Vector z = t * t;
  static constexpr double p[] = {-6.485021904942025371773e1, -1.228866684490136173410e2,
                                 -7.500855792314704667340e1, -1.615753718733365076637e1,
                                 -8.750608600031904122785e-1};
  static constexpr double q[] = {1.945506571482613964425e2, 4.853903996359136964868e2,
                                 4.328810604912902668951e2, 1.650270098316988542046e2,
                                 2.485846490142306297962e1, 1.0};
  const Vector correction = t * z * polynomial(z, p) / polynomial(z, q);
  Vector angle =
      select(beyond, all(0.78539816339744830962) + (t + (correction + all(3.061616997868382943e-17))),
             t + correction);
  angle = select(steep, all(1.57079632679489661923) - (angle - all(6.123233995736765886e-17)), angle);
  angle = select(x < all(0.0), all(3.14159265358979323846) - (angle - all(1.2246467991473531772e-16)), angle);
  angle = select(y < all(0.0), -angle, angle);
  const Mask ordinary = large <= all(1.7976931348623157e308);
  if (!allOf(ordinary)) {
    double exact[kLanesOfVector];
    for (int i = 0; i < kLanesOfVector; ++i) exact[i] = ::atan2(from_y[i], from_x[i]);
    angle = select(ordinary, angle, load(exact));
  }
  return angle;
}

inline double inverseArcOfOne(double a, double b) {
  const double wide = ::fabs(a), high = ::fabs(b), largest = wide > high ? wide : high;
  const double size = largest > 0 ? largest : 1, u = a / size, v = b / size, norm = (u * u + v * v) * size;
  if (!(norm > 0)) return norm == norm ? 0 : norm;
  const double reciprocal = 1 / norm;
  return u * (reciprocal <= 1.7976931348623157e308 ? reciprocal : 1.7976931348623157e308);
}
inline Vector inverseArc(Vector a, Vector b, const double* from_a, const double* from_b) {
  const Vector square = fma(a, a, b * b);
  const Mask ordinary = (all(1e-30) < square) & (square < all(1e30));
  const Vector result = a * (all(1.0) / square);
  if (allOf(ordinary)) return result;
  double exact[kLanesOfVector];
  for (int i = 0; i < kLanesOfVector; ++i) exact[i] = inverseArcOfOne(from_a[i], from_b[i]);
  return select(ordinary, result, load(exact));
}

/// Returns the angle in [-pi, pi) that differs by whole turns, as mtk::SO2 does.
inline double wrappedOne(double a) {
  constexpr double two_pi = 6.283185307179586476925286766559005768L, half = two_pi / 2;
  constexpr double rest = 6.283185307179586476925286766559005768L - static_cast<long double>(two_pi);
  if (a >= -half && a < half) return a;
  if (!(a >= -1e3 && a <= 1e3)) {
    const double reduced = ::atan2(::sin(a), ::cos(a));
    return reduced >= half ? -half : reduced;
  }
  const double turns = ::floor(a / two_pi + 0.5);
  double wrapped = (a - turns * two_pi) - turns * rest;
  if (wrapped >= half) wrapped -= two_pi;
  return wrapped < -half ? -half : wrapped;
}
inline Vector wrapped(Vector a, const double* from) {
  const Mask ordinary = (all(-3.141592653589793) <= a) & (a < all(3.141592653589793));
  if (allOf(ordinary)) return a;
  double exact[kLanesOfVector];
  for (int i = 0; i < kLanesOfVector; ++i) exact[i] = wrappedOne(from[i]);
  return load(exact);
}

/// The result of an instruction for the vector that begins at these numbers.
template <Kind K>
inline Vector resultOf(const double* a, const double* b, const double* c, const double* d, const double* e,
                       const double* f, const double* g) {
  const auto A = [&] { return load(a); };
  const auto B = [&] { return load(b); };
  const auto C = [&] { return load(c); };
  const auto D = [&] { return load(d); };
  const auto E = [&] { return load(e); };
  const auto F = [&] { return load(f); };
  const auto G = [&] { return load(g); };
  if constexpr (K == Kind::copy) return A();
  if constexpr (K == Kind::add) return A() + B();
  if constexpr (K == Kind::subtract) return A() - B();
  if constexpr (K == Kind::negate) return -A();
  if constexpr (K == Kind::negated_sum) return -A() - B();
  if constexpr (K == Kind::divide) return A() / B();
  if constexpr (K == Kind::reciprocal) return all(1.0) / A();
  if constexpr (K == Kind::scale) return select(B() == all(0.0), all(0.0), A() * B());
  if constexpr (K == Kind::inverse_arc) return inverseArc(A(), B(), a, b);
  if constexpr (K == Kind::sign)
    return select(A() < all(0.0), all(-1.0), select(all(0.0) < A(), all(1.0), all(0.0)));
  if constexpr (K == Kind::abs) return absolute(A());
  if constexpr (K == Kind::wrap) return wrapped(A(), a);
  if constexpr (K == Kind::sqrt) return squareRoot(A());
  if constexpr (K == Kind::sin) return sineOf(A(), a).sine;
  if constexpr (K == Kind::cos) return sineOf(A(), a).cosine;
  if constexpr (K == Kind::atan2) return arcTangent(A(), B(), a, b);
  if constexpr (K == Kind::less) return ones(A() < B());
  if constexpr (K == Kind::less_equal) return ones(A() <= B());
  if constexpr (K == Kind::equal) return ones(A() == B());
  if constexpr (K == Kind::both) return select(isSet(A()), B(), all(0.0));
  if constexpr (K == Kind::either) return select(isSet(A()), A(), B());
  if constexpr (K == Kind::opposite) return select(isSet(A()), all(0.0), all(1.0));
  if constexpr (K == Kind::select) return select(isSet(A()), B(), C());
  if constexpr (K == Kind::p) return A() * B();
  if constexpr (K == Kind::m) return -(A() * B());
  if constexpr (K == Kind::pp) return fma(C(), D(), A() * B());
  if constexpr (K == Kind::pm) return fnma(C(), D(), A() * B());
  if constexpr (K == Kind::mm) return fnma(C(), D(), -(A() * B()));
  if constexpr (K == Kind::ppp) return fma(E(), F(), fma(C(), D(), A() * B()));
  if constexpr (K == Kind::ppm) return fnma(E(), F(), fma(C(), D(), A() * B()));
  if constexpr (K == Kind::pmm) return fnma(E(), F(), fnma(C(), D(), A() * B()));
  if constexpr (K == Kind::mmm) return fnma(E(), F(), fnma(C(), D(), -(A() * B())));
  if constexpr (K == Kind::p_sp) return fma(A(), B(), C());
  if constexpr (K == Kind::p_sm) return fms(A(), B(), C());
  if constexpr (K == Kind::m_sp) return fnma(A(), B(), C());
  if constexpr (K == Kind::m_sm) return -fma(A(), B(), C());
  if constexpr (K == Kind::pp_sp) return fma(C(), D(), fma(A(), B(), E()));
  if constexpr (K == Kind::pm_sp) return fnma(C(), D(), fma(A(), B(), E()));
  if constexpr (K == Kind::mm_sp) return fnma(C(), D(), fnma(A(), B(), E()));
  if constexpr (K == Kind::pp_sm) return fma(C(), D(), fms(A(), B(), E()));
  if constexpr (K == Kind::pm_sm) return fnma(C(), D(), fms(A(), B(), E()));
  if constexpr (K == Kind::mm_sm) return -fma(C(), D(), fma(A(), B(), E()));
  if constexpr (K == Kind::ppp_sp) return fma(E(), F(), fma(C(), D(), fma(A(), B(), G())));
  if constexpr (K == Kind::ppm_sp) return fnma(E(), F(), fma(C(), D(), fma(A(), B(), G())));
  if constexpr (K == Kind::pmm_sp) return fnma(E(), F(), fnma(C(), D(), fma(A(), B(), G())));
  if constexpr (K == Kind::mmm_sp) return fnma(E(), F(), fnma(C(), D(), fnma(A(), B(), G())));
  if constexpr (K == Kind::ppp_sm) return fma(E(), F(), fma(C(), D(), fms(A(), B(), G())));
  if constexpr (K == Kind::ppm_sm) return fnma(E(), F(), fma(C(), D(), fms(A(), B(), G())));
  if constexpr (K == Kind::pmm_sm) return fnma(E(), F(), fnma(C(), D(), fms(A(), B(), G())));
  if constexpr (K == Kind::mmm_sm) return -fma(E(), F(), fma(C(), D(), fma(A(), B(), G())));
}

// Functions that the C library computes number by number.
template <Kind K>
inline constexpr double (*kFunction)(double) = nullptr;
#define SLOM_TAPE_FUNCTION(name) \
  template <>                    \
  inline constexpr double (*kFunction<Kind::name>)(double) = &::name;
SLOM_TAPE_FUNCTION(floor)
SLOM_TAPE_FUNCTION(tan)
SLOM_TAPE_FUNCTION(asin)
SLOM_TAPE_FUNCTION(acos)
SLOM_TAPE_FUNCTION(atan)
SLOM_TAPE_FUNCTION(sinh)
SLOM_TAPE_FUNCTION(cosh)
SLOM_TAPE_FUNCTION(tanh)
SLOM_TAPE_FUNCTION(asinh)
SLOM_TAPE_FUNCTION(acosh)
SLOM_TAPE_FUNCTION(atanh)
SLOM_TAPE_FUNCTION(exp)
SLOM_TAPE_FUNCTION(expm1)
SLOM_TAPE_FUNCTION(log)
SLOM_TAPE_FUNCTION(log1p)
SLOM_TAPE_FUNCTION(cbrt)
SLOM_TAPE_FUNCTION(erf)
SLOM_TAPE_FUNCTION(erfc)
#undef SLOM_TAPE_FUNCTION

template <Kind K, int Lanes>
void execute(const Instruction& instruction, Registers arena) {
  const auto at = [&](int k) { return arena + static_cast<std::size_t>(instruction.from[k]) * Lanes; };
  double* const to = arena + static_cast<std::size_t>(instruction.to) * Lanes;
  if constexpr (kFunction<K> != nullptr) {
    const double* const a = at(0);
    for (int i = 0; i < Lanes; ++i) to[i] = kFunction<K>(a[i]);
  } else if constexpr (K == Kind::hypot || K == Kind::pow) {
    const double *const a = at(0), *const b = at(1);
    for (int i = 0; i < Lanes; ++i) to[i] = K == Kind::hypot ? ::hypot(a[i], b[i]) : ::pow(a[i], b[i]);
  } else if constexpr (K == Kind::sin_cos) {
    const double* const a = at(0);
    double* const second = at(1);
    for (int i = 0; i < Lanes; i += kLanesOfVector) {
      const Sine result = sineOf(load(a + i), a + i);
      store(to + i, result.sine);
      store(second + i, result.cosine);
    }
  } else {
    constexpr int operands = kOperandsOfKind[static_cast<int>(K)];
    const double *const a = at(0), *const b = operands > 1 ? at(1) : a, *const c = operands > 2 ? at(2) : a,
                        *const d = operands > 3 ? at(3) : a, *const e = operands > 4 ? at(4) : a,
                        *const f = operands > 5 ? at(5) : a, *const g = operands > 6 ? at(6) : a;
    for (int i = 0; i < Lanes; i += kLanesOfVector)
      store(to + i, resultOf<K>(a + i, b + i, c + i, d + i, e + i, f + i, g + i));
  }
}

template <int Lanes>
void run(const Instruction* code, std::size_t count, double* arena) {
  using Execute = void (*)(const Instruction&, Registers);
  static constexpr Execute table[] = {
#define SLOM_TAPE_ENTRY(name, operands) &execute<Kind::name, Lanes>,
      SLOM_TAPE_SIMPLE(SLOM_TAPE_ENTRY) SLOM_TAPE_SUMS(SLOM_TAPE_ENTRY)
#undef SLOM_TAPE_ENTRY
  };
  for (const Instruction* const end = code + count; code != end; ++code) table[code->kind](*code, arena);
}

/// Moves a block: `used` numbers of each row.
inline void gatherBlock(const double* const* from, int offset, int used, int lanes, double* to) {
  Block block;
  for (int l = 0; l < kLanesOfVector; ++l) block.rows[l] = loadFirst(from[l] + offset, used);
  block = transposed(block);
  for (int l = 0; l < used; ++l) storeFirst(to + l * lanes, block.rows[l], kLanesOfVector);
}
void gather(const double* const* from, int size, int lanes, double* to) {
  for (int k = 0; k < lanes; k += kLanesOfVector) {
    int i = 0;
    for (; i + kLanesOfVector <= size; i += kLanesOfVector)
      gatherBlock(from + k, i, kLanesOfVector, lanes, to + i * lanes + k);
    if (i < size) gatherBlock(from + k, i, size - i, lanes, to + i * lanes + k);
  }
}

/// Moves a block: `used` rows.
inline void scatterBlock(const double* const* from, int offset, int used, int size, double* to) {
  Block block;
  for (int l = 0; l < kLanesOfVector; ++l)
    block.rows[l] = loadFirst(from[l < used ? l : 0] + offset, kLanesOfVector);
  block = transposed(block);
  for (int l = 0; l < kLanesOfVector; ++l)
    storeFirst(to + static_cast<std::ptrdiff_t>(l) * size, block.rows[l], used);
}
/// Moves kLanesOfVector measurements, from number `offset` of the rows.
inline void scatterMeasurements(const double* const* from, int offset, int size, double* to) {
  int i = 0;
  for (; i + kLanesOfVector <= size; i += kLanesOfVector)
    scatterBlock(from + i, offset, kLanesOfVector, size, to + i);
  if (i < size) scatterBlock(from + i, offset, size - i, size, to + i);
}
void scatter(const double* const* from, int size, int lanes, double* to) {
  // Stores that cross cache lines take twice the time. So results for such a place are put together elsewhere and copied,
  // which the C library does by whole lines.
  constexpr int most = 128;
  alignas(64) double together[kLanesOfVector * most];
  const bool crosses = reinterpret_cast<unsigned long long>(to) % 64 != 0 && size >= 16 && size <= most;
  for (int k = 0; k < lanes; k += kLanesOfVector) {
    scatterMeasurements(from, k, size, crosses ? together : to);
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(kLanesOfVector) * size;
    if (crosses) __builtin_memcpy(to, together, static_cast<std::size_t>(count) * sizeof(double));
    to += count;
  }
}

constexpr Kernels makeKernels() { return {&run<kManyLanes>, &run<kFewLanes>, &gather, &scatter}; }

}  // namespace
}  // namespace slom::tape
