/// RuntimeType: a type of variables that is described while the program runs, such as one declared in Python or read
/// from a file.
///     const auto camera = slom::RuntimeType::make("Camera", {{"pose", slom::RuntimeType::Kind::se3},
///                                                            {"focal", slom::RuntimeType::Kind::number}});
///     const slom::AnyVarID left = est.insertRV(slom::RuntimeValue{camera, {0, 0, 0, 0, 0, 0, 1, 800}}, true, "left");
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom {

class VariableHandle;

class RuntimeType {
 public:
  /// Kinds of fields and the numbers that store them.
  enum class Kind : std::uint8_t {
    number,  ///< itself
    vector,  ///< its entries
    so2,     ///< the angle [rad]
    so3,     ///< the unit quaternion (x, y, z, w)
    s2,      ///< the unit vector
    se2,     ///< position, angle
    se3,     ///< position, quaternion
  };
  /// A named part of the type.
  struct Field {
    std::string name;  ///< in messages: `pose` or `left.pose`; empty for a type of one field
    Kind kind = Kind::number;
    int size = 1;  ///< number of entries of a vector
    bool operator==(const Field&) const = default;
  };
  /// Where a field lies.
  struct Place {
    int coordinate = 0;  ///< its first number
    int component = 0;   ///< its first degree of freedom
  };

  /// Returns the type with this name and these fields. Equal types are the same object. Throws [slom.bad-type] for a
  /// type without fields, with a vector of less than one entry, or with more than 65535 numbers.
  static std::shared_ptr<const RuntimeType> make(std::string name, std::vector<Field> fields);
  /// Returns the type of a variable; null if its type is one of C++.
  static std::shared_ptr<const RuntimeType> of(const VariableHandle& id);

  /// Returns the name.
  const std::string& name() const { return name_; }
  /// Returns the fields in their order.
  const std::vector<Field>& fields() const { return fields_; }
  /// Returns the place of each field.
  const std::vector<Place>& places() const { return places_; }
  /// Returns how many numbers store a value.
  int coordinates() const { return end_.coordinate; }
  /// Returns the degrees of freedom.
  int dof() const { return end_.component; }
  /// Returns how many numbers store a field.
  static int coordinatesOf(const Field& field);
  /// Returns the degrees of freedom of a field.
  static int dofOf(const Field& field);
  /// Returns the value of these numbers: quaternions and directions with length 1, angles in [-pi, pi). Throws
  /// [slom.wrong-length], [slom.bad-value] for a number that is not finite, [mtk.no-rotation] or [mtk.no-direction].
  std::vector<double> normalized(std::vector<double> numbers) const;

 private:
  RuntimeType(std::string name, std::vector<Field> fields);

  std::string name_;
  std::vector<Field> fields_;
  std::vector<Place> places_;
  Place end_;
};

/// A value of such a type.
struct RuntimeValue {
  std::shared_ptr<const RuntimeType> type;
  std::vector<double> numbers;  ///< type->coordinates() of them
};

}  // namespace slom
