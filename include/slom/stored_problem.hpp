/// A problem that an archive has loaded, and how an archive writes and reads each type; see slom/archive.hpp.
#pragma once

#include <iosfwd>
#include <string>
#include <typeindex>
#include <vector>

#include "slom/estimator.hpp"

namespace slom {

class ArchiveReader;

/// A problem that was loaded.
class StoredProblem {
 public:
  Estimator estimator;

  /// The first variable of this name. Throws [slom.no-variable], also when it is of another type.
  template <class T>
  VarID<T> variable(const std::string& name) const {
    return VarID<T>(handle(name, typeid(VariableStore<T>), &typeName<T>));
  }
  /// All variables of a type, in the order of their insertion.
  template <class T>
  std::vector<VarID<T>> variables() const {
    std::vector<VarID<T>> ids;
    for (const Entry& entry : entries_) {
      if (entry.type == typeid(VariableStore<T>)) ids.push_back(VarID<T>(entry.handle));
    }
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
  VariableHandle handle(const std::string& name, std::type_index type, std::string (*type_name)()) const;
  void sortNames();

  std::vector<Entry> entries_;
  std::vector<int> by_name_;  // numbers of entries, those of the same name in the order of insertion
};

namespace detail {

/// How variables of one type are written and read.
struct StoredVariable {
  std::string name;
  std::type_index type;  ///< type of their store
  void (*write)(std::ostream&, const void* value);
  /// Whether the stream has a value, which is inserted unless there is no problem.
  bool (*read)(std::istream&, Problem*, bool optimize, const std::string& name, VariableHandle& id);
  /// Whether the stream has a value, with which take(context, value, its degrees of freedom) is called.
  bool (*read_value)(std::istream&, void* context, void (*take)(void*, const void*, int));
};

/// The variables of a measurement that is written or read.
struct StoredArguments {
  const VariableHandle* handles = nullptr;       ///< null while a text is checked
  const StoredVariable* const* kinds = nullptr;  ///< only for measurements over a list of variables
  int count = 0;
};

/// What stands beside the data of a measurement.
struct StoredOptions {
  NoiseView noise;
  std::string label;
  Loss loss;
};

/// How measurements of one type are written and read.
struct StoredMeasurement {
  std::string name;
  std::type_index type;
  std::vector<std::type_index> variables;  ///< their stores
  bool is_list;                            ///< any number of variables of any types in place of these
  void (*write)(std::ostream&, const StoredArguments&, const MeasurementPool&, int i);
  /// Whether the stream has data, of which a measurement is made unless there is no problem.
  bool (*read)(std::istream&, Problem*, const StoredArguments&, const StoredOptions&);
};

template <class... Args>
inline constexpr bool begins_with_list = false;
template <class... Data>
inline constexpr bool begins_with_list<std::vector<AnyVarID>, Data...> = true;

}  // namespace detail

/// How GaussianPriors are written and read.
class StoredPrior {
 public:
  /// The name of the kind in archives.
  static std::string name() { return "GaussianPrior"; }
  /// Writes prior i of the pool.
  static void write(std::ostream&, const detail::StoredArguments&, const MeasurementPool&, int i);
  /// Whether the stream has a prior, which is inserted unless there is no problem.
  static bool read(std::istream&, Problem*, const detail::StoredArguments&, const detail::StoredOptions&);
};

}  // namespace slom
