#include "recorded.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <nanobind/stl/string.h>

#include "mtk/error.hpp"
#include "mtk/scalar.hpp"

namespace slom::python {

using tape::Condition;
using tape::Number;

namespace {

/// The last condition whose value was asked for. NumPy 1.24 swallows the error in `array == x`.
thread_local std::optional<Condition> refused;
/// The last error about the value of a number, which a function may swallow, too.
thread_local std::optional<mtk::Error> refused_value;

[[noreturn]] void raiseBranch() {
  throw mtk::Error(
      "slom.traced-branch",
      "the measurement function branches on a recorded number; write slom.where(condition, a, b) for if, "
      "& | ~ for and or not, np.maximum for max, and slom.array([a, b]) for lists that NumPy compares",
      "measure");
}

/// Throws if the function of this recording went on after such an error.
void checkRefused() {
  if (refused_value) throw mtk::Error(*std::exchange(refused_value, std::nullopt));
  if (!refused) return;
  const Condition condition = *refused;
  refused.reset();
  try {
    select(condition, Number(0), Number(1));
  } catch (const mtk::Error&) {
    return;  // of an earlier recording, whose error was seen
  }
  raiseBranch();
}

}  // namespace

struct Captures::State {
  std::map<double, Number> numbers;
};

namespace {
thread_local Captures::State* captures = nullptr;
}

Captures::Captures(bool is_active) : own_(is_active ? new State : nullptr), outer_(captures) {
  captures = own_.get();
}
Captures::~Captures() { captures = outer_; }

Number Captures::number(double value) {
  const double size = std::abs(value);
  const bool is_of_the_formula = size == 0 || size == 0.5 || size == 1 || size == 2 || !std::isfinite(value);
  if (captures == nullptr || is_of_the_formula) return Number(value);
  const auto [place, is_new] = captures->numbers.try_emplace(value);
  if (is_new) place->second = tape::data(value);
  return place->second;
}

nb::object arrayOf(const std::vector<Number>& numbers, const std::vector<std::size_t>& shape) {
  if (shape.empty()) return nb::cast(numbers.front());
  const nb::object numpy = nb::module_::import_("numpy");
  nb::list list;
  for (const Number& x : numbers) list.append(nb::cast(x));
  nb::object array = numpy.attr("empty")(numbers.size(), "object");
  array[nb::slice(nb::none(), nb::none(), nb::none())] = list;
  nb::list sizes;
  for (const std::size_t n : shape) sizes.append(n);
  return array.attr("reshape")(nb::tuple(sizes))
      .attr("view")(nb::module_::import_("slom._array").attr("Array"));
}

nb::object callRecorded(nb::handle f, const nb::tuple& arguments) {
  refused_value.reset();
  return nb::module_::import_("slom._call").attr("call")(f, arguments);
}

void appendNumbers(nb::handle result, std::vector<Number>& numbers) {
  checkRefused();
  Number x;
  if (nb::try_cast<Number>(result, x)) {
    numbers.push_back(x);
  } else if (nb::hasattr(result, "flatten") && nb::hasattr(result, "tolist")) {
    for (const nb::handle entry : nb::object(result.attr("flatten")().attr("tolist")()))
      appendNumbers(entry, numbers);
  } else if (double constant = 0; nb::try_cast<double>(result, constant)) {
    numbers.push_back(Captures::number(constant));
  } else if (nb::isinstance<nb::list>(result) || nb::isinstance<nb::tuple>(result)) {
    for (const nb::handle entry : result) appendNumbers(entry, numbers);
  } else {
    const std::string type = nb::cast<std::string>(nb::str(result.type().attr("__name__")));
    throw mtk::Error("slom.traced-result",
                     "a measurement function returned a value of type " + type +
                         "; return a number, a NumPy array, or a list of such",
                     "measure");
  }
}

namespace {

[[noreturn]] void raiseValue(const char* function, const char* remedy, bool is_remembered = true) {
  const mtk::Error error(
      "slom.traced-value",
      std::string(function) + " needs the value of a recorded number, which is not known yet; " + remedy,
      "measure");
  if (is_remembered) refused_value = error;
  throw error;
}

[[noreturn]] void raiseArithmetic() {
  throw mtk::Error("slom.traced-condition",
                   "arithmetic needs numbers, but got a condition; write slom.where(condition, 1.0, 0.0)",
                   "measure");
}

[[noreturn]] void raiseComplex() {
  throw mtk::Error("slom.traced-complex",
                   "recorded numbers are real; write the real and the imaginary part as numbers of their own",
                   "measure");
}

[[noreturn]] void raiseKey() {
  throw mtk::Error(
      "slom.traced-key",
      "a recorded number has no hash, so dictionaries, sets and cached functions cannot hold it; "
      "keep it in a list or a variable",
      "measure");
}

[[noreturn]] void raisePickle() {
  throw mtk::Error("slom.traced-pickle",
                   "a recorded number exists during the call of the measurement function only and cannot be "
                   "pickled; pickle the values of variables",
                   "measure");
}

/// Returns the number that an operand stands for; nothing for arrays, which do the operation themselves.
std::optional<Number> operandOf(nb::handle x, bool is_captured = true) {
  if (nb::isinstance<Number>(x)) return nb::cast<Number>(x);
  if (nb::isinstance<Condition>(x)) raiseArithmetic();
  if (PyComplex_Check(x.ptr())) raiseComplex();
  const bool is_plain = PyFloat_Check(x.ptr()) || PyLong_Check(x.ptr()) ||
                        (nb::hasattr(x, "__float__") && !nb::hasattr(x, "dtype"));
  if (!is_plain) return std::nullopt;
  const double value = PyFloat_AsDouble(x.ptr());
  if (value == -1 && PyErr_Occurred() != nullptr) throw nb::python_error();
  return is_captured ? Captures::number(value) : Number(value);
}

std::optional<Condition> conditionOf(nb::handle x) {
  if (nb::isinstance<Condition>(x)) return nb::cast<Condition>(x);
  if (PyBool_Check(x.ptr())) return Condition(x.is(nb::handle(Py_True)));
  return std::nullopt;
}

nb::object notImplemented() { return nb::borrow(nb::handle(Py_NotImplemented)); }

/// Declares an operator of numbers: `name` takes the right operand, `reflected` the left one.
template <class F>
void defineOperator(nb::class_<Number>& number, const char* name, const char* reflected, F f) {
  number.def(
      name,
      [f, is_power = std::string_view(name) == "__pow__"](const Number& a, nb::handle other) {
        const std::optional<Number> b = operandOf(other, !is_power);  // an exponent is part of the formula
        return b ? nb::cast(f(a, *b)) : notImplemented();
      },
      nb::arg("other").none());
  if (reflected == nullptr) return;
  number.def(
      reflected,
      [f](const Number& b, nb::handle other) {
        const std::optional<Number> a = operandOf(other);
        return a ? nb::cast(f(*a, b)) : notImplemented();
      },
      nb::arg("other").none());
}

/// Declares an operator of conditions, which commutes.
template <class F>
void defineOperator(nb::class_<Condition>& condition, const char* name, const char* reflected, F f) {
  const auto combine = [f](const Condition& a, nb::handle other) {
    const std::optional<Condition> b = conditionOf(other);
    return b ? nb::cast(f(a, *b)) : notImplemented();
  };
  condition.def(name, combine, nb::arg("other").none());
  if (reflected != nullptr) condition.def(reflected, combine, nb::arg("other").none());
}

/// Declares a function of two numbers. NumPy calls it as a method of entries of arrays.
template <class F>
void defineFunction(nb::class_<Number>& number, const char* name, F f) {
  number.def(name, [name, f](const Number& a, nb::handle other) {
    const std::optional<Number> b = operandOf(other);
    if (!b) throw nb::type_error((std::string(name) + " takes two numbers").c_str());
    return f(a, *b);
  });
}

Number power(const Number& x, const Number& y) {
  if (!y.isConstant()) return pow(x, y);
  const double p = y.constant();
  return p == 3 ? x * x * x : p == 0.5 ? sqrt(x) : pow(x, y);  // the tape has the other short forms
}

Number sign(const Number& x) { return tape::detail::apply(tape::Operation::sign, x); }

/// Returns a // b, as Python computes it: floor(a / b), corrected where the quotient was rounded to an integer.
Number floorDivide(const Number& a, const Number& b) {
  const Number quotient = floor(a / b), rest = sign(b) * (a - quotient * b), size = abs(b);
  return quotient + select(rest >= size, Number(1), select(rest < 0, Number(-1), Number(0)));
}

/// Returns a % b, which has the sign of b.
Number modulo(const Number& a, const Number& b) { return a - floorDivide(a, b) * b; }

/// Returns the remainder of C, which has the sign of a.
Number remainder(const Number& a, const Number& b) {
  const Number rest = modulo(abs(a), abs(b));
  return select(a < 0, -rest, rest);
}

Number truncate(const Number& x) { return select(x < 0, ceil(x), floor(x)); }

void bindConditions(nb::module_& module) {
  nb::class_<Condition> condition(module, "Condition", "The result of a comparison of recorded numbers.");
  condition
      .def("__bool__",
           [](const Condition& c) {
             if (!c.isConstant()) {
               refused = c;
               raiseBranch();
             }
             return c.constant();
           })
      .def("__invert__", [](const Condition& a) { return !a; })
      .def("__repr__",
           [](const Condition& c) {
             return std::string(!c.isConstant() ? "<recorded condition>" : c.constant() ? "True" : "False");
           })
      .def("__hash__", [](const Condition&) -> Py_ssize_t { raiseKey(); })
      .def("__reduce_ex__", [](const Condition&, int) -> nb::object { raisePickle(); })
      .def("__copy__", [](const Condition& c) { return c; })
      .def("__deepcopy__", [](const Condition& c, nb::handle) { return c; });
  defineOperator(condition, "__and__", "__rand__",
                 [](const Condition& a, const Condition& b) { return a && b; });
  defineOperator(condition, "__or__", "__ror__",
                 [](const Condition& a, const Condition& b) { return a || b; });
  const auto differ = [](const Condition& a, const Condition& b) { return (a && !b) || (!a && b); };
  defineOperator(condition, "__xor__", "__rxor__", differ);
  defineOperator(condition, "__ne__", nullptr, differ);
  defineOperator(condition, "__eq__", nullptr,
                 [differ](const Condition& a, const Condition& b) { return !differ(a, b); });
  for (const char* name : {"__add__", "__radd__", "__sub__", "__rsub__", "__mul__", "__rmul__", "__truediv__",
                           "__rtruediv__", "__pow__", "__rpow__"}) {
    condition.def(name, [](const Condition&, nb::handle) -> nb::object { raiseArithmetic(); });
  }
  for (const char* name : {"__neg__", "__pos__", "__abs__", "__float__", "__int__"})
    condition.def(name, [](const Condition&) -> nb::object { raiseArithmetic(); });
}

void bindOperators(nb::class_<Number>& number) {
  using N = const Number&;
  defineOperator(number, "__add__", "__radd__", [](N a, N b) { return a + b; });
  defineOperator(number, "__sub__", "__rsub__", [](N a, N b) { return a - b; });
  defineOperator(number, "__mul__", "__rmul__", [](N a, N b) { return a * b; });
  defineOperator(number, "__truediv__", "__rtruediv__", [](N a, N b) { return a / b; });
  defineOperator(number, "__floordiv__", "__rfloordiv__", floorDivide);
  defineOperator(number, "__mod__", "__rmod__", modulo);
  defineOperator(number, "__divmod__", "__rdivmod__",
                 [](N a, N b) { return nb::make_tuple(floorDivide(a, b), modulo(a, b)); });
  defineOperator(number, "__pow__", "__rpow__", power);
  defineOperator(number, "__lt__", nullptr, [](N a, N b) { return a < b; });
  defineOperator(number, "__le__", nullptr, [](N a, N b) { return a <= b; });
  defineOperator(number, "__gt__", nullptr, [](N a, N b) { return a > b; });
  defineOperator(number, "__ge__", nullptr, [](N a, N b) { return a >= b; });
  defineOperator(number, "__eq__", nullptr, [](N a, N b) { return a == b; });
  defineOperator(number, "__ne__", nullptr, [](N a, N b) { return a != b; });
  number.def("__neg__", [](N x) { return -x; })
      .def("__pos__", [](N x) { return x; })
      .def("__abs__", [](N x) { return abs(x); })
      .def("__floor__", [](N x) { return floor(x); })
      .def("__ceil__", [](N x) { return ceil(x); })
      .def("__trunc__", truncate);
}

/// Declares what needs the value of a number: constants have one.
void bindConversions(nb::class_<Number>& number) {
  number
      .def("__float__",
           [](const Number& x) {
             if (!x.isConstant())
               raiseValue("float()",
                          "use np.sin for math.sin, slom.array or np.zeros(n, dtype=object) for an array of "
                          "floats, and drop dtype=float");
             return x.constant();
           })
      .def("__int__",
           [](const Number& x) -> nb::object {
             if (!x.isConstant()) raiseValue("int()", "use np.floor, or np.trunc, which rounds towards 0");
             return nb::steal(PyLong_FromDouble(x.constant()));
           })
      .def("__index__",
           [](const Number&) -> nb::object {
             // NumPy 1.24 tries whether an exponent is an index, and goes on if it is none.
             raiseValue("an index", "look up data before est.measure and pass the result as an argument",
                        false);
           })
      .def(
          "__round__",
          [](const Number&, nb::handle) -> nb::object { raiseValue("round()", "use np.floor(x + 0.5)"); },
          nb::arg("digits") = nb::none())
      .def("__complex__", [](const Number&) -> nb::object { raiseComplex(); })
      .def("__bool__",
           [](const Number& x) -> bool {
             if (!x.isConstant()) raiseValue("bool()", "write slom.where(x != 0, a, b)");
             return x.constant() != 0;
           })
      .def("__repr__",
           [](const Number& x) {
             return x.isConstant() ? nb::cast<std::string>(nb::repr(nb::float_(x.constant())))
                                   : std::string("<recorded number>");
           })
      .def("__format__",
           [](nb::handle x, const std::string& format) -> nb::object {
             const Number& number = nb::cast<const Number&>(x);
             if (!number.isConstant()) return nb::repr(x);
             return nb::float_(number.constant()).attr("__format__")(format);
           })
      .def("__hash__", [](const Number&) -> Py_ssize_t { raiseKey(); })
      .def("__reduce_ex__", [](const Number&, int) -> nb::object { raisePickle(); })
      .def("__copy__", [](const Number& x) { return x; })
      .def("__deepcopy__", [](const Number& x, nb::handle) { return x; });
}

/// Declares the methods that NumPy's functions call for arrays of objects.
void bindFunctions(nb::class_<Number>& number) {
  using N = const Number&;
  static constexpr double degree = 0.017453292519943295769;
  number.def("sqrt", [](N x) { return sqrt(x); })
      .def("cbrt", [](N x) { return cbrt(x); })
      .def("sin", [](N x) { return sin(x); })
      .def("cos", [](N x) { return cos(x); })
      .def("tan", [](N x) { return tan(x); })
      .def("arcsin", [](N x) { return asin(x); })
      .def("arccos", [](N x) { return acos(x); })
      .def("arctan", [](N x) { return atan(x); })
      .def("sinh", [](N x) { return sinh(x); })
      .def("cosh", [](N x) { return cosh(x); })
      .def("tanh", [](N x) { return tanh(x); })
      .def("arcsinh", [](N x) { return asinh(x); })
      .def("arccosh", [](N x) { return acosh(x); })
      .def("arctanh", [](N x) { return atanh(x); })
      .def("exp", [](N x) { return exp(x); })
      .def("exp2", [](N x) { return pow(Number(2), x); })
      .def("expm1", [](N x) { return expm1(x); })
      .def("log", [](N x) { return log(x); })
      .def("log1p", [](N x) { return log1p(x); })
      .def("log10", [](N x) { return log10(x); })
      .def("log2", [](N x) { return log2(x); })
      .def("erf", [](N x) { return erf(x); })
      .def("erfc", [](N x) { return erfc(x); })
      .def("fabs", [](N x) { return abs(x); })
      .def("sign", sign)
      .def("trunc", truncate)
      .def("deg2rad", [](N x) { return x * degree; })
      .def("radians", [](N x) { return x * degree; })
      .def("rad2deg", [](N x) { return x / degree; })
      .def("degrees", [](N x) { return x / degree; })
      .def("conjugate", [](N x) { return x; })
      .def_prop_ro("real", [](N x) { return x; });
  defineFunction(number, "hypot", [](N x, N y) { return hypot(x, y); });
  defineFunction(number, "arctan2", [](N y, N x) { return atan2(y, x); });
  defineFunction(number, "fmod", remainder);
}

}  // namespace

void bindNumbers(nb::module_& module) {
  bindConditions(module);
  nb::class_<Number> number(module, "Number",
                            "A number that records what a measurement function does with it.");
  number.def("__init__", [](Number* self, double value) { new (self) Number(Captures::number(value)); });
  bindOperators(number);
  bindConversions(number);
  bindFunctions(number);
  module.def("_select", [](const Condition& c, const Number& a, const Number& b) { return select(c, a, b); });
}

}  // namespace slom::python
