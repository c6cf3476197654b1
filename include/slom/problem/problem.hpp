/// Problem: the table of variables and measurements. It has the values and measurements by type, their dependences, and
/// what is optimised.
#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <typeindex>
#include <utility>
#include <vector>

#include "slom/model/any_var_id.hpp"
#include "slom/model/group.hpp"
#include "slom/model/index_set.hpp"
#include "slom/model/meas_id.hpp"
#include "slom/model/pimpl.hpp"
#include "slom/model/runtime_type.hpp"
#include "slom/problem/change_log.hpp"
#include "slom/problem/typed_pool.hpp"

namespace slom {

class GroupTable;

class Problem {
 public:
  Problem();
  ~Problem();
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  /// Copies all of another problem into this one, which must be empty. This problem then accepts the present handles of
  /// the other one. If it throws [slom.not-copyable], this problem must not be used.
  void copyFrom(const Problem& other);

  // Variables.

  /// Adds a variable with its start value; `optimize` false fixes it. `name` may be empty.
  template <class T>
  VarID<T> insertVariable(const T& value, bool optimize, std::string_view name) {
    mtk::requireManifold<T>();
    return VarID<T>(insertVariable(typeid(T), &makeVariableStore<T>, &value, optimize, name));
  }
  /// Adds a variable of a type that is described at run time. `value`: its numbers, type->coordinates() of them.
  VariableHandle insertVariable(const std::shared_ptr<const RuntimeType>& type, const double* value,
                                bool optimize, std::string_view name);
  /// Returns the index of the variable in the table. Throws [slom.stale-handle] if it is not in this problem.
  template <class T>
  int indexOf(const VarID<T>& id) const {
    return checkedIndex(id.store_.get(), id.ref_, &slom::typeName<T>);
  }
  /// Returns the index for a handle to a variable of any type.
  int indexOf(const VariableHandle& id) const;
  /// Returns the handle of a variable of the table.
  VariableHandle handleOf(int variable) const;
  /// Returns this problem's handle for a handle of the problem that it is a copy of. Returns its own handles unchanged.
  /// Throws as indexOf does.
  template <class T>
  VarID<T> own(const VarID<T>& id) const {
    return VarID<T>(handleOf(indexOf(id)));
  }
  AnyVarID own(const AnyVarID& id) const { return AnyVarID(handleOf(indexOf(id))); }
  template <class M>
  MeasID<M> own(const MeasID<M>& id) const {
    const auto [pool, i] = locate(id);
    return MeasID<M>(handleOf(*pool, pool->handleOf(i)));
  }
  AnyMeasID own(const AnyMeasID& id) const {
    const auto [pool, i] = locate(id);
    return AnyMeasID(handleOf(*pool, pool->handleOf(i)));
  }
  /// Sets the value of a variable. Throws [slom.stale-handle], [slom.size-change] or [slom.outside-bound].
  template <class T>
  void setValue(const VarID<T>& id, const T& value) {
    setValue(indexOf(id), &value);
  }
  /// Sets the value of a variable, of its type.
  void setValue(int variable, const void* value);
  /// Sets the value of a variable without any check.
  void overwrite(int variable, const void* value);
  /// Fixes a variable at its current value, or releases it.
  void setOptimized(int variable, bool optimize);
  /// Returns the components whose names are `path` or below it: `pos.z`, `pos`. Throws [slom.no-component], which lists
  /// all names.
  std::vector<int> componentsAt(int variable, const std::string& path) const;
  /// Returns these components for a prior with these values, one for each. The components must be coordinates, to which
  /// [+] adds. Throws [slom.no-component], [slom.wrong-length] or [slom.prior-not-finite].
  std::vector<int> coordinatesAt(int variable, const std::string& path, const double* values,
                                 std::size_t count) const;
  /// Fixes components at their current values, or releases them.
  void setFixed(int variable, const std::vector<int>& components, bool is_fixed);
  /// Limits the coordinates of components; infinite: no limit. Throws [slom.bad-bound] or [slom.outside-bound].
  void setBound(int variable, const std::vector<int>& components, double lower, double upper);
  /// Returns the variables and components that do not move.
  const ActiveSet& activeSet() const { return active_; }
  /// Returns the active set for activating bounds.
  ActiveSet& activeSet() { return active_; }
  /// Returns the degrees of freedom of optimised variables without fixed components, including components at a bound.
  int freeCount() const;
  /// Removes a variable. Throws [slom.variable-in-use] if measurements depend on it.
  void removeVariable(int variable);

