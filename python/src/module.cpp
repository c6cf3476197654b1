// slom._slom: the library as Python sees it. Names, shapes and errors are translated; nothing is computed here.
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/archive.hpp>
#include <slom/fixed_lag.hpp>
#include <slom/optimize/named.hpp>
#include <slom/slom.hpp>
#include <slom/version.hpp>

#include "alone.hpp"
#include "documentation.hpp"
#include "files.hpp"
#include "manifolds.hpp"
#include "measure.hpp"
#include "plain_function.hpp"
#include "record.hpp"
#include "recorded.hpp"
#include "reports.hpp"
#include "words.hpp"

namespace slom::python {

using namespace nb::literals;

namespace {

[[noreturn]] void raiseOption(const std::string& name, const std::string& value,
                              const std::string& accepted) {
  throw mtk::Error("slom.bad-option", name + " is \"" + value + "\"; pass " + accepted, name);
}

Fit optimize(const Shared& est, std::optional<int> max_iterations, std::optional<double> max_seconds,
             std::optional<double> gradient_tolerance, std::optional<double> decrease_tolerance,
             std::optional<double> step_tolerance, std::optional<double> deviation_tolerance,
             bool graduated_non_convexity, std::optional<int> most_parameters,
             const std::optional<nb::callable>& observer) {
  Options options;
  if (max_iterations && *max_iterations < 0)
    raiseOption("max_iterations", std::to_string(*max_iterations), "a number of iterations, 0 or more");
  if (max_iterations) options.max_iterations = *max_iterations;
  if (max_seconds) options.max_seconds = *max_seconds;
  if (gradient_tolerance) options.gradient_tolerance = *gradient_tolerance;
  if (decrease_tolerance) options.decrease_tolerance = *decrease_tolerance;
  if (step_tolerance) options.step_tolerance = *step_tolerance;
  if (deviation_tolerance) options.deviation_tolerance = *deviation_tolerance;
  if (most_parameters) options.most_parameters = *most_parameters;
  options.graduated_non_convexity = graduated_non_convexity;
  Interrupt interrupt;
  options.should_stop = [&] { return interrupt(); };
  if (observer) {
    options.observer = [f = observer->ptr()](const IterationRecord& record) {
      const nb::gil_scoped_acquire gil;
      const nb::object answer = nb::handle(f)(record);
      return answer.is(nb::handle(Py_False)) ? FitControl::stop : FitControl::go_on;
    };
  }
  Fit fit{est, {}};
  {
    const nb::gil_scoped_release unlocked;
    fit.summary = est->optimize(options);
  }
  interrupt.raise();
  return fit;
}

Variable variable(const Shared& est, nb::handle value, const std::string& name, bool optimize) {
  const std::string subject = name.empty() ? "the start value of a variable" : "the start value of " + name;
  const auto type = ValueType::of(value, subject);
  std::vector<double> numbers;
  type->append(value, numbers, subject);
  return {est, est->insertRV(RuntimeValue{type->runtime(), std::move(numbers)}, optimize, name), type};
}

VariableArray variables(const Shared& est, nb::handle values, const std::string& name, bool optimize) {
  const Rows rows = rowsOf(values, "the start values" + (name.empty() ? "" : " of " + name));
  VariableArray all{est, {}, rows.type};
  all.ids.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RuntimeValue value{rows.type->runtime(), {rows.row(i), rows.row(i) + rows.type->coordinates()}};
    all.ids.push_back(
        est->insertRV(value, optimize, name.empty() ? "" : name + "[" + std::to_string(i) + "]"));
  }
  return all;
}

/// Returns the whitened residuals of all measurements, or of those with this label.
Eigen::VectorXd residuals(const Estimator& est, const std::optional<std::string>& label) {
  const Eigen::VectorXd all = est.residuals();
  if (!label) return all;
  std::set<std::string> names;
  for (const auto& pool : est.table().pools()) names.insert(pool->label());
  if (!names.count(*label)) {
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw mtk::Error("slom.bad-option",
                     "there are no measurements called \"" + *label + "\"; pass one of " + known, "name");
  }
  std::vector<Eigen::Index> chosen;
  Eigen::Index next = 0;
  for (const auto& pool : est.table().pools()) {
    for (int i = 0; i < pool->size(); ++i) {
      for (int k = 0; k < pool->rows(i); ++k, ++next) {
        if (pool->label() == *label) chosen.push_back(next);
      }
    }
  }
  return all(chosen);
}

/// Returns the joint covariance of all variables in `a`, or with `b` the cross-covariance of both.
Eigen::MatrixXd covariance(const Estimator& est, nb::handle a, nb::handle b) {
  std::vector<AnyVarID> ids = handlesOf(a);
  if (b.is_none()) return est.jointCovariance(ids);
  const std::vector<AnyVarID> others = handlesOf(b);
  if (ids.size() == 1 && others.size() == 1) return est.covariance(ids[0], others[0]);
  ids.insert(ids.end(), others.begin(), others.end());
  const Eigen::MatrixXd joint = est.jointCovariance(ids);
  Eigen::Index columns = 0;
  for (const AnyVarID& id : others) columns += static_cast<Eigen::Index>(est.componentNames(id).size());
  return joint.topRightCorner(joint.rows() - columns, columns);
}

/// Returns f(values) and its covariance.
nb::object propagate(const Estimator& est, nb::handle f, const nb::args& arguments, nb::handle covariance) {
  const Derived derived = derivedFrom(f, arguments);
  const Eigen::MatrixXd C =
      covariance.is_none() ? est.jointCovariance(derived.variables) : nb::cast<Eigen::MatrixXd>(covariance);
  detail::requireCovarianceSize(C.rows(), C.cols(), static_cast<int>(derived.jacobian.cols()));
  const Eigen::MatrixXd result = derived.jacobian * C * derived.jacobian.transpose();
  return nb::module_::import_("slom._propagated")
      .attr("Propagated")(derived.type->value(derived.numbers.data()), result);
}

Archive archive() {
  Archive archive;
  archive.measurement<GaussianPrior>();
  return archive;
}

void save(const Estimator& est, const std::filesystem::path& file) {
  std::ostringstream text;
  archive().save(est, text);  // before the file is opened, so that a failure leaves it as it is
  std::ofstream stream(file, std::ios::binary);
  if (!(stream << text.str() << std::flush)) {
    throw mtk::Error("slom.cannot-write",
                     "the file " + file.string() + " cannot be written; check its folder and permissions",
                     file.string());
  }
}

/// Returns the name of the array that a name such as "point[3]" belongs to, and the index; none for other names.
std::optional<std::pair<std::string, std::size_t>> entryOf(const std::string& name) {
  const std::size_t open = name.rfind('[');
  if (open == std::string::npos || open == 0 || name.back() != ']') return std::nullopt;
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(&name[open] + 1, &name.back(), index);
  if (error != std::errc() || end != &name.back()) return std::nullopt;
  return std::pair(name.substr(0, open), index);
}

/// Returns the variables by name. Those called x[0], x[1], ..., of one type, are the array x.
nb::dict byName(const Shared& est, const std::vector<AnyVarID>& ids) {
  std::map<std::string, VariableArray> arrays;
  std::set<std::string> not_arrays;
  for (const AnyVarID& id : ids) {
    const auto entry = entryOf(est->nameOf(id));
    if (!entry) continue;
    const auto type = RuntimeType::of(id);
    VariableArray& all = arrays[entry->first];
    if (all.est == nullptr) all = {est, {}, ValueType::of(type)};
    if (all.ids.size() != entry->second || all.type->runtime() != type) not_arrays.insert(entry->first);
    all.ids.push_back(id);
  }
  nb::dict variables;
  const auto add = [&](const std::string& own, const nb::object& x) {
    std::string name = own;
    for (int k = 2; variables.contains(name.c_str()); ++k) name = own + " (" + std::to_string(k) + ")";
    variables[nb::str(name.c_str())] = x;
  };
  for (const AnyVarID& id : ids) {
    const std::string name = est->nameOf(id);
    const auto entry = entryOf(name);
    if (!entry || not_arrays.count(entry->first)) {
      add(name, nb::cast(Variable{est, id, ValueType::of(RuntimeType::of(id))}));
    } else if (entry->second == 0) {
      add(entry->first, nb::cast(arrays[entry->first]));
    }
  }
  return variables;
}

nb::object load(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw mtk::Error("slom.cannot-read",
                     "the file " + file.string() + " cannot be read; check its name and permissions",
                     file.string());
  }
  StoredProblem problem = archive().load(stream, file.string());
  const auto est = std::make_shared<Estimator>(std::move(problem.estimator));
  return nb::make_tuple(est, byName(est, problem.variables()));
}

