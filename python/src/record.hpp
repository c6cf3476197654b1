// Measurement functions as tapes.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <slom/tape.hpp>

#include "call.hpp"

namespace slom::python {

/// A function as a tape.
struct Recorded {
  std::shared_ptr<const TracedKind> kind;
  std::vector<double> captured;  ///< data that the function brought along
  bool is_new = false;
};

/// Returns the function as a tape, or nothing if it must be called as it is. `trace`: true raises in place of the
/// latter, false records nothing.
std::optional<Recorded> recordedOrNot(const Call& call, const std::string& label, std::optional<bool> trace);
/// Sets `data` to the numbers of a row, with those that the function brought along.
void setData(const Call& call, const Recorded& recorded, std::size_t row, std::vector<double>& data);

/// A value and Jacobian of a Python function of variables: what propagates uncertainty.
struct Derived {
  std::shared_ptr<const ValueType> type;
  std::vector<double> numbers;  ///< the value
  std::vector<AnyVarID> variables;
  Eigen::MatrixXd jacobian;  ///< by the components of the variables
};
/// Returns f(arguments...), of variables and data, and its derivatives.
Derived derivedFrom(nb::handle f, const nb::args& arguments);

}  // namespace slom::python
