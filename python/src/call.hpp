// The arguments of Estimator.measure, and plain calls of the user's function with them.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "variable.hpp"

namespace slom::python {

/// An argument of a measurement function: a variable or a variable for each row; a datum or a datum for each row.
struct Argument {
  std::shared_ptr<const ValueType> type;
  std::vector<AnyVarID> variables;
  std::vector<double> data;
  bool is_variable = false;
  bool is_for_all = false;  ///< the same in each row

  std::size_t rows() const {
    return is_variable ? variables.size() : data.size() / static_cast<std::size_t>(type->coordinates());
  }
  const AnyVarID& variable(std::size_t row) const { return variables[is_for_all ? 0 : row]; }
  const double* datum(std::size_t row) const {
    return data.data() + (is_for_all ? 0 : row * static_cast<std::size_t>(type->coordinates()));
  }
};

/// The function, arguments and number of rows of a call of measure.
struct Call {
  nb::object function;
  std::vector<Argument> arguments;  ///< with the datum last, if there is one
  bool predicts = false;            ///< the residual is f(...) [-] the last argument
  std::size_t rows = 1;
};

/// Returns the arguments of a call. Throws [slom.bad-argument] unless all have the same number of rows.
Call callOf(nb::handle f, const nb::args& passed, nb::handle measured);
/// Throws [slom.ambiguous-rows] if numbers, one a row, seem to be meant as one vector: they are as many as a variable has
/// components, and the function takes them all at once, too, with another result.
void checkRows(const Call& call);
/// Returns a variable, or a value that is not divided into rows.
Argument singleArgument(nb::handle value, const std::string& subject);

/// Calls the function with these arguments and returns the residual.
nb::object residualOf(const Call& call, const nb::list& arguments, bool is_recorded = false);
/// Appends the numbers of a residual.
void appendDoubles(nb::handle result, std::vector<double>& numbers);
/// Returns the values of a row's variables: the current ones, or others near them.
std::vector<std::vector<double>> valuesOf(const Call& call, std::size_t row, bool is_moved);
/// Returns what the function returns for a row at these values of its variables, by calling the function as it is.
nb::object plainResult(const Call& call, std::size_t row, const std::vector<std::vector<double>>& values);
/// Returns the numbers of that result.
std::vector<double> plainResidual(const Call& call, std::size_t row,
                                  const std::vector<std::vector<double>>& values);

/// Keeps NumPy from warning of logarithms of negative numbers and the like.
class QuietNumpy {
 public:
  QuietNumpy();
  ~QuietNumpy();
  QuietNumpy(const QuietNumpy&) = delete;
  QuietNumpy& operator=(const QuietNumpy&) = delete;

 private:
  nb::object before_;
};

}  // namespace slom::python