  /// Returns the table of variables. Rows of removed variables are reused.
  const std::vector<VariableRecord>& variables() const { return table_; }
  /// Returns one store for each type that variables have or had.
  std::vector<std::shared_ptr<const VariableStoreBase>> stores() const;
  /// Returns the number of present variables.
  int variableCount() const { return static_cast<int>(table_.size() - free_.size()); }
  /// Returns the user's name, or text such as `SE3 #5`: type and running number of insertion.
  std::string variableName(int variable) const;
  /// Returns the value as text, for messages.
  std::string variableValue(int variable) const;
  /// Returns the names of the components, with the variable's name in front.
  std::vector<std::string> componentNames(int variable) const;

  // Measurements.

  /// Adds a measurement. `label`: name of the group; empty: the name of the type.
  template <Measurement M>
  MeasID<M> insertMeasurement(M measurement, const NoiseView& noise, std::string_view label = {},
                              const Loss& loss = {}) {
    const auto variables = measurement.variableArgs();
    const auto [pool, ref] =
        insertMeasurement(TypedPool<M>::type, &measurement, variables.all.data(), noise, label, loss);
    return MeasID<M>(handleOf(*pool, ref));
  }
  /// Adds a measurement of a run-time kind.
  template <std::derived_from<RuntimeMeasurement> M>
  MeasID<M> insertMeasurement(M measurement, const NoiseView& noise, std::string_view label = {},
                              const Loss& loss = {}) {
    const auto [pool, ref] = insertRuntime(new M(std::move(measurement)), noise, label, loss);
    return MeasID<M>(handleOf(*pool, ref));
  }
  /// Adds a measurement of this type, whose pool moves from `measurement`. `arguments`: its variables, type.arity of them.
  template <class M>
  MeasID<M> insertOfType(const MeasurementType& type, M& measurement, VariableArgument* const* arguments,
                         const NoiseView& noise, std::string_view label, const Loss& loss) {
    const auto [pool, ref] = insertMeasurement(type, &measurement, arguments, noise, label, loss);
    return MeasID<M>(handleOf(*pool, ref));
  }
  /// Returns the pool of a measurement and its index there. Throws [slom.stale-handle].
  std::pair<MeasurementPool*, int> locate(const MeasurementHandle& id) const;
  /// Removes measurement i of the pool; the last measurement takes its place.
  void removeMeasurement(MeasurementPool& pool, int i);
  /// Multiplies the stated standard deviations by positive factors, given by pool and measurement.
  void scaleSigmas(const std::vector<std::vector<double>>& factors);
  /// Sets the weight of measurements to 0 until restoreNoise(); `is_withheld` by pool and measurement. Throws only
  /// std::bad_alloc, with nothing changed.
  std::vector<MeasurementPool::SavedNoise> withhold(const std::vector<std::vector<char>>& is_withheld);
  /// Restores the noise after withhold(), to the last bit.
  void restoreNoise(std::vector<MeasurementPool::SavedNoise> noise) noexcept;
  /// Puts measurement i into these groups, of different dimensions.
  void assignGroups(MeasurementPool& pool, int i, const Group* groups, int count);
  /// Returns the names of the groups of measurements that may share errors; null if no measurement ever was in a group.
  const GroupTable* groups() const { return groups_ ? &*groups_ : nullptr; }
  /// Calls f(pool, i) for each measurement that depends on the variable. The first call searches all measurements. From
  /// then on the table is kept up to date, and a call takes time proportional to the number of measurements found.
  template <class F>
  void forEachUse(int variable, const F& f) const {
    for (const Use& use : usesOf(variable)) f(*use.pool, use.pool->indexOfPresent(use.ref));
  }
  /// Returns the variables of a measurement and their values: `pose[3] = (1 2 0.5), pose[4] = (...)`.
  std::string valuesText(const int* variables, int arity) const;
  /// Throws [slom.measurement-threw], which names the measurement. The user's exception is nested in it.
  [[noreturn]] void raiseThrew(const std::string& measurement, const int* variables, int arity,
                               const std::exception_ptr& exception) const;
  [[noreturn]] void raiseThrew(const MeasurementPool& pool, const MeasurementThrew& event) const {
    raiseThrew(pool.measurementName(event.measurement), pool.variables(event.measurement), pool.arity(),
               event.exception);
  }
  /// Returns f(), which runs functions of measurements of the pool. If they throw, raises the exception with the
  /// measurement's name.
  template <class F>
  decltype(auto) naming(const MeasurementPool& pool, const F& f) const {
    try {
      return f();
    } catch (const MeasurementThrew& event) {
      raiseThrew(pool, event);
    }
  }
  /// Returns the pools of measurements of type M: one for each label (and arity, for run-time kinds); none if no such
  /// measurement was ever inserted.
  template <class M>
  std::vector<const MeasurementPool*> poolsOf() const {
    return findPools(typeid(M));
  }
  /// Returns one pool for each type and label of measurements, in the order of their first insertion.
  const std::vector<std::unique_ptr<MeasurementPool>>& pools() const { return pools_; }
  /// Returns whether any derivatives are differences.
  bool hasNumericDerivatives() const;
  /// Returns the largest relative step that slom::differences states; 0: none.
  double largestStatedStep() const;
  /// Returns the number of groups of pools; see MeasurementPool::group.
  int groupCount() const { return group_count_; }

