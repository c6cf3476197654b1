// Numbers that record what a Python measurement function does with them, and NumPy arrays of them.
#pragma once

#include <vector>

#include <nanobind/nanobind.h>

#include "slom/tape/number.hpp"

namespace slom::python {

namespace nb = nanobind;

/// Returns an object array of these numbers. `shape`: empty for a single number, which is returned itself.
nb::object arrayOf(const std::vector<tape::Number>& numbers, const std::vector<std::size_t>& shape);

/// Calls a measurement function. Errors of NumPy about arrays of objects become errors with a remedy.
nb::object callRecorded(const nb::callable& f, const nb::tuple& arguments);

/// Appends the numbers of a result: a number, an array, or a list or tuple of such. Throws [slom.traced-result] for
/// anything else.
void appendNumbers(nb::handle result, std::vector<tape::Number>& numbers);

/// Declares Number and Condition.
void bindNumbers(nb::module_& module);

}  // namespace slom::python
