// Rotations, directions and poses as Python sees them: SO2, SO3, S2, SE2 and SE3 of numbers, and of recorded numbers.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nanobind/nanobind.h>

#include "mtk/types/s2.hpp"
#include "mtk/types/trafo.hpp"
#include "slom/tape/input.hpp"

namespace slom::python {

namespace nb = nanobind;

template <class S>
using SE2 = mtk::trafo<mtk::SO2<S>>;
template <class S>
using SE3 = mtk::trafo<mtk::SO3<S>>;

/// Returns the module numpy.
nb::object numpy();
/// Returns numpy.shape(x).
std::vector<std::size_t> shapeOf(nb::handle x);

/// Throws [slom.bad-value].
[[noreturn]] void raiseValue(const std::string& subject, const std::string& fault, const std::string& remedy);

/// Returns x as an array of float64. `subject` names it in errors. Throws [slom.bad-value].
nb::object realArray(nb::handle x, const std::string& subject);

/// Returns whether x is a recorded number, or has one in it.
bool isRecorded(nb::handle x);

/// Returns the entries of an array, list or number; `size` of them, or any number if that is -1. `what` names the array
/// in errors. Throws [slom.wrong-shape] or [slom.bad-value].
template <class S>
std::vector<S> entriesOf(nb::handle x, int size, const std::string& what);

/// Returns these numbers as a number or an array of this shape.
nb::object toPython(const double* numbers, const std::vector<std::size_t>& shape);
nb::object toPython(const tape::Number* numbers, const std::vector<std::size_t>& shape);

/// Declares the classes.
void bindManifolds(nb::module_& module);

}  // namespace slom::python
