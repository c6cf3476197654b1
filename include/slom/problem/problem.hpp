/// The variable and measurement table: values and measurements by type, who depends on whom, what is optimised.
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

#include "slom/model/group.hpp"
#include "slom/model/index_set.hpp"
#include "slom/model/meas_id.hpp"
#include "slom/model/pimpl.hpp"
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

  /// Copies all of another problem into this one, which is empty. Handles of the other one, as it is now, are accepted by this one.
  /// Throws [slom.not-copyable], after which this one is not to be used.
  void copyFrom(const Problem& other);

  // Variables.

  /// Adds a variable with its start value; `optimize` false fixes it. `name` may be empty.
  template <class T>
  VarID<T> insertVariable(const T& value, bool optimize, std::string_view name) {
    mtk::requireManifold<T>();
    return VarID<T>(insertVariable(typeid(T), &makeVariableStore<T>, &value, optimize, name));
  }
  /// Index of the variable in the table; throws [slom.stale-handle] when it is not in this problem.
  template <class T>
  int indexOf(const VarID<T>& id) const {
    return checkedIndex(id.store_.get(), id.ref_, &slom::typeName<T>);
  }
  /// The same of a handle to a variable of any type.
  int indexOf(const VariableHandle& id) const;
  /// The handle of a variable, in the table.
  VariableHandle handleOf(int variable) const;
  /// This problem's handle for one of the problem that it is a copy of; its own ones as they are. Throws as indexOf does.
  template <class T>
  VarID<T> own(const VarID<T>& id) const {
    return VarID<T>(handleOf(indexOf(id)));
  }
  template <class M>
  MeasID<M> own(const MeasID<M>& id) const {
    const auto [pool, i] = locate(id);
    return MeasID<M>(handleOf(*pool, pool->handleOf(i)));
  }
  AnyMeasID own(const AnyMeasID& id) const {
    const auto [pool, i] = locate(id);
    return AnyMeasID(handleOf(*pool, pool->handleOf(i)));
  }
  /// Gives a variable another value. Throws [slom.stale-handle], [slom.size-change] or [slom.outside-bound].
  template <class T>
  void setValue(const VarID<T>& id, const T& value) {
    setValue(indexOf(id), &value);
  }
  /// The same without any check.
  void overwrite(int variable, const void* value);
  /// Fixes a variable at its current value, or releases it.
  void setOptimized(int variable, bool optimize);
  /// The components whose names are `path` or begin with it: `pos.z`, `pos`. Throws [slom.no-component], which lists all names.
  std::vector<int> componentsAt(int variable, const std::string& path) const;
  /// The same of components that are coordinates, to which [+] adds, for a prior with these values, one for each. Throws
  /// [slom.no-component], [slom.wrong-length] or [slom.prior-not-finite].
  std::vector<int> coordinatesAt(int variable, const std::string& path, const double* values,
                                 std::size_t count) const;
  /// Fixes components at their current values, or releases them.
  void setFixed(int variable, const std::vector<int>& components, bool is_fixed);
  /// Limits the coordinates of components; infinite: not. Throws [slom.bad-bound] or [slom.outside-bound].
  void setBound(int variable, const std::vector<int>& components, double lower, double upper);
  /// The variables and components that do not move.
  const ActiveSet& activeSet() const { return active_; }
  /// The same, for activating bounds.
  ActiveSet& activeSet() { return active_; }
  /// Degrees of freedom of optimised variables that are not fixed, whether or not they are at a bound.
  int freeCount() const;
  /// Throws [slom.variable-in-use] when measurements depend on it.
  void removeVariable(int variable);

  /// The table of variables; removed ones leave rows that are used again.
  const std::vector<VariableRecord>& variables() const { return table_; }
  /// One for each type of which there are or have been variables.
  std::vector<std::shared_ptr<const VariableStoreBase>> stores() const;
  /// The number of variables that are there.
  int variableCount() const { return static_cast<int>(table_.size() - free_.size()); }
  /// The user's name, or `SE3 #5`: type and running number of insertion.
  std::string variableName(int variable) const;
  /// The value as text, for messages.
  std::string variableValue(int variable) const;
  /// Names of the components, the variable's own name in front.
  std::vector<std::string> componentNames(int variable) const;

  // Measurements.

  /// `label`: name of the group, empty for the type's own.
  template <Measurement M>
  MeasID<M> insertMeasurement(M measurement, const NoiseView& noise, std::string_view label = {},
                              const Loss& loss = {}) {
    const auto variables = measurement.variableArgs();
    const auto [pool, ref] =
        insertMeasurement(TypedPool<M>::type, &measurement, variables.all.data(), noise, label, loss);
    return MeasID<M>(handleOf(*pool, ref));
  }
  /// The same of a run-time kind.
  template <std::derived_from<RuntimeMeasurement> M>
  MeasID<M> insertMeasurement(M measurement, const NoiseView& noise, std::string_view label = {},
                              const Loss& loss = {}) {
    const auto [pool, ref] = insertRuntime(new M(std::move(measurement)), noise, label, loss);
    return MeasID<M>(handleOf(*pool, ref));
  }
  /// The pool of a measurement and its index there. Throws [slom.stale-handle].
  std::pair<MeasurementPool*, int> locate(const MeasurementHandle& id) const;
  /// Removes measurement i of the pool; the last one takes its place.
  void removeMeasurement(MeasurementPool& pool, int i);
  /// Multiplies the stated standard deviations: factors by pool and measurement, positive.
  void scaleSigmas(const std::vector<std::vector<double>>& factors);
  /// Gives measurements no weight until restoreNoise(): `is_withheld` by pool and measurement. Throws nothing but std::bad_alloc, with nothing
  /// changed.
  std::vector<MeasurementPool::SavedNoise> withhold(const std::vector<std::vector<char>>& is_withheld);
  /// Takes that back, to the last bit.
  void restoreNoise(std::vector<MeasurementPool::SavedNoise> noise) noexcept;
  /// Puts measurement i into these groups, of different dimensions.
  void assignGroups(MeasurementPool& pool, int i, const Group* groups, int count);
  /// Names of the groups of measurements that may share errors; null: no measurement ever was in one.
  const GroupTable* groups() const { return groups_ ? &*groups_ : nullptr; }
  /// Calls f(pool, i) for each measurement that depends on the variable. The first call looks through all measurements; from then on
  /// the table is kept, and a call takes time in proportion to what it finds.
  template <class F>
  void forEachUse(int variable, const F& f) const {
    for (const Use& use : usesOf(variable)) f(*use.pool, use.pool->indexOfPresent(use.ref));
  }
  /// `pose[3] = (1 2 0.5), pose[4] = (...)`: the variables of a measurement and their values.
  std::string valuesText(const int* variables, int arity) const;
  /// Throws [slom.measurement-threw], which names the measurement; the user's own exception is nested in it.
  [[noreturn]] void raiseThrew(const std::string& measurement, const int* variables, int arity,
                               const std::exception_ptr& exception) const;
  [[noreturn]] void raiseThrew(const MeasurementPool& pool, const MeasurementThrew& event) const {
    raiseThrew(pool.measurementName(event.measurement), pool.variables(event.measurement), pool.arity(),
               event.exception);
  }
  /// f(), which runs functions of measurements of the pool; what they throw is raised with the measurement's name.
  template <class F>
  decltype(auto) naming(const MeasurementPool& pool, const F& f) const {
    try {
      return f();
    } catch (const MeasurementThrew& event) {
      raiseThrew(pool, event);
    }
  }
  /// The pools of measurements of type M: one for each label (and arity, of run-time kinds), none when none was ever inserted.
  template <class M>
  std::vector<const MeasurementPool*> poolsOf() const {
    return findPools(typeid(M));
  }
  /// One for each type and label of measurements, in the order in which they came first.
  const std::vector<std::unique_ptr<MeasurementPool>>& pools() const { return pools_; }
  /// Whether any derivatives are differences.
  bool hasNumericDerivatives() const;
  /// The largest relative step that slom::differences states; 0: none.
  double largestStatedStep() const;
  /// Number of groups of pools; see MeasurementPool::group.
  int groupCount() const { return group_count_; }

  /// The values at which Jacobians are taken of the measurements of variables that priors with first estimates depend on. They come and
  /// go with these priors; of two for one variable, that of the earlier one counts.
  const FirstEstimates& firstEstimates() const { return first_estimates_; }
  /// The value at which Jacobians are taken: the first estimate or, without one, the current value.
  const void* linearizationPoint(int variable) const;

  // Values as a whole.

  /// Remembers all values; `restore` brings them back.
  void save();
  /// Brings back the values that `save` has remembered.
  void restore();
  /// x := x [+] d of one variable.
  void move(int variable, const double* d);
  /// x := x [+] step[offset[v] ...] for each variable v with offset[v] < offset[v + 1].
  void applyStep(const std::vector<int>& offset, const double* step);

  // Changes.

  /// Changes with every insertion, removal, fixing and releasing.
  std::uint64_t structureRevision() const { return changes_.revision(); }
  /// The events since a structureRevision(); none when they are forgotten.
  std::optional<std::span<const Change>> changesSince(std::uint64_t structure_revision) const;
  /// Changes whenever a value does, or what may move of it.
  std::uint64_t valueRevision() const { return moves_.revision(); }
  /// Variables whose values changed since a valueRevision(), one for each change, or kAll for all of them; none when that is forgotten.
  std::optional<std::span<const int>> movedSince(std::uint64_t value_revision) const;
  static constexpr int kAll = -1;
  /// How far the variable has moved since it was inserted: the sum over all its moves of their largest component, in its tangent space.
  /// What two readings differ by bounds how far the value is from where it was. A step that is taken back counts no more; infinite once
  /// a move had no length.
  double travelled(int variable) const { return travelled_[static_cast<std::size_t>(variable)]; }

 private:
  /// A store that one of this problem is a copy of, and what was in it when it was copied.
  struct StoreOrigin {
    std::weak_ptr<const VariableStoreBase> store;
    std::vector<std::uint32_t> generations;
  };
  struct TypedStore {
    std::type_index type;
    VariableStoreBase* (*make)();
    std::shared_ptr<VariableStoreBase> store;
    std::vector<StoreOrigin> origins{};
  };
  // What concerns containers is compiled once, not in every file that inserts something.
  VariableHandle insertVariable(std::type_index type, VariableStoreBase* (*make)(), const void* value,
                                bool optimize, std::string_view name);
  void setValue(int variable, const void* value);
  /// `measurement` is of this type and is moved from; `arguments` are its variables.
  std::pair<MeasurementPool*, SlotRef> insertMeasurement(const MeasurementType& type, void* measurement,
                                                         VariableArgument* const* arguments,
                                                         const NoiseView& noise, std::string_view label,
                                                         const Loss& loss);
  /// Owns the measurement from the start.
  std::pair<MeasurementPool*, SlotRef> insertRuntime(RuntimeMeasurement* measurement, const NoiseView& noise,
                                                     std::string_view label, const Loss& loss);
  /// A measurement, wherever it lies.
  struct Use {
    MeasurementPool* pool;
    SlotRef ref;
  };
  struct Uses;
  /// The measurements that depend on a variable, in unspecified order.
  const std::vector<Use>& usesOf(int variable) const;
  void noteUse(MeasurementPool* pool, SlotRef ref, const int* variables, int arity) const;
  /// Pools of run-time kinds differ in arity, too; 0: the first of any arity.
  MeasurementPool* findPool(std::type_index type, std::string_view label, int arity) const;
  MeasurementPool* addPool(const MeasurementType& type, std::string_view label);
  void removeLastPool();
  std::vector<const MeasurementPool*> findPools(std::type_index type) const;
  void setFirstEstimate(int variable, const void* point);
  void takeFirstEstimates(const RuntimeMeasurement& measurement, const int* variables);
  void dropFirstEstimates(const RuntimeMeasurement& measurement, const int* variables);
  void registerConstraint(int variable);
  double distanceTo(int variable, const void* value) const;
  /// The number of variables and measurements, which limits the length of the logs.
  std::size_t size() const { return table_.size() + measurement_count_; }
  void checkBounds(int variable, const std::vector<ComponentBound>& bounds, const void* value) const;
  void copyStores(const Problem& other);
  void copyPools(const Problem& other);
  int reserveVariable();
  void registerVariable(int index, VariableRecord record, bool optimize);
  int checkedIndex(const VariableStoreBase* store, SlotRef ref, std::string (*type)()) const;
  static MeasurementHandle handleOf(const MeasurementPool& pool, SlotRef ref);
  /// The name, followed by a number when another pool has it already.
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
