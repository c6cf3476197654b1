/// Numbers that record what is done with them. A measurement function that is called once with them leaves its formula
/// in a Recording.
///   state      a constant, or a node of the current Recording
///   branches   a comparison gives a Condition: use `mtk::select(condition, a, b)` in place of `if`, as with packs
///   functions  the functions of <cmath>, found by argument
/// Constants are folded at once. The numbers of one Recording must not be used in another: [slom.traced-elsewhere].
#pragma once

#include <cstdint>
#include <initializer_list>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/scalar.hpp"

namespace slom::tape {

/// What a node of a recorded formula computes from up to three others, a, b and c.
enum class Operation : std::uint8_t {
  constant,
  coordinate,   ///< a number that stores a variable
  datum,        ///< a number of the measurement's data
  tangent,      ///< an unknown of the derivatives; it has no value
  add,          ///< a + b
  subtract,     ///< a - b
  multiply,     ///< a b
  negate,       ///< -a
  divide,       ///< a / b
  reciprocal,   ///< 1 / a
  scale,        ///< a b, and 0 if b is 0: for derivatives a that may be infinite
  inverse_arc,  ///< a / (a^2 + b^2), and 0 if both are 0: derivatives of atan2
  sign,         ///< -1, 0 or 1
  abs,
  floor,
  wrap,  ///< the angle in [-pi, pi) that differs by whole turns
  sqrt,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  asinh,
  acosh,
  atanh,
  exp,
  expm1,
  log,
  log1p,
  cbrt,
  erf,
  erfc,
  atan2,
  hypot,
  pow,
  less,        ///< a < b
  less_equal,  ///< a <= b
  equal,       ///< a == b
  both,        ///< a and b
  either,      ///< a or b
  opposite,    ///< not a
  select,      ///< a ? b : c
};
inline constexpr int kOperations = static_cast<int>(Operation::select) + 1;

class Condition;
class Number;
class Recording;

namespace detail {
/// Returns the result of an operation on numbers of the current recording.
Number apply(Operation operation, const Number& a);
Number apply(Operation operation, const Number& a, const Number& b);
Condition compare(Operation operation, const Number& a, const Number& b);
Condition combine(Operation operation, const Condition& a, const Condition& b);
Number choose(const Condition& condition, const Number& a, const Number& b);
struct Access;
}  // namespace detail

class Number {
 public:
  /// Creates the constant 0.
  Number() = default;
  /// Creates a constant.
  template <class T>
    requires std::is_arithmetic_v<T>
  Number(const T& x) : value_(static_cast<double>(x)) {}  // NOLINT(google-explicit-constructor): a constant

  /// Returns whether the number does not depend on variables or data.
  bool isConstant() const { return recording_ == 0; }
  /// Returns the value of a constant; NaN for other numbers.
  double constant() const { return value_; }

  Number& operator+=(const Number& b) { return *this = *this + b; }
  Number& operator-=(const Number& b) { return *this = *this - b; }
  Number& operator*=(const Number& b) { return *this = *this * b; }
  Number& operator/=(const Number& b) { return *this = *this / b; }

  friend Number operator+(const Number& a) { return a; }
  friend Number operator-(const Number& a) { return detail::apply(Operation::negate, a); }
  friend Number operator+(const Number& a, const Number& b) { return detail::apply(Operation::add, a, b); }
  friend Number operator-(const Number& a, const Number& b) {
    return detail::apply(Operation::subtract, a, b);
  }
  friend Number operator*(const Number& a, const Number& b) {
    return detail::apply(Operation::multiply, a, b);
  }
  friend Number operator/(const Number& a, const Number& b) { return detail::apply(Operation::divide, a, b); }
  friend Condition operator<(const Number& a, const Number& b);
  friend Condition operator<=(const Number& a, const Number& b);
  friend Condition operator>(const Number& a, const Number& b);
  friend Condition operator>=(const Number& a, const Number& b);
  friend Condition operator==(const Number& a, const Number& b);
  friend Condition operator!=(const Number& a, const Number& b);

 private:
  friend struct detail::Access;
  double value_ = 0;
  std::uint32_t node_ = 0;
  std::uint32_t recording_ = 0;  ///< 0: a constant
};

/// The result of a comparison. It has no value while the function is recorded.
class Condition {
 public:
  /// Creates a constant.
  Condition(bool value) : value_(value) {}  // NOLINT(google-explicit-constructor): a constant

  /// Returns whether the condition depends neither on variables nor on data.
  bool isConstant() const { return recording_ == 0; }
  /// Returns the value of a constant; false for other conditions.
  bool constant() const { return value_; }

  /// Refuses to compile, because a traced function must not branch on the values of variables.
  template <class T = void>
  explicit operator bool() const {
    static_assert(!std::is_same_v<T, T>,
                  "slom: a traced measurement function cannot branch on a computed number: write "
                  "mtk::select(condition, a, b) in place of `if`, `?:`, && and ||");
    return false;
  }
  friend Condition operator&&(const Condition& a, const Condition& b) {
    return detail::combine(Operation::both, a, b);
  }
  friend Condition operator||(const Condition& a, const Condition& b) {
    return detail::combine(Operation::either, a, b);
  }
  friend Condition operator!(const Condition& a) { return detail::combine(Operation::opposite, a, a); }
  /// Returns whether the condition is known to hold.
  friend bool all(const Condition& a) { return a.isConstant() && a.constant(); }
  /// Returns whether the condition may hold.
  friend bool any(const Condition& a) { return !a.isConstant() || a.constant(); }

