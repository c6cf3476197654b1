#include "record.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <set>
#include <typeindex>
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

/// Returns a number that differs for different types.
std::uint64_t hashOf(const RuntimeType& type) {
  std::uint64_t h = std::hash<std::string>()(type.name());
  for (const RuntimeType::Field& field : type.fields())
    h = std::rotl(h, 9) ^ (static_cast<std::uint64_t>(field.kind) << 32) ^
        static_cast<std::uint64_t>(field.size);
  return h;
}

Recorded record(const Call& call) {
  tape::Recording recording;
  nb::list proxies;
  std::vector<std::type_index> types;
  std::vector<tape::Layout> layouts;
  std::uint64_t fingerprint = 0;
  std::size_t columns = 0;
  for (const Argument& argument : call.arguments) {
    const RuntimeType& type = *argument.type->runtime();
    if (argument.is_variable) {
      proxies.append(argument.type->recorded(recording.variable(tape::typeOf(type))));
      types.emplace_back(typeid(RuntimeType));
      layouts.push_back(tape::layoutOf(type));
      fingerprint = std::rotl(fingerprint, 7) ^ hashOf(type);
    } else {
      tape::Recording::Input datum;
      for (int i = 0; i < type.coordinates(); ++i)
        datum.coordinates.push_back(recording.data(argument.datum(0)[i]));
      proxies.append(argument.type->recorded(datum));
      columns += static_cast<std::size_t>(type.coordinates());
    }
  }
  std::vector<tape::Number> residual;
  {
    const Captures captures(call.rows == 1);
    appendNumbers(residualOf(call, proxies, true), residual);
  }
  if (residual.empty()) {
    throw mtk::Error("slom.traced-result",
                     "a measurement function returned no numbers; return the residual, a number or an array",
                     "measure");
  }
  Recorded result;
  result.captured.assign(recording.values().begin() + static_cast<std::ptrdiff_t>(columns),
                         recording.values().end());
  fingerprint ^= recording.fingerprint(residual);
  result.kind = TracedKind::remembered(fingerprint);
  if (result.kind == nullptr) {
    result.is_new = true;
    result.kind = TracedKind::shared(recording.finish(residual), std::move(types), std::move(layouts));
    TracedKind::remember(fingerprint, result.kind);
  }
  return result;
}

/// Writes the residual at these values of the variables, and unless J is null the Jacobian, from the tape.
void evaluate(const Recorded& recorded, const std::vector<std::vector<double>>& values,
              const std::vector<double>& data, double* r, double* J) {
  std::vector<const double*> pointers;
  for (const std::vector<double>& value : values) pointers.push_back(value.data());
  recorded.kind->tape.evaluate(1, {pointers.data(), data.data()}, r, J);
}

std::string textOf(double x) { return nb::cast<std::string>(nb::str(nb::float_(x))); }

/// Returns how the recorded formula differs from the function; empty if it does not. Compares some rows, at the present
/// values of the variables and at others.
std::string differenceFrom(const Call& call, const Recorded& recorded) {
  const tape::Tape& tape = recorded.kind->tape;
  std::vector<double> data;
  const QuietNumpy quiet;
  for (const std::size_t row : std::set<std::size_t>{0, call.rows / 2, call.rows - 1}) {
    for (const bool is_moved : {false, true}) {
      const std::vector<std::vector<double>> values = valuesOf(call, row, is_moved);
      std::vector<double> plain;
      try {
        plain = plainResidual(call, row, values);
      } catch (nb::python_error&) {
        continue;  // such as the logarithm of a negative number
      }
      if (plain.size() != static_cast<std::size_t>(tape.rows())) {
        throw mtk::Error(
            "slom.wrong-length",
            "the measurement function returns " + std::to_string(plain.size()) + " numbers for row " +
                std::to_string(row) + " and " + std::to_string(tape.rows()) +
                " for row 0; return the same number for each row, or measure the rows in several calls",
            "measure");
      }
      std::vector<double> r(plain.size());
      setData(call, recorded, row, data);
      evaluate(recorded, values, data, r.data(), nullptr);
      double scale = 1e-3;
      for (const double x : plain) scale = std::max(scale, std::isfinite(x) ? std::abs(x) : 0);
      for (const double x : data) scale = std::max(scale, std::abs(x));
      for (std::size_t i = 0; i < r.size(); ++i) {
        const bool is_equal = std::isfinite(r[i]) && std::isfinite(plain[i])
                                  ? std::abs(r[i] - plain[i]) <= 1e-8 * scale
                                  : !std::isfinite(r[i]) && !std::isfinite(plain[i]);
        if (!is_equal)
          return "gives " + textOf(plain[i]) + " where its recorded formula gives " + textOf(r[i]) +
                 ", so it depends on more than its arguments, or branches";
      }
    }
  }
  return "";
}

void warn(const std::string& text) {
  const nb::object package = nb::module_::import_("slom");
  nb::module_::import_("warnings")
      .attr("warn")(text, package.attr("SlowFunctionWarning"), "stacklevel"_a = 1);
}

}  // namespace

