// Measurements whose function is written in Python.
#pragma once

#include <vector>

#include "variable.hpp"

namespace slom::python {

/// Measurements that one call added.
struct Measurements {
  Shared est;
  std::vector<AnyMeasID> ids;
  std::size_t length = 0;  ///< of each residual
};

/// Declares Measurements, the losses and Estimator.measure.
void bindMeasure(nb::module_& module, nb::class_<Estimator>& estimator);

}  // namespace slom::python
