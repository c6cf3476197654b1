// Measurements whose function is written in Python.
#pragma once

#include <vector>

#include "variable.hpp"

namespace slom::python {

/// Measurements that one call added.
struct Measurements {
  Shared est;
  std::vector<AnyMeasID> ids;
};

/// Declares Measurements, the losses and Estimator.measure.
void bindMeasure(nb::module_& module, nb::class_<Estimator>& estimator);

/// A value and Jacobian of a Python function of variables: what propagates uncertainty.
struct Derived {
  std::shared_ptr<const ValueType> type;
  std::vector<double> numbers;  ///< the value
  Eigen::MatrixXd jacobian;     ///< by the components of the variables
};
/// Returns f(variables...) and its derivatives.
Derived derivedFrom(nb::handle f, const std::vector<Variable>& variables);

}  // namespace slom::python
