// Measurement functions that Python calls row by row, during a fit that has released the interpreter's lock.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <slom/slom.hpp>

#include "call.hpp"

namespace slom::python {

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

/// A function that is called measurement by measurement. The library calls it from its threads.
class PlainFunction {
 public:
  /// `jacobian`: the user's derivatives of the residual by the variables, or None.
  PlainFunction(const Call& call, nb::handle jacobian);

  /// Returns the residual of a row.
  Eigen::VectorXd operator()(std::span<const VariableView> x, const std::vector<double>& data) const;
  bool hasJacobian() const;
  /// Returns the derivatives of the residual, `rows` x `columns`, as the user's function gives them.
  Eigen::MatrixXd jacobian(std::span<const VariableView> x, const std::vector<double>& data, int rows,
                           int columns) const;

 private:
  struct Shared;
  nb::list argumentsOf(std::span<const VariableView> x, const std::vector<double>& data) const;
  Eigen::VectorXd residual(std::span<const VariableView> x, const std::vector<double>& data) const;

  std::shared_ptr<const Shared> shared_;
};

/// A measurement whose residual and derivatives are functions in Python.
class DerivedMeasurement final : public RuntimeMeasurement {
 public:
  DerivedMeasurement(std::vector<AnyVarID> variables, PlainFunction f, std::vector<double> data);

  const RuntimeKind& kind() const override;
  int evaluate(int rows, double* r) const override;
  int linearize(int rows, double* r, double* J) const override;
  std::unique_ptr<RuntimeMeasurement> copyOver(std::vector<AnyVarID> variables) const override;

 private:
  PlainFunction f_;
  std::vector<double> data_;
  int columns_ = 0;
};

}  // namespace slom::python
