/// Recording: what a measurement function does with Numbers.
///     slom::tape::Recording recording;   // current on this thread until it is destroyed
///     const auto p = recording.variable(slom::tape::VariableType{"vect<2>", {{slom::tape::Part::Kind::vector, 2}}});
///     const slom::tape::Number z = slom::tape::data(1.5);
///     const slom::tape::Tape tape = recording.finish({sqrt(p.coordinates[0] * p.coordinates[0] + ...) - z});
/// Recordings of one thread nest.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "slom/model/pimpl.hpp"
#include "slom/tape/number.hpp"
#include "slom/tape/tape.hpp"

namespace slom::tape {

class Recording {
 public:
  /// Starts to record on this thread.
  Recording();
  /// Makes the recording before it current again.
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// The numbers that store a variable, and the unknowns that move it.
  struct Input {
    std::vector<Number> coordinates;
    std::vector<Number> tangent;
  };
  /// Adds a variable. Its unknowns are the next columns of the Jacobian.
  Input variable(const VariableType& type);
  /// Adds a column of data with the value that it has in this measurement.
  Number data(double value);
  /// Returns the values of the data, one for each column.
  const std::vector<double>& values() const;

  /// Sets the place in the user's source of what is recorded next on this thread.
  static void at(std::string_view file, int line);

  /// Returns a number that equal formulas have in common. `residual`: the entries of the residual.
  std::uint64_t fingerprint(const std::vector<Number>& residual) const;
  /// Differentiates and translates the formula. Throws [slom.traced-too-long] for more than kMostRegisters values.
  Tape finish(const std::vector<Number>& residual);

 private:
  friend struct detail::Access;
  struct State;
  slom::detail::Pimpl<State> state_;
};

namespace detail {

/// A derivative with respect to an unknown or a number.
struct Term {
  Number of, coefficient;
};
/// Returns a new unknown. It stands for a perturbation and may itself depend on others: setDerivative.
Number newTangent();
/// States the derivative of a number or unknown, in place of the derivative of the operations that made it. Terms with
/// a constant unknown are ignored. Does nothing if the derivative is already stated or x is a constant.
void setDerivative(const Number& x, const std::vector<Term>& terms);

}  // namespace detail

}  // namespace slom::tape