/// Raises slom.Error with the parts of an error of the library.
void setError(nb::handle type, const mtk::Error& error, const std::exception& whole) {
  nb::object exception = type(inWords(whole.what()));
  exception.attr("id") = error.id();
  exception.attr("subject") = error.subject();
  exception.attr("sentence") = inWords(std::string(error.sentence()));
  exception.attr("remedy") = inWords(std::string(error.remedy()));
  try {
    std::rethrow_if_nested(whole);
  } catch (const FunctionThrew& cause) {
    exception.attr("__cause__") = cause.exception();
  } catch (const std::exception&) {  // its text is part of the sentence
  }
  PyErr_SetObject(type.ptr(), exception.ptr());
}

}  // namespace
}  // namespace slom::python

NB_MODULE(_slom, module) {
  namespace nb = nanobind;
  using namespace nb::literals;
  using namespace slom::python;
  using slom::Estimator, slom::AnyVarID;
  module.attr("__version__") = std::to_string(SLOM_VERSION_MAJOR) + "." + std::to_string(SLOM_VERSION_MINOR) +
                               "." + std::to_string(SLOM_VERSION_PATCH);
  module.doc() = "Sparse least squares on manifolds.";
  // An estimator keeps functions that it could not record. They refer to their modules, whose variables often include the
  // estimator. Such circles live until the end of the program, which is no fault.
  nb::set_leak_warnings(false);

  const nb::object error = nb::module_::import_("slom._error").attr("Error");
  module.attr("Error") = error;
  nb::register_exception_translator(
      [](const std::exception_ptr& exception, void* type) {
        try {
          std::rethrow_exception(exception);
        } catch (const mtk::Error& thrown) {
          setError(nb::handle(static_cast<PyObject*>(type)), thrown, thrown);
        }
      },
      nb::object(error).release().ptr());

  module.def("_count_tapes", [](const Estimator& est) { return est.table().pools().size(); });

  bindNumbers(module);
  bindManifolds(module);
  bindRows(module);
  bindVariables(module);
  bindFiles(module);

  nb::class_<Estimator> estimator(module, "Estimator", doc::kEstimator);
  bindMeasure(module, estimator);
  bindReports(module, estimator);
  estimator.def(nb::init<>())
      .def("__repr__",
           [](const Estimator& est) {
             std::size_t measurements = 0;
             for (const auto& pool : est.table().pools())
               measurements += static_cast<std::size_t>(pool->size());
             return "<Estimator of " + std::to_string(est.table().variableCount()) + " variables and " +
                    std::to_string(measurements) + " measurements>";
           })
      .def("__deepcopy__",
           alone(+[](const Estimator& est, nb::handle) { return std::make_shared<Estimator>(est.clone()); }))
      .def("__reduce_ex__",
           [](const Estimator&, int) -> nb::object {
             throw mtk::Error(
                 "slom.not-picklable",
                 "an estimator cannot be pickled; write it by est.save(file) and read it by slom.load(file), "
                 "or copy it by est.clone()",
                 "estimator");
           })
      .def("variable", alone(&variable), "value"_a.none(), "name"_a = "", "optimize"_a = true, doc::kVariable)
      .def("variables", alone(&variables), "values"_a.none(), "name"_a = "", "optimize"_a = true,
           doc::kVariables)
      .def(
          "optimize", alone(&optimize), nb::kw_only(), "max_iterations"_a = nb::none(),
          "max_seconds"_a = nb::none(), "gradient_tolerance"_a = nb::none(),
          "decrease_tolerance"_a = nb::none(), "step_tolerance"_a = nb::none(),
          "deviation_tolerance"_a = nb::none(), "graduated_non_convexity"_a = false,
          "most_parameters"_a = nb::none(), "observer"_a = nb::none(),
          "Fits the variables. Returns what the fit did, and why it stopped. Ctrl-C ends the fit with the best values "
          "reached. `observer` is called after each iteration; if it returns False, the fit ends.")
      .def(
          "prior",
          [](nb::handle self, const Variable& x, nb::handle value, nb::handle sigma, nb::handle covariance,
             nb::handle information, const std::string& path, nb::handle loss, const std::string& name) {
            const nb::object prior = nb::module_::import_("slom._prior").attr("prior");
            return nb::cast<Measurements>(
                prior(self, x, value, sigma, covariance, information, path, loss, name));
          },
          "variable"_a, "value"_a, "sigma"_a = nb::none(), nb::kw_only(), "covariance"_a = nb::none(),
          "information"_a = nb::none(), "path"_a = "", "loss"_a = nb::none(), "name"_a = "prior", doc::kPrior)
      .def("update",
           alone(+[](Estimator& est, double tolerance, int max_steps, double budget, bool reconsider) {
             const nb::gil_scoped_release unlocked;
             return est.update({tolerance, max_steps, budget, reconsider});
           }),
           nb::kw_only(), "tolerance"_a = 1e-6, "max_steps"_a = 100,
           "budget"_a = std::numeric_limits<double>::infinity(), "reconsider"_a = false,
           "Brings the values to the optimum after changes, in time proportional to what they affect.")
      .def(
          "residuals", alone(&residuals), "name"_a = nb::none(),
          "Returns the residuals of all measurements, or of the measurements with this name, in units of their standard "
          "deviations.")
      .def_prop_ro("rss", alone(+[](const Estimator& est) { return est.getRSS(); }),
                   "The sum of squared whitened residuals.")
      .def_prop_ro(
          "warnings", [](const Estimator& est) { return inWords(est.warnings()); },
          "A sentence for each variable that no measurement depends on.")
      .def("remove", alone(+[](Estimator& est, nb::handle what) {
             if (nb::isinstance<slom::MeasurementCheck>(what)) {
               est.removeMeasurement(nb::cast<slom::MeasurementCheck>(what).id);
             } else {
               for (const AnyVarID& id : handlesOf(what)) est.removeRV(id);
             }
           }),
           "what"_a,
           "Removes variables that no measurement depends on; or the measurement of a check: "
           "est.remove(est.outliers().ranking[0]).")
      .def("marginalize", alone(+[](Estimator& est, nb::handle variables, bool first_estimates) {
             est.marginalize(handlesOf(variables), {.first_estimates = first_estimates});
           }),
           "variables"_a, nb::kw_only(), "first_estimates"_a = false,
           "Removes variables and keeps what their measurements say about others.")
      .def("covariance", alone(&covariance), "a"_a, "b"_a = nb::none(), doc::kCovariance)
      .def("correlation", alone(+[](const Estimator& est, const Variable& a, const Variable& b) {
             return Eigen::MatrixXd(est.correlation(a.id, b.id));
           }),
           "a"_a, "b"_a, "Returns the correlations of the components of two variables.")
      .def("propagate", alone(&propagate), "function"_a, "arguments"_a, nb::kw_only(),
           "covariance"_a = nb::none(), doc::kPropagate)
      .def("clone", alone(+[](const Estimator& est) { return std::make_shared<Estimator>(est.clone()); }),
           "Returns a copy, which is fitted independently.")
      .def(
          "own",
          [](const std::shared_ptr<Estimator>& est, const Variable& x) {
            const auto& table = est->table();
            return Variable{est, AnyVarID(table.handleOf(table.indexOf(x.id))), x.type};
          },
          "variable"_a, "Returns this estimator's variable for one of the estimator that it was cloned from.")
      .def_prop_rw(
          "sigma",
          [](const Estimator& est) { return est.sigma() == slom::Sigma::known ? "known" : "estimated"; },
          alone(+[](Estimator& est, const std::string& sigma) {
            if (sigma != "known" && sigma != "estimated")
              raiseOption("sigma", sigma, "\"known\" or \"estimated\"");
            est.setSigma(sigma == "known" ? slom::Sigma::known : slom::Sigma::estimated);
          }),
          "What standard deviations trust: the stated uncertainties (\"known\"), or only their ratios (\"estimated\").")
      .def_prop_rw(
          "free_gauge",
          [](const Estimator& est) {
            return est.freeGauge() == slom::FreeGauge::error ? "error" : "inner_constraints";
          },
          alone(+[](Estimator& est, const std::string& gauge) {
            if (gauge != "error" && gauge != "inner_constraints")
              raiseOption("free_gauge", gauge, "\"error\" or \"inner_constraints\"");
            est.setFreeGauge(gauge == "error" ? slom::FreeGauge::error : slom::FreeGauge::inner_constraints);
          }),
          "What a free gauge does: an \"error\" at covariances, or a free network (\"inner_constraints\").")
      .def(
          "use_algorithm",
          alone(+[](Estimator& est, const std::string& name, std::optional<double> initial_damping,
                    std::optional<double> memory) {
            if (name == "lm") {
              est.changeAlgorithm(
                  slom::LevenbergMarquardt(initial_damping.value_or(1e-4), memory.value_or(1)));
              return;
            }
            if (initial_damping || memory)
              raiseOption("the algorithm with initial_damping or memory", name,
                          "\"lm\", which alone has these");
            const slom::NamedAlgorithm* const found = slom::algorithmNamed(name);
            if (found == nullptr) {
              std::string names;
              for (const slom::NamedAlgorithm& one : slom::algorithms())
                names += (names.empty() ? "" : ", ") + std::string(one.name);
              raiseOption("the algorithm", name, "one of " + names);
            }
            est.changeAlgorithm(found->make().release());
          }),
          "name"_a, nb::kw_only(), "initial_damping"_a = nb::none(), "memory"_a = nb::none(),
          "Chooses the algorithm by its name, as the command's option --algorithm does. \"lm\" takes two options: the first "
          "damping (1e-4), and the memory of the scales, from 0 to 1 (1). memory=0.1 is faster for bundle adjustments.")
      .def(
          "save", alone(&save), "file"_a,
          "Writes variables and measurements to a file for slom.load and the command slom replay. Functions that could not "
          "be recorded cannot be saved.")
      .def("set_threads", alone(+[](Estimator& est, int threads) { est.setThreads(threads); }), "threads"_a,
           "Sets the largest number of threads; 0: all of the machine.");

  module.def("load", &load, "file"_a, doc::kLoad);

  nb::class_<slom::FixedLag>(module, "FixedLag", doc::kFixedLag)
      .def(
          "__init__",
          [](slom::FixedLag* self, std::optional<int> variables, double duration, bool first_estimates) {
            slom::FixedLagOptions options;
            if (variables) options.variables = *variables;
            options.duration = duration;
            options.first_estimates = first_estimates;
            new (self) slom::FixedLag(options);
          },
          nb::kw_only(), "variables"_a = nb::none(), "duration"_a = std::numeric_limits<double>::infinity(),
          "first_estimates"_a = false)
      .def(
          "add",
          [](slom::FixedLag& window, const Variable& x, std::optional<double> time) {
            time ? window.add(x.id, *time) : window.add(x.id);
          },
          "variable"_a, "time"_a = nb::none(),
          "Adds a variable with its time; without one, 1 after the newest.")
      .def(
          "forget",
          [](slom::FixedLag& window, Estimator& est) {
            const InUse in_use(est);
            return window.forget(est);
          },
          "estimator"_a, "Marginalises the variables that are too old. Returns their number.")
      .def("__len__", &slom::FixedLag::size);
}
