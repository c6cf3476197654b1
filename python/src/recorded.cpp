#include "recorded.hpp"

#include <string>

#include <nanobind/operators.h>
#include <nanobind/stl/string.h>

#include "mtk/error.hpp"
#include "mtk/scalar.hpp"

namespace slom::python {

using tape::Condition;
using tape::Number;

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

void appendNumbers(nb::handle result, std::vector<Number>& numbers) {
  Number x;
  if (nb::try_cast<Number>(result, x)) {
    numbers.push_back(x);
  } else if (double constant = 0; nb::try_cast<double>(result, constant)) {
    numbers.push_back(Number(constant));
  } else if (nb::hasattr(result, "flatten") && nb::hasattr(result, "tolist")) {
    for (const nb::handle entry : nb::object(result.attr("flatten")().attr("tolist")()))
      appendNumbers(entry, numbers);
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

[[noreturn]] void raiseValue(const char* what) {
  throw mtk::Error(
      "slom.traced-value",
      std::string("a measurement function asks for the value of a computed number (") + what +
          "), which is not known while the function is recorded; use operators, NumPy's functions and "
          "slom.where",
      "measure");
}

}  // namespace

void bindNumbers(nb::module_& module) {
  nb::class_<Condition>(module, "Condition", "The result of a comparison of recorded numbers.")
      .def("__bool__",
           [](const Condition& c) {
             if (!c.isConstant()) tape::raiseBranch(c);
             return c.constant();
           })
      .def("__and__", [](const Condition& a, const Condition& b) { return a && b; })
      .def("__or__", [](const Condition& a, const Condition& b) { return a || b; })
      .def("__invert__", [](const Condition& a) { return !a; });

  nb::class_<Number> number(module, "Number",
                            "A number that records what a measurement function does with it.");
  number.def(nb::init<double>())
      .def(nb::self + nb::self)
      .def(nb::self + double())
      .def(double() + nb::self)
      .def(nb::self - nb::self)
      .def(nb::self - double())
      .def(double() - nb::self)
      .def(nb::self * nb::self)
      .def(nb::self * double())
      .def(double() * nb::self)
      .def(nb::self / nb::self)
      .def(nb::self / double())
      .def(double() / nb::self)
      .def(-nb::self)
      .def("__pos__", [](const Number& x) { return x; })
      .def("__abs__", [](const Number& x) { return abs(x); })
      .def("__pow__",
           [](const Number& x, double p) {
             if (p == 2) return x * x;
             if (p == 1) return x;
             if (p == 0.5) return sqrt(x);
             if (p == -1) return Number(1.0) / x;
             if (p == 3) return x * x * x;
             return pow(x, Number(p));
           })
      .def("__pow__", [](const Number& x, const Number& p) { return pow(x, p); })
      .def("__rpow__", [](const Number& x, double base) { return exp(x * std::log(base)); })
      .def("__lt__", [](const Number& a, const Number& b) { return a < b; })
      .def("__lt__", [](const Number& a, double b) { return a < Number(b); })
      .def("__le__", [](const Number& a, const Number& b) { return a <= b; })
      .def("__le__", [](const Number& a, double b) { return a <= Number(b); })
      .def("__gt__", [](const Number& a, const Number& b) { return a > b; })
      .def("__gt__", [](const Number& a, double b) { return a > Number(b); })
      .def("__ge__", [](const Number& a, const Number& b) { return a >= b; })
      .def("__ge__", [](const Number& a, double b) { return a >= Number(b); })
      .def("__eq__", [](const Number& a, const Number& b) { return a == b; })
      .def("__eq__", [](const Number& a, double b) { return a == Number(b); })
      .def("__ne__", [](const Number& a, const Number& b) { return a != b; })
      .def("__ne__", [](const Number& a, double b) { return a != Number(b); })
      .def("__float__",
           [](const Number& x) { return x.isConstant() ? x.constant() : (raiseValue("float"), 0.0); })
      .def("__int__", [](const Number&) -> int { raiseValue("int"); })
      .def("__bool__",
           [](const Number& x) -> bool {
             if (!x.isConstant()) raiseValue("bool");
             return x.constant() != 0;
           })
      .def("__repr__",
           [](const Number& x) {
             return x.isConstant() ? std::to_string(x.constant()) : std::string("<recorded number>");
           })
      .def("conjugate", [](const Number& x) { return x; })
      .def("square", [](const Number& x) { return x * x; })
      .def("hypot", [](const Number& x, const Number& y) { return hypot(x, y); })
      .def("hypot", [](const Number& x, double y) { return hypot(x, Number(y)); })
      .def("arctan2", [](const Number& y, const Number& x) { return atan2(y, x); })
      .def("arctan2", [](const Number& y, double x) { return atan2(y, Number(x)); });
  // NumPy calls these methods for arrays of objects.
  number.def("sqrt", [](const Number& x) { return sqrt(x); })
      .def("sin", [](const Number& x) { return sin(x); })
      .def("cos", [](const Number& x) { return cos(x); })
      .def("tan", [](const Number& x) { return tan(x); })
      .def("arcsin", [](const Number& x) { return asin(x); })
      .def("arccos", [](const Number& x) { return acos(x); })
      .def("arctan", [](const Number& x) { return atan(x); })
      .def("sinh", [](const Number& x) { return sinh(x); })
      .def("cosh", [](const Number& x) { return cosh(x); })
      .def("tanh", [](const Number& x) { return tanh(x); })
      .def("exp", [](const Number& x) { return exp(x); })
      .def("expm1", [](const Number& x) { return expm1(x); })
      .def("log", [](const Number& x) { return log(x); })
      .def("log1p", [](const Number& x) { return log1p(x); })
      .def("log10", [](const Number& x) { return log10(x); })
      .def("log2", [](const Number& x) { return log2(x); })
      .def("fabs", [](const Number& x) { return abs(x); });
  number.attr("__hash__") = nb::none();

  module.def("_select", [](const Condition& c, const Number& a, const Number& b) { return select(c, a, b); });
}

}  // namespace slom::python
