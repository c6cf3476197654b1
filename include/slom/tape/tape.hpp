/// Tape: a measurement function as data. Straight-line code over registers gives the residual and its derivatives of
/// many measurements at once.
///
///   inputs     coordinates of the variables, in their order; then the data, one number a column
///   outputs    residual, `rows` numbers; Jacobian, rows x columns, by the tangents of the variables at zero
///   code       a list of instructions without jumps; each reads and writes registers of 64 numbers (32 if many
///              registers are used), one number for each measurement
/// A tape is a plain value: no pointers, no callbacks, no state. Code that comes from outside is checked once, when the
/// Tape is made from it. A checked tape reads and writes its registers alone and ends after its last instruction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "slom/tape/instruction.hpp"

namespace slom::tape {

/// A part of a variable with a [+] of its own.
struct Part {
  enum class Kind : std::uint8_t {
    vector,     ///< R^n, moved by adding
    angle,      ///< mtk::SO2: its angle [rad]
    rotation,   ///< mtk::SO3: its quaternion (x, y, z, w), moved on the right
    direction,  ///< mtk::S2: its unit vector
  };
  Kind kind = Kind::vector;
  int size = 0;  ///< of a vector

  /// Returns the number of coordinates.
  int coordinates() const;
  /// Returns the degrees of freedom.
  int dof() const;
  bool operator==(const Part&) const = default;
};

/// The type of a variable: its name and its parts, whose coordinates and unknowns follow one another.
struct VariableType {
  std::string name;
  std::vector<Part> parts;

  /// Returns the number of coordinates of all parts.
  int coordinates() const;
  /// Returns the degrees of freedom of all parts.
  int dof() const;
  bool operator==(const VariableType&) const = default;
};

/// A line of the user's source that instructions come from.
struct Place {
  std::string file;
  int line = 0;
};

/// The content of a tape. Registers are numbered: coordinates, data, constants, outputs (rows, then the entries of the
/// Jacobian that are computed), intermediate results.
struct Code {
  std::vector<VariableType> variables;
  int data = 0;                   ///< number of columns of data
  int rows = 0;                   ///< length of the residual
  std::vector<double> constants;  ///< one register each
  int registers = 0;
  std::vector<Instruction> residual;       ///< computes the residual alone
  std::vector<Instruction> linearization;  ///< computes residual and Jacobian
  /// Entries of the Jacobian, column by column: the register, which is an output, or -1: constant.
  std::vector<std::int32_t> entry_register;
  std::vector<double> entry_constant;  ///< values of constant entries, 0 for others
  // For messages; not part of the identity.
  std::vector<Place> places;
  std::vector<std::uint32_t> place_of;  ///< place of each instruction of `linearization`, from 1; 0: unknown

  /// Returns the number of coordinates of all variables.
  int coordinates() const;
  /// Returns the degrees of freedom of all variables.
  int columns() const;
};

inline constexpr int kMostRegisters = 65535;
inline constexpr std::size_t kMostInstructions = std::size_t{1} << 20;
inline constexpr std::size_t kMostEntries = std::size_t{1} << 20;  ///< of the Jacobian

class Tape {
 public:
  /// Checks the code. Throws [slom.bad-tape] if an instruction is unknown, reads a register that has no value, or
  /// writes one that is no result, or if a size is out of bounds.
  explicit Tape(Code code);

  /// Returns the content.
  const Code& code() const { return code_; }
  /// Returns the length of the residual.
  int rows() const { return code_.rows; }
  /// Returns the degrees of freedom of all variables.
  int columns() const { return columns_; }
  /// Returns the number of coordinates of all variables.
  int coordinates() const { return coordinates_; }
  /// Returns the number of columns of data.
  int data() const { return code_.data; }
  /// Returns whether an entry of the Jacobian has the same value for all inputs.
  bool isConstant(int row, int column) const { return registerOf(row, column) < 0; }
  /// Returns whether an entry of the Jacobian is 0 for all inputs.
  bool isZero(int row, int column) const;
  /// Returns the number of measurements that an instruction works on at once.
  int lanes() const { return lanes_; }
  /// Returns a hash of what operator== compares.
  std::uint64_t hash() const { return hash_; }
  /// Returns whether types of variables, code and constants are equal. Places do not count.
  bool operator==(const Tape& other) const;

  /// Inputs of several measurements.
  struct Source {
    const double* const* variables;  ///< for each measurement, the coordinates of each of its variables
    const double* data;              ///< for each measurement, data() numbers
  };
  /// Computes residuals, `rows` numbers a measurement, and unless J is null Jacobians, rows x columns a measurement,
  /// column by column.
  void evaluate(int count, const Source& source, double* r, double* J) const;

 private:
  int registerOf(int row, int column) const {
    return code_.entry_register[static_cast<std::size_t>(column * code_.rows + row)];
  }
  void gather(const Source& source, int first, int count, double* arena) const;

  Code code_;
  std::vector<int> sizes_;      ///< number of coordinates of each variable
  std::vector<int> entry_row_;  ///< row of the arena that holds each entry of the Jacobian
  std::vector<double>
      entries_;  ///< different values of constant entries, in rows of the arena after the registers
  int columns_ = 0, coordinates_ = 0, lanes_ = 0;
  std::uint64_t hash_ = 0;
};

}  // namespace slom::tape
