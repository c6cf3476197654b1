// Python classes for the reports of fits and analyses.
#pragma once

#include <memory>

#include <nanobind/nanobind.h>

#include "slom/optimize/summary.hpp"
#include "variable.hpp"

namespace slom::python {

/// A fit: its summary and the estimator that it changed.
struct Fit {
  Shared est;
  Summary summary;
};

/// Declares Fit, the other reports, and the functions of the estimator that make them.
void bindReports(nb::module_& module, nb::class_<Estimator>& estimator);

}  // namespace slom::python
