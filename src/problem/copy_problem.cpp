// Copies of problems. Slots of variables and measurements are those of the original, so a copy accepts its handles.
#include <algorithm>

#include "base/index.hpp"
#include "problem/uses.hpp"
#include "slom/model/runtime_measurement.hpp"
#include "slom/problem/group_table.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

void Problem::copyFrom(const Problem& other) {
  copyStores(other);
  table_.reserve(std::max<std::size_t>(64, other.table_.size()));
  for (VariableRecord record : other.table_) {
    if (record.store != nullptr) {
      std::size_t s = 0;
      while (other.stores_[s].store.get() != record.store) ++s;
      record.store = stores_[s].store.get();
    }
    table_.push_back(std::move(record));
  }
  free_.reserve(table_.capacity());
  free_ = other.free_;
  active_ = other.active_;
  active_.reserve(table_.capacity());
  travelled_.reserve(table_.capacity());
  travelled_ = other.travelled_;
  inserted_ = other.inserted_;
  if (other.groups_) groups_ = detail::Pimpl<GroupTable>(new GroupTable(*other.groups_));
  copyPools(other);
  changes_ = other.changes_;  // including the revision, by which algorithms date what they have learnt
  moves_ = other.moves_;
}

void Problem::copyStores(const Problem& other) {
  for (const TypedStore& from : other.stores_) {
    TypedStore own{from.type, from.store->makeEmpty()};
    own.store->copyFrom(*from.store);
    for (const StoreOrigin& origin : from.origins) {
      if (!origin.store.expired()) own.origins.push_back(origin);
    }
    own.origins.push_back({from.store, from.store->generations()});
    stores_.push_back(std::move(own));
  }
}

void Problem::copyPools(const Problem& other) {
  std::vector<VariableHandle> handles;
  for (std::size_t v = 0; v < table_.size(); ++v)
    handles.push_back(table_[v].store == nullptr ? VariableHandle() : handleOf(static_cast<int>(v)));
  first_estimates_.makeRoom(table_.size());
  for (const auto& from : other.pools_) {
    MeasurementPool* first = nullptr;
    for (const auto& own : pools_) {
      if (first == nullptr && own->group() == from->group()) first = own.get();
    }
    pools_.push_back(std::unique_ptr<MeasurementPool>(
        from->type().make_pool(from->name(), from->label(), from->type(), table_, active_)));
    MeasurementPool& pool = *pools_.back();
    pool.setFirstEstimates(first_estimates_);
    pool.joinGroup(static_cast<int>(pools_.size()) - 1, from->group(), first);
    pool.copyFrom(*from, handles);
    for (int i = 0; i < pool.size(); ++i) {
      const RuntimeMeasurement* const original = from->runtimeMeasurement(i);
      for (int k = 0; original != nullptr && k < pool.arity(); ++k) {
        const void* const point = original->firstEstimate(k);
        const int variable = pool.variables(i)[k];
        if (point != nullptr && other.first_estimates_.of(variable) == point)
          first_estimates_.set(variable, pool.runtimeMeasurement(i)->firstEstimate(k));
      }
    }
  }
  group_count_ = other.group_count_;
  measurement_count_ = other.measurement_count_;
}

}  // namespace slom
