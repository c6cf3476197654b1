#include "call.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "manifolds.hpp"
#include "recorded.hpp"

namespace slom::python {

using namespace nb::literals;

namespace {

std::string nameOfArgument(std::size_t i) {
  return "argument " + std::to_string(i + 1) + " of the measurement function";
}

[[noreturn]] void raiseArgument(const std::string& subject, const std::string& fault) {
  throw mtk::Error("slom.bad-argument", subject + " " + fault, "measure");
}

void appendVariable(Argument& argument, const Variable& x, const std::string& subject) {
  if (argument.type != nullptr && !(*argument.type == *x.type)) {
    raiseArgument(subject, "has variables of types " + argument.type->runtime()->name() + " and " +
                               x.type->runtime()->name() + "; pass variables of one type");
  }
  argument.type = x.type;
  argument.variables.push_back(x.id);
}

Argument datumForAll(nb::handle value, const std::string& subject) {
  Argument argument;
  argument.type = ValueType::of(value, subject);
  argument.type->append(value, argument.data, subject);
  argument.is_for_all = true;
  return argument;
}

Argument argumentOf(nb::handle value, const std::string& subject) {
  Argument argument;
  argument.is_variable = true;
  if (nb::isinstance<Variable>(value)) {
    appendVariable(argument, nb::cast<Variable>(value), subject);
    argument.is_for_all = true;
    return argument;
  }
  if (nb::isinstance<VariableArray>(value)) {
    auto all = nb::cast<VariableArray>(value);
    argument.type = all.type;
    argument.variables = std::move(all.ids);
    return argument;
  }
  if ((nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) && nb::len(value) > 0 &&
      nb::isinstance<Variable>(value[0])) {
    for (const nb::handle one : value) {
      if (!nb::isinstance<Variable>(one))
        raiseArgument(subject, "is a list in which not all entries are variables; pass variables alone");
      appendVariable(argument, nb::cast<Variable>(one), subject);
    }
    return argument;
  }
  argument.is_variable = false;
  const bool is_rows = nb::isinstance<Rows>(value) || nb::isinstance<nb::list>(value) ||
                       nb::isinstance<nb::tuple>(value) ||
                       (!nb::hasattr(value.type(), "__slom_fields__") && nb::hasattr(value, "__len__") &&
                        nb::cast<int>(numpy().attr("ndim")(value)) > 0);
  if (is_rows) {
    Rows rows = rowsOf(value, subject);
    argument.type = rows.type;
    argument.data = std::move(rows.numbers);
  } else {
    argument = datumForAll(value, subject);
  }
  return argument;
}

nb::object minus(nb::handle prediction, nb::handle datum) {
  return nb::module_::import_("slom._measured").attr("minus")(prediction, datum);
}

/// Pseudo-random numbers in [-1, 1], always the same ones.
struct Moves {
  std::uint32_t state = 12345;
  double next() {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state) / 2147483648.0 - 1;
  }
};

nb::list argumentsOf(const Call& call, std::size_t row, const std::vector<std::vector<double>>& values) {
  nb::list arguments;
  std::size_t next = 0;
  for (const Argument& argument : call.arguments)
    arguments.append(
        argument.type->value(argument.is_variable ? values[next++].data() : argument.datum(row)));
  return arguments;
}

}  // namespace

Call callOf(nb::handle f, const nb::args& passed, nb::handle measured) {
  Call call;
  call.function = nb::borrow(f);
  bool has_rows = false, has_variable = false;
  const auto add = [&](nb::handle value, const std::string& subject) {
    call.arguments.push_back(argumentOf(value, subject));
    const Argument& argument = call.arguments.back();
    has_variable = has_variable || argument.is_variable;
    if (argument.is_for_all) return;
    const std::size_t own = argument.rows();
    if (has_rows && own != call.rows) {
      raiseArgument(subject, "has " + std::to_string(own) + " rows where earlier ones have " +
                                 std::to_string(call.rows) + "; pass the same number of rows");
    }
    call.rows = own;
    has_rows = true;
  };
  for (std::size_t i = 0; i < passed.size(); ++i) add(passed[i], nameOfArgument(i));
  if (!measured.is_none()) {
    add(measured, "measured");
    call.predicts = true;
  }
  if (!has_variable)
    raiseArgument("measure", "was given no variable; pass what est.variable returned, after the function");
  return call;
}

Argument singleArgument(nb::handle value, const std::string& subject) {
  if (nb::isinstance<Variable>(value)) return argumentOf(value, subject);
  if (nb::isinstance<VariableArray>(value))
    raiseArgument(subject,
                  "is an array of variables; pass its variables one by one, *x for all of an array x");
  return datumForAll(value, subject);
}

nb::object residualOf(const Call& call, const nb::list& arguments, bool is_recorded) {
  const auto apply = [&](const nb::list& passed) {
    if (is_recorded) return callRecorded(call.function, nb::tuple(passed));
    return nb::object(
        nb::module_::import_("slom._call").attr("call_plain")(call.function, nb::tuple(passed)));
  };
  if (!call.predicts) return apply(arguments);
  const std::size_t count = nb::len(arguments) - 1;
  nb::list passed;
  for (std::size_t i = 0; i < count; ++i) passed.append(arguments[i]);
  return minus(apply(passed), arguments[count]);
}

