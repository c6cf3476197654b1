#include "reports.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/slom.hpp>

#include "alone.hpp"
#include "documentation.hpp"
#include "words.hpp"

namespace slom::python {

using namespace nb::literals;

namespace {

template <class T>
std::string textOf(const T& x) {
  std::ostringstream text;
  text << x;
  return inWords(text.str());
}

/// Returns a method that is a function of slom/_fit.py.
auto inPython(const char* name) {
  return [name](nb::handle self) { return nb::module_::import_("slom._fit").attr(name)(self); };
}

/// Declares a class that prints as in C++.
template <class T>
nb::class_<T> bindReport(nb::module_& module, const char* name, const char* doc) {
  nb::class_<T> c(module, name, doc);
  c.def("__str__", &textOf<T>).def("__repr__", &textOf<T>).def("_repr_html_", inPython("html_of_text"));
  return c;
}

/// Returns the ways of grouping that Python names: dimensions, "label", or lists of variables.
std::vector<ClusterBy> waysOf(nb::handle by) {
  std::vector<ClusterBy> ways;
  if (by.is_none()) return ways;
  if (nb::isinstance<nb::str>(by)) return {ClusterBy(nb::cast<std::string>(by))};
  if (nb::isinstance<VariableArray>(by)) return {ClusterBy::variables("variables", handlesOf(by))};
  for (const nb::handle one : by) {
    const std::vector<ClusterBy> own = waysOf(one);
    ways.insert(ways.end(), own.begin(), own.end());
  }
  return ways;
}

ClusterCorrection correctionNamed(const std::string& name) {
  if (name == "cr0") return ClusterCorrection::cr0;
  if (name == "cr1") return ClusterCorrection::cr1;
  if (name == "cr2") return ClusterCorrection::cr2;
  if (name == "cr3") return ClusterCorrection::cr3;
  if (name == "by_leverage") return ClusterCorrection::by_leverage;
  throw mtk::Error("slom.bad-option",
                   "the correction is \"" + name + "\"; pass one of cr0, cr1, cr2, cr3 and by_leverage",
                   "correction");
}

/// Returns the joint covariance of the components that were fitted.
Eigen::MatrixXd covarianceOf(const Fit& fit) {
  const Problem& table = fit.est->table();
  std::vector<AnyVarID> ids;
  std::vector<int> fitted;
  int first = 0;
  for (int i = 0; i < static_cast<int>(table.variables().size()); ++i) {
    const VariableRecord& record = table.variables()[static_cast<std::size_t>(i)];
    if (record.store == nullptr || !table.activeSet().isOptimized(i)) continue;
    ids.emplace_back(table.handleOf(i));
    const std::vector<char>& fixed = table.activeSet().fixed(i);
    for (int c = 0; c < record.dof; ++c) {
      if (fixed.empty() || fixed[static_cast<std::size_t>(c)] == 0) fitted.push_back(first + c);
    }
    first += record.dof;
  }
  constexpr int most = 20000;
  if (first > most) {
    throw mtk::Error(
        "slom.too-large",
        "the joint covariance of " + std::to_string(first) +
            " components is too large to compute; take x.covariance of variables and arrays of variables, or "
            "est.covariance([a, b]) of some",
        "covariance");
  }
  return fit.est->jointCovariance(ids)(fitted, fitted);
}

void bindFit(nb::module_& module) {
  nb::class_<ParameterSummary>(module, "Parameter", "A fitted component.")
      .def_ro("name", &ParameterSummary::name)
      .def_ro("value", &ParameterSummary::value)
      .def_ro("text", &ParameterSummary::text, "For a direction its unit vector, in place of a value.")
      .def_ro("std", &ParameterSummary::standard_deviation)
      .def_ro("clustered", &ParameterSummary::clustered)
      .def("__repr__", [](const ParameterSummary& p) {
        return p.name + " = " + (p.text.empty() ? textOf(p.value) : p.text) + " ± " +
               textOf(p.standard_deviation);
      });
  nb::class_<GroupSummary>(module, "Kind", "The measurements of one label in a fit.")
      .def_ro("name", &GroupSummary::name)
      .def_ro("measurements", &GroupSummary::measurements)
      .def_ro("residuals", &GroupSummary::residuals)
      .def_ro("initial_rss", &GroupSummary::initial_rss)
      .def_ro("final_rss", &GroupSummary::final_rss)
      .def_ro("redundancy", &GroupSummary::redundancy)
      .def_ro("derivatives", &GroupSummary::derivatives)
      .def("__repr__", [](const GroupSummary& group) {
        return "<" + group.name + ": " + textOf(group.measurements) + " measurements, RSS " +
               textOf(group.final_rss) + ">";
      });
  nb::class_<CorrelationSummary>(module, "Correlation",
                                 "Two components whose errors are strongly correlated.")
      .def_ro("a", &CorrelationSummary::a)
      .def_ro("b", &CorrelationSummary::b)
      .def_ro("correlation", &CorrelationSummary::correlation)
      .def("__repr__", [](const CorrelationSummary& c) {
        return "<" + c.a + ", " + c.b + ": " + textOf(c.correlation) + ">";
      });
  nb::class_<IterationRecord>(module, "Iteration", "One line of progress.")
      .def_ro("iteration", &IterationRecord::iteration)
      .def_ro("algorithm", &IterationRecord::algorithm)
      .def_ro("rss", &IterationRecord::rss)
      .def_ro("relative_decrease", &IterationRecord::relative_decrease)
      .def_ro("step", &IterationRecord::step)
      .def_ro("damping", &IterationRecord::damping)
      .def_ro("seconds", &IterationRecord::seconds)
      .def("__repr__", [](const IterationRecord& record) {
        return "<iteration " + textOf(record.iteration) + ": RSS " + textOf(record.rss) + ">";
      });

  const auto of = [](auto member) { return [member](const Fit& fit) { return fit.summary.*member; }; };
  nb::class_<Fit>(module, "Fit", "What a fit did, and why it stopped.")
      .def_prop_ro(
          "estimator", [](const Fit& fit) { return fit.est; }, "The estimator that was fitted.")
      .def_prop_ro("converged", of(&Summary::converged))
      .def_prop_ro("stop_reason",
                   [](const Fit& fit) { return std::string(toString(fit.summary.stop_reason)); })
      .def_prop_ro(
          "message", [](const Fit& fit) { return inWords(fit.summary.message); },
          "The reason for the end, in a sentence.")
      .def_prop_ro("warnings", [](const Fit& fit) { return inWords(fit.summary.warnings); })
      .def_prop_ro("algorithm", of(&Summary::algorithm))
      .def_prop_ro("iterations", of(&Summary::iterations))
      .def_prop_ro("measurements", of(&Summary::measurements), "Number of scalar residuals.")
      .def_prop_ro("unknowns", of(&Summary::unknowns))
      .def_prop_ro("redundancy", of(&Summary::redundancy), "Measurements minus unknowns that they determine.")
      .def_prop_ro("free_directions", of(&Summary::free_directions))
      .def_prop_ro("active_bounds", of(&Summary::active_bounds))
      .def_prop_ro("initial_rss", of(&Summary::initial_rss))
      .def_prop_ro("final_rss", of(&Summary::final_rss), "Sum of squared whitened residuals at the end.")
      .def_prop_ro("chi2_per_dof", [](const Fit& fit) { return fit.summary.chi2PerDof(); })
      .def_prop_ro("seconds", of(&Summary::seconds))
      .def_prop_ro("kinds", of(&Summary::groups))
      .def_prop_ro("undetermined", of(&Summary::undetermined))
      .def_prop_ro("correlations", of(&Summary::correlations))
      .def_prop_ro("trace", of(&Summary::trace))
      .def_prop_ro("parameters", alone(+[](Fit& fit) {
                     if (fit.summary.parameters_not_shown > 0) fit.est->addParametersTo(fit.summary);
                     return fit.summary.parameters;
                   }),
                   "The fitted components with their standard deviations.")
      .def_prop_ro("params", inPython("params"), "The fitted components as a pandas frame.")
      .def_prop_ro("uncertainties", inPython("uncertainties"),
                   "The fitted components as correlated values of the package `uncertainties`, by name.")
      .def(
          "plot",
          [](nb::handle self, nb::handle figure, bool profiles) {
            return nb::module_::import_("slom._fit").attr("plot")(self, figure, profiles);
          },
          "figure"_a = nb::none(), "profiles"_a = false,
          "Plots the residuals of each kind of measurements beside the normal distribution, and the correlations of the "
          "parameters, if there are at most 200. With profiles=True, the 95 % intervals by profiles beside those by standard "
          "deviations (dotted). Returns the figure. Needs matplotlib.")
      .def("_repr_html_", inPython("html_of_fit"))
      .def_prop_ro("covariance", alone(&covarianceOf), "Joint covariance of `parameters`, in their order.")
      .def(
          "json", [](const Fit& fit) { return fit.summary.json(); }, "Returns the summary as a JSON object.")
      .def("__str__", [](const Fit& fit) { return textOf(fit.summary); })
      .def("__repr__", [](const Fit& fit) { return textOf(fit.summary); });
}

Eigen::MatrixXd jointCovarianceOf(const Clustered& clustered, const std::vector<AnyVarID>& ids) {
  if (ids.size() == 1) return clustered.covariance(ids[0]);
  std::vector<Eigen::Index> start{0};
  for (const AnyVarID& id : ids) start.push_back(start.back() + clustered.covariance(id).rows());
  Eigen::MatrixXd C(start.back(), start.back());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t j = 0; j < ids.size(); ++j)
      C.block(start[i], start[j], start[i + 1] - start[i], start[j + 1] - start[j]) =
          clustered.covariance(ids[i], ids[j]);
  }
  return C;
}