 private:
  friend struct detail::Access;
  bool value_ = false;
  std::uint32_t node_ = 0;
  std::uint32_t recording_ = 0;
};

inline Condition operator<(const Number& a, const Number& b) {
  return detail::compare(Operation::less, a, b);
}
inline Condition operator<=(const Number& a, const Number& b) {
  return detail::compare(Operation::less_equal, a, b);
}
inline Condition operator>(const Number& a, const Number& b) { return b < a; }
inline Condition operator>=(const Number& a, const Number& b) { return b <= a; }
inline Condition operator==(const Number& a, const Number& b) {
  return detail::compare(Operation::equal, a, b);
}
inline Condition operator!=(const Number& a, const Number& b) { return !(a == b); }

/// Returns a where the condition holds, b elsewhere. The side that is not taken contributes exactly 0 to derivatives.
inline Number select(const Condition& condition, const Number& a, const Number& b) {
  return detail::choose(condition, a, b);
}

/// Throws [slom.traced-branch], which names the place. For languages that convert to bool when a program runs.
[[noreturn]] void raiseBranch(const Condition& condition);

#define SLOM_TAPE_FUNCTION(name) \
  inline Number name(const Number& x) { return detail::apply(Operation::name, x); }
SLOM_TAPE_FUNCTION(abs)
SLOM_TAPE_FUNCTION(floor)
SLOM_TAPE_FUNCTION(sqrt)
SLOM_TAPE_FUNCTION(sin)
SLOM_TAPE_FUNCTION(cos)
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
/// Returns |x|.
inline Number fabs(const Number& x) { return abs(x); }
/// Returns x^2.
inline Number abs2(const Number& x) { return x * x; }
/// Returns the least integer that is not below x.
inline Number ceil(const Number& x) { return -floor(-x); }
/// Returns the logarithm to the base 2.
inline Number log2(const Number& x) { return log(x) * 1.4426950408889634073599246810018921; }
/// Returns the logarithm to the base 10.
inline Number log10(const Number& x) { return log(x) * 0.4342944819032518276511289189166051; }
/// Returns the angle of (x, y) in [-pi, pi].
inline Number atan2(const Number& y, const Number& x) { return detail::apply(Operation::atan2, y, x); }
/// Returns sqrt(x^2 + y^2).
inline Number hypot(const Number& x, const Number& y) { return detail::apply(Operation::hypot, x, y); }
/// Returns x to the power of y.
inline Number pow(const Number& x, const Number& y) { return detail::apply(Operation::pow, x, y); }
/// Returns the smaller number.
inline Number fmin(const Number& a, const Number& b) { return select(b < a, b, a); }
/// Returns the larger number.
inline Number fmax(const Number& a, const Number& b) { return select(a < b, b, a); }
/// Returns the smaller number.
inline Number min(const Number& a, const Number& b) { return fmin(a, b); }
/// Returns the larger number.
inline Number max(const Number& a, const Number& b) { return fmax(a, b); }

/// Returns the angle in [-pi, pi) that differs by whole turns. The turns have no derivatives.
inline Number wrap(const Number& angle) { return detail::apply(Operation::wrap, angle); }

/// Returns a number of the measurement's data with this value. Captured numbers that are passed through this function
/// are data, so functions that differ in them alone have the same tape.
Number data(double value);

}  // namespace slom::tape

namespace mtk {

template <>
inline constexpr bool is_scalar_v<slom::tape::Number> = true;

namespace detail {

template <>
struct BuiltIn<slom::tape::Number> {
  using type = double;
};
/// Checks of values are left out while a function is recorded; bad values become NaN or infinite when the tape runs.
template <>
inline bool allOf<slom::tape::Condition>(const slom::tape::Condition& condition) {
  return any(condition);
}
template <>
inline double firstWithout<slom::tape::Condition, slom::tape::Number>(const slom::tape::Condition&,
                                                                      const slom::tape::Number& x) {
  return x.constant();
}
template <class S>
S wrapAngle(const S& a);
template <>
inline slom::tape::Number wrapAngle<slom::tape::Number>(const slom::tape::Number& a) {
  return slom::tape::wrap(a);
}

}  // namespace detail
}  // namespace mtk

namespace Eigen {

template <>
struct NumTraits<slom::tape::Number> : NumTraits<double> {
  using Real = slom::tape::Number;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
  enum { RequireInitialization = 1 };
};
template <class T, class Op>
  requires std::is_arithmetic_v<T>
struct ScalarBinaryOpTraits<T, slom::tape::Number, Op> {
  using ReturnType = slom::tape::Number;
};
template <class T, class Op>
  requires std::is_arithmetic_v<T>
struct ScalarBinaryOpTraits<slom::tape::Number, T, Op> {
  using ReturnType = slom::tape::Number;
};

}  // namespace Eigen
