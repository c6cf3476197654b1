// slom._slom: the library as Python sees it. Names, shapes and errors are translated; nothing is computed here.
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/slom.hpp>
#include <slom/tape.hpp>

#include "recorded.hpp"
#include "variables.hpp"

namespace slom::python {
namespace {

/// A variable of an estimator.
struct Variable {
  std::shared_ptr<Estimator> est;
  AnyVarID id;
  const VariableKind* kind;
};

/// An argument of a measurement function: a variable, one for each row, or columns of data.
struct Argument {
  std::vector<Variable> variables;  ///< one, or one for each row
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> data;
  std::vector<std::size_t> shape;  ///< of a row of the data

  bool isData() const { return variables.empty(); }
};

[[noreturn]] void raiseArgument(std::size_t i, const std::string& what) {
  throw mtk::Error("slom.bad-argument",
                   "argument " + std::to_string(i + 1) + " of the measurement function " + what, "measure");
}

Argument argumentOf(nb::handle value, std::size_t i) {
  Argument argument;
  if (nb::isinstance<Variable>(value)) {
    argument.variables.push_back(nb::cast<Variable>(value));
    return argument;
  }
  if ((nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) && nb::len(value) > 0 &&
      nb::isinstance<Variable>(value[0])) {
    for (const nb::handle one : value) {
      if (!nb::isinstance<Variable>(one))
        raiseArgument(i, "is a list in which not all entries are variables; pass variables alone");
      argument.variables.push_back(nb::cast<Variable>(one));
    }
    return argument;
  }
  const nb::object numpy = nb::module_::import_("numpy");
  nb::object array = numpy.attr("asarray")(value);
  if (nb::cast<std::string>(array.attr("dtype").attr("kind")) == "O")
    raiseArgument(i, "is an array of objects; pass numbers, all rows of one length");
  array = numpy.attr("asarray")(array, "float64", "C");
  const auto shape = nb::cast<std::vector<std::size_t>>(array.attr("shape"));
  if (shape.empty())
    raiseArgument(i, "is a single number; pass one value for each row, or make it part of the function");
  if (PyObject_IsTrue(nb::object(numpy.attr("isfinite")(array).attr("all")()).ptr()) != 1)
    raiseArgument(i, "has a number that is not finite; remove such rows");
  argument.shape.assign(shape.begin() + 1, shape.end());
  argument.data = nb::cast<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      array.attr("reshape")(shape[0], -1));
  return argument;
}

/// Inserts a measurement that is recorded already, as slom::traced does.
struct Recorded {
  using Traced = TracedMeasurement;
  TracedMeasurement* measurement;

  static MeasID<TracedMeasurement> insert(Problem& problem, const Recorded& recorded, const NoiseView& noise,
                                          std::string_view label, const Loss& loss) {
    return insertTraced(problem, *recorded.measurement, noise, label, loss);
  }
};

/// Records the function and inserts a measurement for each row. Returns their number.
std::size_t measure(const std::shared_ptr<Estimator>& est, const nb::callable& f, const nb::args& passed,
                    std::optional<double> sigma, const std::string& name) {
  std::vector<Argument> arguments;
  std::size_t rows = 1;
  bool has_rows = false;
  for (std::size_t i = 0; i < passed.size(); ++i) {
    arguments.push_back(argumentOf(passed[i], i));
    const Argument& argument = arguments.back();
    const std::size_t own = argument.isData() ? std::size_t(argument.data.rows()) : argument.variables.size();
    if (!argument.isData() && own == 1) continue;
    if (has_rows && own != rows)
      raiseArgument(i, "has " + std::to_string(own) + " rows where earlier ones have " +
                           std::to_string(rows) + "; pass the same number of rows");
    rows = own;
    has_rows = true;
  }
  if (rows == 0) return 0;

  std::shared_ptr<const TracedKind> kind;
  {
    tape::Recording recording;
    nb::list proxies;
    std::vector<std::type_index> types;
    std::vector<tape::Layout> layouts;
    for (const Argument& argument : arguments) {
      if (argument.isData()) {
        std::vector<tape::Number> numbers;
        for (Eigen::Index k = 0; k < argument.data.cols(); ++k)
          numbers.push_back(recording.data(argument.data(0, k)));
        proxies.append(arrayOf(numbers, argument.shape));
      } else {
        const Variable& x = argument.variables.front();
        proxies.append(x.kind->recorded(recording, x.id));
        types.push_back(x.kind->type());
        layouts.push_back(x.kind->layout(x.id));
      }
    }
    const nb::object result = callRecorded(f, nb::tuple(proxies));
    std::vector<tape::Number> residual;
    appendNumbers(result, residual);
    kind = TracedKind::shared(recording.finish(residual), std::move(types), std::move(layouts));
  }

  const StandardDeviation<double> noise(sigma.value_or(1.0));
  const std::string label =
      name.empty() ? nb::cast<std::string>(nb::str(nb::getattr(f, "__name__", nb::str("function")))) : name;
  for (std::size_t row = 0; row < rows; ++row) {
    TracedMeasurement measurement;
    measurement.kind = kind;
    for (const Argument& argument : arguments) {
      if (argument.isData()) {
        const double* const numbers = argument.data.data() + std::ptrdiff_t(row) * argument.data.cols();
        measurement.data.insert(measurement.data.end(), numbers, numbers + argument.data.cols());
      } else {
        const Variable& x = argument.variables[argument.variables.size() == 1 ? 0 : row];
        measurement.variables.emplace_back(x.id);
      }
    }
    est->insertMeasurement(Recorded{&measurement}, noise, named(label));
  }
  return rows;
}

template <class T>
std::string textOf(const T& x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

}  // namespace
}  // namespace slom::python

