// Variables and arrays of variables of an estimator.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slom/estimator.hpp"
#include "value_type.hpp"

namespace slom::python {

/// An estimator, shared by its variables and measurements.
using Shared = std::shared_ptr<Estimator>;

/// A variable of an estimator.
struct Variable {
  Shared est;
  AnyVarID id;
  std::shared_ptr<const ValueType> type;

  const double* numbers() const { return static_cast<const double*>(id.current()); }
};

/// Variables of one type.
struct VariableArray {
  Shared est;
  std::vector<AnyVarID> ids;
  std::shared_ptr<const ValueType> type;
};

/// Returns the handles of a variable, an array of variables, or a list of these.
std::vector<AnyVarID> handlesOf(nb::handle variables);

/// Declares both classes.
void bindVariables(nb::module_& module);

}  // namespace slom::python
