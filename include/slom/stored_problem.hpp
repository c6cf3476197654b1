/// StoredProblem: a problem loaded from an archive; and how an archive writes and reads each type. See
/// slom/archive.hpp.
#pragma once

#include <iosfwd>
#include <memory>
#include <string>
#include <typeindex>
#include <vector>

#include "slom/estimator.hpp"
#include "slom/tape/input.hpp"

namespace slom {

class ArchiveReader;

/// A loaded problem.
class StoredProblem {
 public:
  Estimator estimator;

  /// Returns the first variable of this name. Throws [slom.no-variable] if there is none or if it has another type.
  template <class T>
  VarID<T> variable(const std::string& name) const {
    return VarID<T>(handle(name, typeid(VariableStore<T>), &typeName<T>));
  }
  /// Returns the first variable of this name, of any type. Throws [slom.no-variable].
  AnyVarID variable(const std::string& name) const { return AnyVarID(entryNamed(name).handle); }
  /// Returns all variables of a type, in the order of insertion.
  template <class T>
  std::vector<VarID<T>> variables() const {
    std::vector<VarID<T>> ids;
    for (const Entry& entry : entries_) {
      if (entry.type == typeid(VariableStore<T>)) ids.push_back(VarID<T>(entry.handle));
    }
    return ids;
  }
  /// Returns all variables in the order of insertion.
  std::vector<AnyVarID> variables() const {
    std::vector<AnyVarID> ids;
    for (const Entry& entry : entries_) ids.emplace_back(entry.handle);
    return ids;
  }

 private:
  friend class Archive;
  friend class ArchiveReader;
  struct Entry {
    std::string name;
    std::type_index type;  // type of its store
    VariableHandle handle;
  };
  const Entry& entryNamed(const std::string& name) const;
  VariableHandle handle(const std::string& name, std::type_index type, std::string (*type_name)()) const;
  void sortNames();

  std::vector<Entry> entries_;
  std::vector<int> by_name_;  // numbers of entries, sorted by name; equal names in the order of insertion
};

namespace detail {

/// A type of variables as tapes see it.
struct TracedType {
  std::type_index type;
  tape::VariableType parts;
  tape::Layout layout;
};

/// Returns the parts of T in `traced` and whether tapes can have variables of this type.
template <class T>
bool describe(TracedType& traced) {
  if constexpr (mtk::DOF_v<T> == mtk::Dynamic) {
    return false;
  } else {
    const T x{};
    bool is_known = true;
    traced.parts.name = typeName<T>();
    mtk::detail::forEachBasicPart(x, x, 0, [&](const auto& part, const auto&, int) {
      if constexpr (tape::detail::is_known_part<std::remove_cvref_t<decltype(part)>>) {
        traced.parts.parts.push_back(tape::detail::partOf(part));
        tape::detail::appendLayout(x, part, traced.layout);
      } else {
        is_known = false;
      }
    });
    traced.type = typeid(T);
    return is_known;
  }
}

/// Functions that write and read variables of one type. They get the StoredVariable that they are called of.
struct StoredVariable {
  std::string name;
  std::type_index type;  ///< type of their store
  void (*write)(const StoredVariable&, std::ostream&, const void* value);
  /// Reads a value and returns whether the stream has one. Inserts the value if there is a problem.
  bool (*read)(const StoredVariable&, std::istream&, Problem*, bool optimize, const std::string& name,
               VariableHandle& id);
  /// Reads a value and returns whether the stream has one. Calls take(context, value, its degrees of freedom).
  bool (*read_value)(const StoredVariable&, std::istream&, void* context,
                     void (*take)(void*, const void*, int));
  /// Returns whether tapes can have variables of this type, and what they see.
  bool (*describe)(const StoredVariable&, TracedType&);
  std::shared_ptr<const RuntimeType> runtime_type{};  ///< null for registered types
  tape::Layout layout{};                              ///< where the numbers of runtime_type lie in a value
};

/// The variables of a measurement to be written or read.
struct StoredArguments {
  const VariableHandle* handles = nullptr;       ///< null while a text is checked
  const StoredVariable* const* kinds = nullptr;  ///< set only for measurements over a list of variables
  int count = 0;
};

/// The options of a measurement, stored beside its data.
struct StoredOptions {
  NoiseView noise;
  std::string label;
  Loss loss;
};

/// Functions that write and read measurements of one type.
struct StoredMeasurement {
  std::string name;
  std::type_index type;
  std::vector<std::type_index> variables;  ///< their stores
  /// If true, the measurement takes any number of variables of any types instead of `variables`.
  bool is_list;
  void (*write)(std::ostream&, const StoredArguments&, const MeasurementPool&, int i);
  /// Reads the data of a measurement and returns whether the stream has them. Inserts the measurement if there is a
  /// problem.
  bool (*read)(std::istream&, Problem*, const StoredArguments&, const StoredOptions&);
};

template <class... Args>
inline constexpr bool begins_with_list = false;
template <class... Data>
inline constexpr bool begins_with_list<std::vector<AnyVarID>, Data...> = true;

}  // namespace detail

/// Functions that write and read GaussianPriors.
class StoredPrior {
 public:
  /// Returns the name of the kind in archives.
  static std::string name() { return "GaussianPrior"; }
  /// Writes prior i of the pool.
  static void write(std::ostream&, const detail::StoredArguments&, const MeasurementPool&, int i);
  /// Reads a prior and returns whether the stream has one. Inserts the prior if there is a problem.
  static bool read(std::istream&, Problem*, const detail::StoredArguments&, const detail::StoredOptions&);
};

}  // namespace slom