void bindClustered(nb::module_& module) {
  nb::class_<ClusterCheck>(module, "ClusterCheck", "A test of one group.")
      .def_ro("group", &ClusterCheck::group)
      .def_ro("measurements", &ClusterCheck::measurements)
      .def_ro("statistic", &ClusterCheck::statistic)
      .def_ro("dof", &ClusterCheck::dof)
      .def_ro("probability", &ClusterCheck::probability);
  bindReport<ClusterOutliers>(module, "ClusterOutliers",
                              "Groups that pull the values more than the others do.")
      .def_prop_ro("suspects", &ClusterOutliers::suspects, "The number of suspects.");
  bindReport<Clustered>(module, "Clustered", "Covariances for errors that measurements share within groups.")
      .def(
          "covariance",
          [](const Clustered& c, nb::handle variables) { return jointCovarianceOf(c, handlesOf(variables)); },
          "variables"_a,
          "Returns the covariance of a variable, or the joint covariance of a list of variables, for est.propagate.")
      .def("std",
           [](const Clustered& c, const Variable& x) { return Eigen::VectorXd(c.standardDeviation(x.id)); })
      .def("degrees_of_freedom",
           [](const Clustered& c, const Variable& x) { return Eigen::VectorXd(c.degreesOfFreedom(x.id)); })
      .def(
          "interval",
          [](const Clustered& c, const Variable& x, double probability) {
            return Eigen::VectorXd(c.interval(x.id, probability));
          },
          "variable"_a, "probability"_a = 0.95, "Returns half the width of the interval of each component.")
      .def(
          "change", [](const Clustered& c, const Variable& x) { return Eigen::MatrixXd(c.change(x.id)); },
          "Returns how much each component moves if a group is left out, one row for each group.")
      .def("influence",
           [](const Clustered& c, const Variable& x) { return Eigen::MatrixXd(c.influence(x.id)); })
      .def_prop_ro("groups", &Clustered::groups)
      .def_prop_ro("notes", [](const Clustered& c) { return c.notes(); })
      .def("check", &Clustered::check)
      .def("outliers", &Clustered::outliers, "significance"_a = 0.01);
}

}  // namespace

