// Types of variables: what Python passes as a start value, and how a measurement function sees it.
#pragma once

#include <memory>
#include <string>
#include <typeindex>
#include <vector>

#include <Eigen/Core>
#include <nanobind/nanobind.h>

#include "slom/model/any_var_id.hpp"
#include "slom/tape/input.hpp"
#include "slom/tape/recording.hpp"

namespace slom {
class Estimator;
}

namespace slom::python {

namespace nb = nanobind;

/// What the package does with variables of one C++ type.
class VariableKind {
 public:
  virtual ~VariableKind() = default;
  virtual AnyVarID insert(Estimator& est, nb::handle value, const std::string& name, bool optimize) const = 0;
  virtual nb::object value(const AnyVarID& id) const = 0;
  virtual void set(Estimator& est, const AnyVarID& id, nb::handle value) const = 0;
  virtual void fix(Estimator& est, const AnyVarID& id, bool fixed) const = 0;
  virtual std::string name(const Estimator& est, const AnyVarID& id) const = 0;
  virtual Eigen::MatrixXd covariance(const Estimator& est, const AnyVarID& id) const = 0;
  virtual Eigen::VectorXd deviation(const Estimator& est, const AnyVarID& id) const = 0;
  /// Returns the variable as a measurement function gets it.
  virtual nb::object recorded(tape::Recording& recording, const AnyVarID& id) const = 0;
  virtual std::type_index type() const = 0;
  virtual tape::Layout layout(const AnyVarID& id) const = 0;
};

/// Returns the kind for a start value: a number, or an array of one dimension. Throws [slom.bad-value].
const VariableKind& kindOf(nb::handle value);

}  // namespace slom::python