void setData(const Call& call, const Recorded& recorded, std::size_t row, std::vector<double>& data) {
  data.clear();
  for (const Argument& argument : call.arguments) {
    if (argument.is_variable) continue;
    const double* const datum = argument.datum(row);
    data.insert(data.end(), datum, datum + argument.type->coordinates());
  }
  data.insert(data.end(), recorded.captured.begin(), recorded.captured.end());
}

std::optional<Recorded> recordedOrNot(const Call& call, const std::string& label, std::optional<bool> trace) {
  if (trace == false) return std::nullopt;
  std::string refusal;
  try {
    Recorded recorded = record(call);
    if (recorded.is_new) refusal = differenceFrom(call, recorded);
    if (refusal.empty()) return recorded;
    if (trace == true)
      throw mtk::Error("slom.traced-differs",
                       "the measurement function " + label + " " + refusal +
                           "; pass all it depends on as arguments, and write slom.where in place of `if`",
                       label);
  } catch (const mtk::Error& error) {
    if (trace == true || error.id().rfind("slom.traced", 0) != 0) throw;
    plainResidual(call, 0, valuesOf(call, 0, false));  // raises the user's own mistakes
    refusal = "cannot be recorded: " + std::string(error.sentence());
  } catch (nb::python_error& error) {
    if (trace == true || !error.matches(PyExc_Exception)) throw;  // such as KeyboardInterrupt
    plainResidual(call, 0, valuesOf(call, 0, false));             // raises the user's own mistakes
    const nb::object sentence = nb::getattr(error.value(), "sentence", nb::str(error.value()));
    refusal = "cannot be recorded: " + nb::cast<std::string>(sentence);
  }
  const std::string name = label == "function" ? "" : " " + label;
  warn("the measurement function" + name + " " + refusal +
       ". It is called for each measurement, with numeric derivatives, which is slow");
  return std::nullopt;
}

namespace {
/// Returns the derivatives of f(...) [-] its value, by central differences in the tangent spaces.
Eigen::MatrixXd differencesOf(const Call& call, const std::vector<std::vector<double>>& values,
                              const std::vector<AnyVarID>& variables) {
  std::vector<Eigen::VectorXd> columns;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const VariableStoreBase& store = *variables[k].store();
    const auto dof = static_cast<std::size_t>(store.dofOf(values[k].data()));
    std::vector<double> sizes(dof);
    store.typicalSizesOf(values[k].data(), sizes.data());
    for (std::size_t c = 0; c < dof; ++c) {
      const double h = 6e-6 * std::max(sizes[c], 1e-3);  // cubic root of the rounding error
      const auto residualAt = [&](double step) {
        std::vector<std::vector<double>> moved = values;
        std::vector<double> d(dof, 0.0);
        d[c] = step;
        store.boxplus(moved[k].data(), d.data());
        const std::vector<double> r = plainResidual(call, 0, moved);
        return Eigen::VectorXd(
            Eigen::Map<const Eigen::VectorXd>(r.data(), static_cast<Eigen::Index>(r.size())));
      };
      columns.emplace_back((residualAt(h) - residualAt(-h)) / (2 * h));
    }
  }
  Eigen::MatrixXd J(columns.front().size(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c) J.col(static_cast<Eigen::Index>(c)) = columns[c];
  return J;
}
}  // namespace

Derived derivedFrom(nb::handle f, const nb::args& arguments) {
  Call call;
  call.function = nb::borrow(f);
  Derived result;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    call.arguments.push_back(
        singleArgument(arguments[i], "argument " + std::to_string(i + 1) + " of the function"));
    if (call.arguments.back().is_variable) result.variables.push_back(call.arguments.back().variable(0));
  }
  if (result.variables.empty()) {
    throw mtk::Error("slom.bad-argument",
                     "propagate was given no variable; pass what est.variable returned, after the function",
                     "propagate");
  }
  const std::vector<std::vector<double>> values = valuesOf(call, 0, false);
  const std::string subject = "the value of the function";
  const nb::object value = plainResult(call, 0, values);
  result.type = ValueType::of(value, subject);
  result.type->append(value, result.numbers, subject);
  Argument datum;
  datum.type = result.type;
  datum.data = result.numbers;
  datum.is_for_all = true;
  call.arguments.push_back(std::move(datum));
  call.predicts = true;

  const std::optional<Recorded> recorded = recordedOrNot(call, "passed to propagate", std::nullopt);
  if (!recorded) {
    result.jacobian = differencesOf(call, values, result.variables);
    return result;
  }
  std::vector<double> data;
  setData(call, *recorded, 0, data);
  Eigen::VectorXd r(recorded->kind->tape.rows());
  int columns = 0;
  for (const Argument& argument : call.arguments)
    columns += argument.is_variable ? argument.type->runtime()->dof() : 0;
  result.jacobian.resize(r.size(), columns);
  evaluate(*recorded, values, data, r.data(), result.jacobian.data());
  return result;
}

}  // namespace slom::python