void bindReports(nb::module_& module, nb::class_<Estimator>& estimator) {
  bindFit(module);
  bindClustered(module);
  bindReport<UpdateSummary>(module, "Update", "What an update did.")
      .def_ro("converged", &UpdateSummary::converged)
      .def_ro("message", &UpdateSummary::message)
      .def_ro("rss", &UpdateSummary::rss)
      .def_ro("steps", &UpdateSummary::steps)
      .def_ro("needs_optimize", &UpdateSummary::needs_optimize)
      .def_ro("used_optimize", &UpdateSummary::used_optimize)
      .def_ro("accepted", &UpdateSummary::accepted)
      .def_ro("undetermined", &UpdateSummary::undetermined);
  bindReport<ProfileInterval>(module, "Interval", "A profile likelihood interval.")
      .def_ro("value", &ProfileInterval::value)
      .def_ro("lower", &ProfileInterval::lower)
      .def_ro("upper", &ProfileInterval::upper)
      .def("__iter__", [](const ProfileInterval& own) {
        return nb::object(nb::make_tuple(own.lower, own.upper).attr("__iter__")());
      });
  nb::class_<ParameterInterval>(module, "ParameterInterval", "A row of an interval table.")
      .def_ro("name", &ParameterInterval::name)
      .def_ro("value", &ParameterInterval::value)
      .def_ro("std", &ParameterInterval::standard_deviation)
      .def_ro("lower", &ParameterInterval::lower)
      .def_ro("upper", &ParameterInterval::upper)
      .def_ro("is_profile", &ParameterInterval::is_profile)
      .def("__repr__", [](const ParameterInterval& p) {
        return "<" + p.name + " = " + textOf(p.value) + " in [" + textOf(p.lower) + ", " + textOf(p.upper) +
               "]>";
      });
  bindReport<IntervalTable>(module, "IntervalTable", "Intervals of all components.")
      .def_ro("probability", &IntervalTable::probability)
      .def_ro("rows", &IntervalTable::rows)
      .def("markdown", &IntervalTable::markdown)
      .def("csv", &IntervalTable::csv);
  nb::class_<Finding>(module, "Finding", "A finding of a diagnosis.")
      .def_ro("is_fault", &Finding::is_fault)
      .def_ro("text", &Finding::text)
      .def_ro("names", &Finding::names)
      .def_ro("dimension", &Finding::dimension)
      .def("__repr__", [](const Finding& finding) { return finding.text; });
  bindReport<Diagnosis>(module, "Diagnosis", "What the measurements determine.")
      .def_ro("unknowns", &Diagnosis::unknowns)
      .def_ro("rank", &Diagnosis::rank)
      .def_ro("findings", &Diagnosis::findings)
      .def_prop_ro("is_determined", &Diagnosis::isDetermined);
  nb::class_<MeasurementCheck>(module, "MeasurementCheck", "A test of one measurement.")
      .def_ro("measurement", &MeasurementCheck::measurement)
      .def_ro("residual", &MeasurementCheck::residual)
      .def_ro("studentized", &MeasurementCheck::studentized)
      .def_ro("redundancy", &MeasurementCheck::redundancy)
      .def_ro("probability", &MeasurementCheck::probability)
      .def_ro("is_suspect", &MeasurementCheck::is_suspect)
      .def("__repr__", [](const MeasurementCheck& check) {
        return "<" + check.measurement +
               ", p = " + nb::cast<std::string>(nb::str(nb::float_(check.probability))) + ">";
      });
  bindReport<OutlierReport>(module, "OutlierReport", "Tests of all measurements.")
      .def_prop_ro("suspects", &OutlierReport::suspects, "The number of suspects.")
      .def_prop_ro("ranking", &OutlierReport::ranking, "The least probable measurements, the worst first.");
  bindReport<Preflight>(module, "Preflight", "What is wrong before a fit.")
      .def_prop_ro("faults", [](const Preflight& p) { return inWords(p.faults); })
      .def_prop_ro("warnings", [](const Preflight& p) { return inWords(p.warnings); })
      .def_prop_ro("ok", &Preflight::ok);
  bindReport<DerivativeCheck>(module, "DerivativeCheck", "A comparison of derivatives with differences.")
      .def_prop_ro("ok", &DerivativeCheck::ok);
  nb::class_<VarianceComponent>(module, "VarianceComponent", "The error size of one kind of measurements.")
      .def_ro("name", &VarianceComponent::name)
      .def_ro("factor", &VarianceComponent::factor)
      .def_ro("std", &VarianceComponent::standard_deviation)
      .def_ro("redundancy", &VarianceComponent::redundancy)
      .def_ro("is_estimated", &VarianceComponent::is_estimated)
      .def_ro("reason", &VarianceComponent::reason)
      .def("interval", &VarianceComponent::interval, "probability"_a = 0.95)
      .def("__repr__", [](const VarianceComponent& c) {
        return "<" + c.name + ": factor " + textOf(c.factor) + " ± " + textOf(c.standard_deviation) + ">";
      });
  bindReport<VarianceComponents>(module, "VarianceComponents", "Error sizes of the kinds of measurements.")
      .def_ro("converged", &VarianceComponents::converged)
      .def_ro("components", &VarianceComponents::components)
      .def_ro("notes", &VarianceComponents::notes);

  estimator
      .def("profile",
           alone(+[](Estimator& est, const Variable& x, const std::string& path, double probability) {
             return path.empty() ? profile(est, x.id, probability) : profile(est, x.id, path, probability);
           }),
           "variable"_a, "path"_a = "", "probability"_a = 0.95, doc::kProfile)
      .def("intervals",
           alone(+[](Estimator& est, double probability) { return intervals(est, probability); }),
           "probability"_a = 0.95, doc::kIntervals)
      .def("diagnose", alone(+[](const Estimator& est) { return diagnose(est); }),
           "Returns what the measurements determine.")
      .def("preflight", alone(+[](const Estimator& est) { return preflight(est); }),
           "Returns what is wrong before a fit.")
      .def("outliers", alone(+[](const Estimator& est, double significance, int worst) {
             return outliers(est, {.significance = significance, .worst = worst});
           }),
           "significance"_a = 0.01, "worst"_a = 10, doc::kOutliers)
      .def("check_derivatives", alone(+[](const Estimator& est) { return checkDerivatives(est); }),
           "Compares derivatives with differences.")
      .def("clustered",
           alone(+[](const Estimator& est, nb::handle by, const std::string& correction, bool ordered,
                     bool refit) {
             ClusterOptions options;
             options.by = waysOf(by);
             options.correction = correctionNamed(correction);
             options.ordered = ordered;
             options.refit = refit;
             return clustered(est, options);
           }),
           "by"_a = nb::none(), nb::kw_only(), "correction"_a = "by_leverage", "ordered"_a = false,
           "refit"_a = false, nb::keep_alive<0, 1>(), doc::kClustered)
      .def(
          "variance_components",
          alone(+[](Estimator& est, const std::vector<std::string>& kinds, bool apply_them) {
            VarianceOptions options;
            options.kinds = kinds;
            VarianceComponents components = varianceComponents(est, options);
            if (apply_them) apply(components, est);
            return components;
          }),
          "kinds"_a = std::vector<std::string>(), "apply"_a = false,
          "Estimates the error sizes of the kinds of measurements, and with apply=True uses them from then on.");
}

}  // namespace slom::python
