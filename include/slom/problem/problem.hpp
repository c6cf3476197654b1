/// The books: variables and measurements by type, who depends on whom, what is optimised.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <typeindex>
#include <unordered_map>
#include <utility>
#include <vector>

#include "slom/model/meas_id.hpp"
#include "slom/problem/measurement_pool.hpp"

namespace slom {

class Problem {
 public:
  Problem() = default;
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  // Variables.

  template <class T>
  VarID<T> insertVariable(const T& value, bool optimize, std::string name) {
    mtk::requireManifold<T>();
    auto store = findStore<T>();
    const int index = reserveVariable();
    const SlotRef ref = store->insert(value, index);
    bookVariable(index, {store.get(), ref.slot, mtk::dof(value), optimize, 0, 0, std::move(name)});
    return VarID<T>(std::move(store), ref);
  }
  /// Index of the variable in the table; throws [slom.stale-handle] when it is not in this problem.
  template <class T>
  int indexOf(const VarID<T>& id) const {
    return checkedIndex(id.store_.get(), id.ref_, &slom::typeName<T>);
  }
  template <class T>
  void setValue(const VarID<T>& id, const T& value) {
    const int index = indexOf(id);
    checkNewDof(index, mtk::dof(value));
    id.store_->value(id.ref_.slot) = value;
    ++value_revision_;
  }
  void setOptimized(int variable, bool optimize);
  /// Throws [slom.variable-in-use] when measurements depend on it.
  void removeVariable(int variable);

  const std::vector<VariableRecord>& variables() const { return table_; }
  int variableCount() const { return static_cast<int>(table_.size() - free_.size()); }
  /// The user's name, or `SE3 #5`: type and running number of insertion.
  std::string variableName(int variable) const;
  std::string variableValue(int variable) const;
  /// Names of the components, the variable's own name in front.
  std::vector<std::string> componentNames(int variable) const;

  // Measurements.

  /// `label`: name of the group, empty for the type's own.
  template <Measurement M>
  MeasID<M> insertMeasurement(M measurement, const NoiseView& noise, std::string_view label = {},
                              const Loss& loss = {}) {
    TypedPool<M>& pool = findPool<M>(label);
    constexpr int arity = static_cast<int>(std::tuple_size_v<decltype(measurement.variableArgs())>);
    int variables[static_cast<std::size_t>(arity)];
    int k = 0;
    std::apply([&](auto&... arg) {
      ((variables[k++] = checkedIndex(arg.store(), arg.slotRef(), &slom::typeName<ValueOf<decltype(arg)>>)), ...);
    }, measurement.variableArgs());
    const SlotRef ref = [&] {
      try {
        return pool.insert(std::move(measurement), variables, noise, loss);
      } catch (const MeasurementThrew& event) {
        raiseThrew(pool.nextName(), variables, arity, event.exception);
      }
    }();
    bookMeasurement(variables, arity);
    return MeasID<M>(&pool, ref);
  }
  template <class M>
  std::pair<MeasurementPool*, int> locate(const MeasID<M>& id) const {
    return locate(id.pool_, id.ref_);
  }
  void removeMeasurement(MeasurementPool& pool, int i);
  /// `pose[3] = (1 2 0.5), pose[4] = (...)`: the variables of a measurement and their values.
  std::string valuesText(const int* variables, int arity) const;
  /// Throws [slom.measurement-threw], which names the measurement; the user's own exception is nested in it.
  [[noreturn]] void raiseThrew(const std::string& measurement, const int* variables, int arity,
                               const std::exception_ptr& exception) const;
  [[noreturn]] void raiseThrew(const MeasurementPool& pool, const MeasurementThrew& event) const {
    raiseThrew(pool.measurementName(event.measurement), pool.variables(event.measurement), pool.arity(), event.exception);
  }
  /// The pools of measurements of type M: one for each label, none when none was ever inserted.
  template <class M>
  std::vector<const MeasurementPool*> poolsOf() const {
    return findPools(typeid(M));
  }
  const std::vector<std::unique_ptr<MeasurementPool>>& pools() const { return pools_; }
  /// Non-const access for evaluation, which moves variables locally.
  std::vector<std::unique_ptr<MeasurementPool>>& pools() { return pools_; }

  // Values as a whole.

  void save();
  void restore();
  void applyStep(const std::vector<int>& offset_of_variable, const double* step);

  /// Changes with every insertion, removal, fixing and releasing.
  std::uint64_t structureRevision() const { return structure_revision_; }
  /// Changes whenever a value does.
  std::uint64_t valueRevision() const { return value_revision_; }

 private:
  struct LabelledPool {
    std::string label;
    MeasurementPool* pool;
  };
  template <class Arg>
  using ValueOf = typename std::remove_cvref_t<Arg>::Value;

  template <class T>
  std::shared_ptr<VariableStore<T>> findStore() {
    const auto make = []() -> VariableStoreBase* { return new VariableStore<T>; };
    return std::static_pointer_cast<VariableStore<T>>(findOrMakeStore(typeid(T), make));
  }
  template <class M>
  TypedPool<M>& findPool(std::string_view label) {
    MeasurementPool* pool = findPool(typeid(M), label);
    if (pool == nullptr) {
      std::string name(label);
      if (label.empty()) {
        if constexpr (requires { M::groupName(); }) {
          name = M::groupName();
        } else {
          name = slom::typeName<M>();
        }
      }
      pool = &adoptPool(typeid(M), label, std::make_unique<TypedPool<M>>(nameForPool(std::move(name)), table_));
    }
    return static_cast<TypedPool<M>&>(*pool);
  }

  // What concerns containers is compiled once, not in every file that inserts something.
  std::shared_ptr<VariableStoreBase> findOrMakeStore(std::type_index type, VariableStoreBase* (*make)());
  MeasurementPool* findPool(std::type_index type, std::string_view label) const;
  std::vector<const MeasurementPool*> findPools(std::type_index type) const;
  MeasurementPool& adoptPool(std::type_index type, std::string_view label, std::unique_ptr<MeasurementPool> pool);
  int reserveVariable();
  void bookVariable(int index, VariableRecord record);
  void bookMeasurement(const int* variables, int arity);
  int checkedIndex(const VariableStoreBase* store, SlotRef ref, std::string (*type)()) const;
  void checkNewDof(int variable, int dof) const;
  std::pair<MeasurementPool*, int> locate(const MeasurementPool* pool, SlotRef ref) const;
  /// The name, with a number behind it when another pool has it already.
  std::string nameForPool(const std::string& name) const;

  std::vector<VariableRecord> table_;
  std::vector<int> free_;
  std::unordered_map<std::type_index, std::shared_ptr<VariableStoreBase>> store_of_type_;
  std::unordered_map<std::type_index, std::vector<LabelledPool>> pools_of_type_;
  std::vector<std::unique_ptr<MeasurementPool>> pools_;
  long inserted_ = 0;
  std::uint64_t structure_revision_ = 0;
  std::uint64_t value_revision_ = 0;
};

}  // namespace slom