  /// Returns the values at which Jacobians are taken for variables that priors with first estimates depend on. These
  /// values exist as long as the priors. If two priors set the value of one variable, the earlier prior counts.
  const FirstEstimates& firstEstimates() const { return first_estimates_; }
  /// Returns the value at which Jacobians are taken: the first estimate or, if there is none, the current value.
  const void* linearizationPoint(int variable) const;

  // All values together.

  /// Saves all values for `restore`.
  void save();
  /// Restores the values of the last `save`.
  void restore();
  /// Computes x := x [+] d for one variable.
  void move(int variable, const double* d);
  /// Computes x := x [+] step[offset[v] ...] for each variable v with offset[v] < offset[v + 1].
  void applyStep(const std::vector<int>& offset, const double* step);

  // Changes.

  /// Returns a number that changes with every insertion, removal, fixing and releasing.
  std::uint64_t structureRevision() const { return changes_.revision(); }
  /// Returns the events since a structureRevision(); none if they are forgotten.
  std::optional<std::span<const Change>> changesSince(std::uint64_t structure_revision) const;
  /// Returns a number that changes whenever a value changes, or what may move of it.
  std::uint64_t valueRevision() const { return moves_.revision(); }
  /// Returns the variables whose values changed since a valueRevision(), one for each change, or kAll for all of them;
  /// none if the changes are forgotten.
  std::optional<std::span<const int>> movedSince(std::uint64_t value_revision) const;
  static constexpr int kAll = -1;
  /// Returns how far the variable has moved since it was inserted: the sum over all moves of the largest component, in
  /// its tangent space. The difference of two readings bounds the distance between the two values. A step that is
  /// undone no longer counts. The result is infinite after a move without a length.
  double travelled(int variable) const { return travelled_[static_cast<std::size_t>(variable)]; }

