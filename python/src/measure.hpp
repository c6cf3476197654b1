// Measurements whose function is written in Python.
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "variable.hpp"

namespace slom::python {

/// Measurements that one call added.
struct Measurements {
  Shared est;
  std::vector<AnyMeasID> ids;
};

/// The end of a fit by Ctrl-C, which keeps the best values. Exists while the fit runs.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  /// Asks the running fits to end, after a KeyboardInterrupt in a measurement function. Returns whether there are any.
  static bool request();
  /// Returns whether the fit shall end.
  bool operator()();
  /// Raises KeyboardInterrupt if it shall.
  void raise();

 private:
  std::optional<nb::python_error> error_;
};

/// A Python exception within a measurement function, while the fit has released the interpreter's lock.
class FunctionThrew : public std::runtime_error {
 public:
  explicit FunctionThrew(const nb::python_error& error);
  /// Returns the exception.
  nb::object exception() const;

 private:
  std::shared_ptr<nb::python_error> error_;
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
