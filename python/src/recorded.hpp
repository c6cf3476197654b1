// Numbers that record what a Python measurement function does with them, and NumPy arrays of them.
#pragma once

#include <memory>
#include <vector>

#include <nanobind/nanobind.h>

#include "slom/tape/number.hpp"

namespace slom::python {

namespace nb = nanobind;

/// Returns an object array of these numbers. `shape`: empty for a single number, which is returned itself.
nb::object arrayOf(const std::vector<tape::Number>& numbers, const std::vector<std::size_t>& shape);

/// Numbers that a measurement function brings along, as data. Functions that a loop makes with numbers of their own then
/// have one tape. A measurement of many rows keeps them as constants instead.
class Captures {
 public:
  struct State;
  /// Begins, if `is_active`; on this thread, until the end of this object.
  explicit Captures(bool is_active);
  ~Captures();
  Captures(const Captures&) = delete;
  Captures& operator=(const Captures&) = delete;

  /// Returns the number as a datum or, if no object is active or the number usually belongs to the formula, such as 2, as a
  /// constant.
  static tape::Number number(double value);

 private:
  std::unique_ptr<State> own_;
  State* outer_;
};

/// Calls a measurement function. Errors of NumPy about arrays of objects become errors with a remedy.
nb::object callRecorded(nb::handle f, const nb::tuple& arguments);

/// Appends the numbers of a result: a number, an array, or a list or tuple of such. Throws [slom.traced-result] for
/// anything else.
void appendNumbers(nb::handle result, std::vector<tape::Number>& numbers);

/// Declares Number and Condition.
void bindNumbers(nb::module_& module);

}  // namespace slom::python