 private:
  /// A store that a store of this problem is a copy of, and its content at the time of the copy.
  struct StoreOrigin {
    std::weak_ptr<const VariableStoreBase> store;
    std::vector<std::uint32_t> generations;
  };
  struct TypedStore {
    std::type_index type;
    std::shared_ptr<VariableStoreBase> store;
    std::vector<StoreOrigin> origins{};
  };
  // Code about containers, compiled once and not in every file that inserts something.
  VariableHandle insertVariable(std::type_index type, VariableStoreBase* (*make)(), const void* value,
                                bool optimize, std::string_view name);
  VariableHandle insertInto(const std::shared_ptr<VariableStoreBase>& store, const void* value, bool optimize,
                            std::string_view name);
  /// Inserts `measurement`, which is of this type and is moved from. `arguments` are its variables.
  std::pair<MeasurementPool*, SlotRef> insertMeasurement(const MeasurementType& type, void* measurement,
                                                         VariableArgument* const* arguments,
                                                         const NoiseView& noise, std::string_view label,
                                                         const Loss& loss);
  /// Inserts the measurement and takes ownership from the start.
  std::pair<MeasurementPool*, SlotRef> insertRuntime(RuntimeMeasurement* measurement, const NoiseView& noise,
                                                     std::string_view label, const Loss& loss);
  /// A measurement by pool and slot.
  struct Use {
    MeasurementPool* pool;
    SlotRef ref;
  };
  struct Uses;
  /// Returns the measurements that depend on a variable, in unspecified order.
  const std::vector<Use>& usesOf(int variable) const;
  void noteUse(MeasurementPool* pool, SlotRef ref, const int* variables, int arity) const;
  /// Returns a pool. Pools of run-time kinds also differ in arity; 0: the first one of any arity.
  MeasurementPool* findPool(const MeasurementType& type, std::string_view label, int arity) const;
  MeasurementPool* addPool(const MeasurementType& type, std::string_view label);
  void removeLastPool();
  std::vector<const MeasurementPool*> findPools(std::type_index type) const;
  void setFirstEstimate(int variable, const void* point);
  void takeFirstEstimates(const RuntimeMeasurement& measurement, const int* variables);
  void dropFirstEstimates(const RuntimeMeasurement& measurement, const int* variables);
  void registerConstraint(int variable);
  double distanceTo(int variable, const void* value) const;
  /// Returns the number of variables and measurements, which limits the length of the logs.
  std::size_t size() const { return table_.size() + measurement_count_; }
  void checkBounds(int variable, const std::vector<ComponentBound>& bounds, const void* value) const;
  void copyStores(const Problem& other);
  void copyPools(const Problem& other);
  int reserveVariable();
  void registerVariable(int index, VariableRecord record, bool optimize);
  int checkedIndex(const VariableStoreBase* store, SlotRef ref, std::string (*type)()) const;
  static MeasurementHandle handleOf(const MeasurementPool& pool, SlotRef ref);
  /// Returns the name, followed by a number if another pool has it already.
  std::string nameForPool(const std::string& name) const;

  std::vector<VariableRecord> table_;
  std::vector<int> free_;
  ActiveSet active_;
  FirstEstimates first_estimates_;
  mutable detail::Pimpl<Uses> uses_;   // measurements of each variable; made at the first query
  std::vector<int> variables_of_new_;  // variables of the measurement that is being inserted
  std::vector<TypedStore> stores_;
  std::vector<std::unique_ptr<MeasurementPool>> pools_;
  int group_count_ = 0;
  detail::Pimpl<GroupTable> groups_;
  long inserted_ = 0;
  std::size_t measurement_count_ = 0;
  ChangeLog<Change> changes_;
  ChangeLog<int> moves_;
  std::vector<double> travelled_, saved_travelled_;       // by variable
  mutable std::uint64_t counted_at_ = ~std::uint64_t{0};  // structure revision of free_count_
  mutable int free_count_ = 0;
};

}  // namespace slom
