// Types of values: what Python passes as values of variables and data, how numbers store it, and how a measurement
// function sees it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "slom/model/runtime_type.hpp"
#include "slom/tape/recording.hpp"

namespace slom::python {

namespace nb = nanobind;

/// A number, an array, one of SO2 to SE3, or a class decorated with slom.manifold that has such members.
class ValueType {
 public:
  /// Returns the type of a value. `subject` names it in errors. Throws [slom.bad-value].
  static std::shared_ptr<const ValueType> of(nb::handle value, const std::string& subject);
  /// Returns the type of arrays of this shape; of numbers if it is empty.
  static std::shared_ptr<const ValueType> array(std::vector<std::size_t> shape);

  /// Returns the type for one of the library. Its compounds are objects of types.SimpleNamespace; arrays have one dimension.
  static std::shared_ptr<const ValueType> of(const std::shared_ptr<const RuntimeType>& type);

  /// Appends the numbers that store a value. Throws [slom.bad-value] for a value of another type or shape, or if a number
  /// is not finite.
  void append(nb::handle value, std::vector<double>& numbers, const std::string& subject) const;
  /// Returns the value that these numbers store.
  nb::object value(const double* numbers) const;
  /// Returns the value as a measurement function gets it: a variable's or, without unknowns, a datum's.
  nb::object recorded(const tape::Recording::Input& input) const;

  /// Returns the type in the library.
  const std::shared_ptr<const RuntimeType>& runtime() const { return runtime_; }
  /// Returns how many numbers store a value.
  int coordinates() const { return runtime_->coordinates(); }
  /// Returns whether values are numbers or arrays, and their shape.
  bool isArray() const { return !is_compound_ && kind_ <= RuntimeType::Kind::vector; }
  const std::vector<std::size_t>& shape() const { return shape_; }
  bool operator==(const ValueType& other) const;
  /// Returns the type of a member of a compound or pose and the place of its first number; null if there is none.
  std::pair<std::shared_ptr<const ValueType>, int> member(const std::string& name) const;

 private:
  ValueType() = default;
  void finish();
  static std::shared_ptr<const ValueType> ofFields(const RuntimeType::Field* first, std::size_t count,
                                                   std::size_t depth);
  void appendFields(const std::string& path, std::vector<RuntimeType::Field>& fields) const;
  void appendUnchecked(nb::handle value, std::vector<double>& numbers, const std::string& subject) const;
  template <class S>
  nb::object make(const S*& numbers, const S*& tangent) const;
  nb::object compound(const std::vector<nb::object>& members) const;

  bool is_compound_ = false;
  RuntimeType::Kind kind_ = RuntimeType::Kind::number;
  std::vector<std::size_t> shape_;
  nb::object class_;
  std::vector<std::pair<std::string, std::shared_ptr<const ValueType>>> members_;
  std::shared_ptr<const RuntimeType> runtime_;
};

/// Values of one type, one a row.
struct Rows {
  std::shared_ptr<const ValueType> type;
  std::vector<double> numbers;

  std::size_t size() const { return numbers.size() / static_cast<std::size_t>(type->coordinates()); }
  const double* row(std::size_t i) const {
    return numbers.data() + i * static_cast<std::size_t>(type->coordinates());
  }
};

/// Returns the rows of an array, a list of values, or Rows. Throws [slom.bad-value]. `subject` names them in errors.
Rows rowsOf(nb::handle values, const std::string& subject);
/// Returns rows of numbers or arrays as an array, and others as they are.
nb::object toPython(Rows rows);
/// Returns the whole numbers of an index: a slice, a mask, or numbers, for a sequence of this length. Throws IndexError.
std::vector<std::size_t> indicesOf(nb::handle index, std::size_t size);
/// Returns the place that a single whole number names; nothing for other indices.
std::optional<std::size_t> singleIndexOf(nb::handle index, std::size_t size);

/// Declares Rows.
void bindRows(nb::module_& module);

}  // namespace slom::python