void appendDoubles(nb::handle result, std::vector<double>& numbers) {
  if (nb::isinstance<nb::list>(result) || nb::isinstance<nb::tuple>(result)) {
    for (const nb::handle entry : result) appendDoubles(entry, numbers);
  } else if (result.is_none()) {
    throw mtk::Error("slom.bad-residual",
                     "the measurement function returned None; end it with `return` and the residual",
                     "measure");
  } else {
    const std::vector<double> own = entriesOf<double>(result, -1, "the residual");
    numbers.insert(numbers.end(), own.begin(), own.end());
  }
}

std::vector<std::vector<double>> valuesOf(const Call& call, std::size_t row, bool is_moved) {
  std::vector<std::vector<double>> values;
  Moves moves;
  for (const Argument& argument : call.arguments) {
    if (!argument.is_variable) continue;
    const AnyVarID& id = argument.variable(row);
    const auto* const numbers = static_cast<const double*>(id.current());
    values.emplace_back(numbers, numbers + argument.type->coordinates());
    if (!is_moved) continue;
    std::vector<double> d(static_cast<std::size_t>(argument.type->runtime()->dof()));
    id.store()->typicalSizesOf(numbers, d.data());
    for (double& size : d) size = moves.next() * (0.05 * size + 1e-3);
    id.store()->boxplus(values.back().data(), d.data());
  }
  return values;
}

QuietNumpy::QuietNumpy() : before_(numpy().attr("seterr")("all"_a = "ignore")) {}
QuietNumpy::~QuietNumpy() { numpy().attr("seterr")(**nb::cast<nb::dict>(before_)); }

nb::object plainResult(const Call& call, std::size_t row, const std::vector<std::vector<double>>& values) {
  return residualOf(call, argumentsOf(call, row, values));
}

std::vector<double> plainResidual(const Call& call, std::size_t row,
                                  const std::vector<std::vector<double>>& values) {
  std::vector<double> residual;
  appendDoubles(plainResult(call, row, values), residual);
  return residual;
}

namespace {
/// Returns whether a value of this type has a vector of so many components.
bool hasVectorOf(const RuntimeType& type, std::size_t size) {
  const auto width = [](const RuntimeType::Field& field) -> std::size_t {
    switch (field.kind) {
      case RuntimeType::Kind::vector:
        return static_cast<std::size_t>(field.size);
      case RuntimeType::Kind::so2:
      case RuntimeType::Kind::se2:
        return 2;
      case RuntimeType::Kind::so3:
      case RuntimeType::Kind::s2:
      case RuntimeType::Kind::se3:
        return 3;
      default:
        return 1;
    }
  };
  return std::any_of(type.fields().begin(), type.fields().end(),
                     [&](const RuntimeType::Field& field) { return width(field) == size; });
}
}  // namespace

void checkRows(const Call& call) {
  if (call.rows < 2) return;
  bool meets_vector = false;
  std::string numbers;
  for (std::size_t i = 0; i < call.arguments.size(); ++i) {
    const Argument& argument = call.arguments[i];
    if (argument.is_for_all) {
      meets_vector = meets_vector || hasVectorOf(*argument.type->runtime(), call.rows);
      continue;
    }
    if (argument.is_variable || !argument.type->isArray() || !argument.type->shape().empty()) return;
    const bool is_measured = call.predicts && i + 1 == call.arguments.size();
    if (numbers.empty() && !is_measured) numbers = nameOfArgument(i);
  }
  if (!meets_vector || numbers.empty()) return;

  const std::vector<std::vector<double>> values = valuesOf(call, 0, false);
  std::vector<double> by_row, at_once;
  const QuietNumpy quiet;
  try {
    for (std::size_t row = 0; row < call.rows; ++row) {
      const std::vector<double> own = plainResidual(call, row, values);
      by_row.insert(by_row.end(), own.begin(), own.end());
    }
    nb::list arguments = argumentsOf(call, 0, values);
    for (std::size_t i = 0; i < call.arguments.size(); ++i) {
      if (!call.arguments[i].is_for_all) arguments[i] = toPython(call.arguments[i].data.data(), {call.rows});
    }
    appendDoubles(residualOf(call, arguments), at_once);
  } catch (nb::python_error&) {  // it takes either rows or all at once, and the recording says what is wrong
    return;
  } catch (const mtk::Error&) {
    return;
  }
  const bool is_same = by_row.size() == at_once.size() &&
                       std::equal(by_row.begin(), by_row.end(), at_once.begin(), [](double a, double b) {
                         return !(std::abs(a - b) > 1e-9 * (std::abs(a) + std::abs(b)));
                       });
  if (is_same) return;
  const std::string n = std::to_string(call.rows);
  throw mtk::Error(
      "slom.ambiguous-rows",
      numbers + " has one dimension, so it is " + n + " rows of one number each, but a vector of " + n +
          " numbers meets it there; pass x[None] for one row with the vector x, or x[:, None] for " + n +
          " rows",
      "measure");
}

}  // namespace slom::python