NB_MODULE(_slom, module) {
  namespace nb = nanobind;
  using namespace nb::literals;
  using namespace slom::python;
  using slom::Estimator;
  using slom::Summary;
  module.doc() = "Sparse least squares on manifolds.";
  nb::exception<mtk::Error>(module, "Error");
  bindNumbers(module);

  nb::class_<Summary>(module, "Summary", "What a fit did, and why it stopped.")
      .def_ro("converged", &Summary::converged)
      .def_ro("iterations", &Summary::iterations)
      .def_ro("initial_rss", &Summary::initial_rss)
      .def_ro("final_rss", &Summary::final_rss)
      .def_ro("redundancy", &Summary::redundancy)
      .def_ro("message", &Summary::message)
      .def("__str__", &textOf<Summary>)
      .def("__repr__", &textOf<Summary>);

  nb::class_<Variable>(module, "Variable", "A variable of an estimator.")
      .def_prop_rw(
          "value", [](const Variable& x) { return x.kind->value(x.id); },
          [](const Variable& x, nb::handle value) { x.kind->set(*x.est, x.id, value); }, "The current value.")
      .def_prop_ro("name", [](const Variable& x) { return x.kind->name(*x.est, x.id); })
      .def_prop_ro(
          "std",
          [](const Variable& x) -> nb::object {
            const Eigen::VectorXd std = x.kind->deviation(*x.est, x.id);
            const bool is_number = nb::isinstance<nb::float_>(x.kind->value(x.id));
            return is_number ? nb::object(nb::float_(std[0])) : nb::cast(std);
          },
          "Standard deviations of the components.")
      .def_prop_ro("covariance", [](const Variable& x) { return x.kind->covariance(*x.est, x.id); })
      .def(
          "fix", [](const Variable& x) { x.kind->fix(*x.est, x.id, true); },
          "Keeps the variable at its value.")
      .def(
          "free", [](const Variable& x) { x.kind->fix(*x.est, x.id, false); }, "Releases the variable.")
      .def("__repr__", [](const Variable& x) {
        return x.kind->name(*x.est, x.id) + " = " + nb::cast<std::string>(nb::str(x.kind->value(x.id)));
      });

  nb::class_<Estimator>(module, "Estimator",
                        "Variables, measurements, and the fit of the variables to the measurements.")
      .def(nb::init<>())
      .def(
          "variable",
          [](const std::shared_ptr<Estimator>& est, nb::handle value, const std::string& name,
             bool optimize) {
            const VariableKind& kind = kindOf(value);
            return Variable{est, kind.insert(*est, value, name, optimize), &kind};
          },
          "value"_a, "name"_a = "", "optimize"_a = true,
          "Adds a variable with its start value: a number, or an array of one dimension.")
      .def("measure", &measure, "function"_a, "arguments"_a, nb::kw_only(), "sigma"_a = nb::none(),
           "name"_a = "", "Adds a measurement for each row of the data. Returns their number.")
      .def(
          "optimize", [](Estimator& est) { return est.optimize(); }, nb::call_guard<nb::gil_scoped_release>(),
          "Fits the variables. Returns what the fit did, and why it stopped.")
      .def("residuals", &Estimator::residuals,
           "Returns all residuals in units of their standard deviations.");
}
