/// The measurements of a problem: their pools, their variables and their names.
#include <algorithm>
#include <limits>
#include <new>

#include "base/index.hpp"
#include "problem/runtime_pool.hpp"
#include "problem/uses.hpp"

namespace slom {

MeasurementPool* Problem::findPool(const MeasurementType& type, std::string_view label, int arity) const {
  for (const auto& pool : pools_) {
    const MeasurementType& own = pool->type();
    if (*type.id == *own.id && type.code == own.code && pool->label() == label &&
        (arity == 0 || pool->arity() == arity))
      return pool.get();
  }
  return nullptr;
}

MeasurementPool* Problem::addPool(const MeasurementType& type, std::string_view label) {
  const std::string own_label(label);
  MeasurementPool* const first = findPool(type, label, 0);
  const std::string name =
      first != nullptr ? first->name() : nameForPool(label.empty() ? type.name() : own_label);
  pools_.push_back(std::unique_ptr<MeasurementPool>(type.make_pool(name, own_label, type, table_, active_)));
  pools_.back()->setFirstEstimates(first_estimates_);
  pools_.back()->joinGroup(static_cast<int>(pools_.size()) - 1,
                           first != nullptr ? first->group() : group_count_++, first);
  return pools_.back().get();
}

void Problem::removeLastPool() {
  if (pools_.back()->group() == group_count_ - 1 &&
      std::none_of(pools_.begin(), pools_.end() - 1,
                   [&](const auto& pool) { return pool->group() == pools_.back()->group(); }))
    --group_count_;
  pools_.pop_back();
}

std::vector<const MeasurementPool*> Problem::findPools(std::type_index type) const {
  std::vector<const MeasurementPool*> result;
  for (const auto& pool : pools_) {
    if (type == *pool->type().id) result.push_back(pool.get());
  }
  return result;
}

std::pair<MeasurementPool*, SlotRef> Problem::insertMeasurement(const MeasurementType& type,
                                                                void* measurement,
                                                                VariableArgument* const* arguments,
                                                                const NoiseView& noise,
                                                                std::string_view label, const Loss& loss) {
  std::vector<int>& variables = variables_of_new_;
  variables.clear();
  for (int k = 0; k < type.arity; ++k) {
    variables.push_back(checkedIndex(arguments[k]->store(), arguments[k]->slotRef(),
                                     type.variable_type != nullptr ? type.variable_type[k] : nullptr));
    if (arguments[k]->store() != table_[at(variables.back())].store)  // a handle of the original problem
      arguments[k]->rebind(handleOf(variables.back()));
  }
  MeasurementPool* pool = findPool(type, label, type.arity);
  const bool is_new = pool == nullptr;
  if (is_new) pool = addPool(type, label);
  const SlotRef ref = [&] {
    try {
      try {
        return pool->insert(measurement, variables.data(), noise, loss);
      } catch (const MeasurementThrew& event) {
        raiseThrew(pool->nextName(), variables.data(), type.arity, event.exception);
      }
    } catch (...) {
      if (is_new) removeLastPool();
      throw;
    }
  }();
  for (const int variable : variables) ++table_[at(variable)].uses;
  ++measurement_count_;
  changes_.add({Change::Kind::measurement_inserted, pool->size() - 1, pool->index()}, size());
  noteUse(pool, ref, variables.data(), type.arity);
  return {pool, ref};
}

std::pair<MeasurementPool*, SlotRef> Problem::insertRuntime(RuntimeMeasurement* measurement,
                                                            const NoiseView& noise, std::string_view label,
                                                            const Loss& loss) {
  OwnedMeasurement owned(measurement);
  for (int k = 0; k < measurement->arity(); ++k) {
    const AnyVarID& id = measurement->variables()[at(k)];
    const int variable = checkedIndex(id.store(), measurement->views()[at(k)].slotRef(), nullptr);
    if (id.store() != table_[at(variable)].store) measurement->setVariable(k, handleOf(variable));
  }
  std::vector<VariableArgument*> arguments;
  for (VariableView& view : measurement->views()) arguments.push_back(&view);
  const MeasurementType type = runtimeType(measurement->kind(), measurement->arity());
  first_estimates_.makeRoom(table_.size());
  const auto [pool, ref] = insertMeasurement(type, &owned, arguments.data(), noise, label, loss);
  takeFirstEstimates(*measurement, pool->variables(pool->size() - 1));
  return {pool, ref};
}

void Problem::noteUse(MeasurementPool* pool, SlotRef ref, const int* variables, int arity) const {
  if (!uses_) return;
  try {
    for (int k = 0; k < arity; ++k) {
      if (std::find(variables, variables + k, variables[k]) == variables + k)
        uses_->add(variables[k], {pool, ref});
    }
  } catch (...) {
    uses_ =
        detail::Pimpl<Uses>(nullptr);  // out of memory: the measurement counts; the table is made again later
  }
}

const std::vector<Problem::Use>& Problem::usesOf(int variable) const {
  if (!uses_) {
    uses_ = detail::Pimpl<Uses>(new Uses);
    for (const auto& pool : pools_) {
      for (int i = 0; i < pool->size(); ++i)
        noteUse(pool.get(), pool->handleOf(i), pool->variables(i), pool->arity());
    }
  }
  if (!uses_) throw std::bad_alloc();
  Uses::OfVariable& uses = uses_->at(variable);
  uses_->tidy(uses);
  return uses.all;
}

MeasurementHandle Problem::handleOf(const MeasurementPool& pool, SlotRef ref) {
  return {pool.presence(), ref};
}

std::pair<MeasurementPool*, int> Problem::locate(const MeasurementHandle& id) const {
  for (const auto& own : pools_) {
    if (own->presence() == id.presence_ || own->isFromOrigin(id)) return {own.get(), own->indexOf(id.ref_)};
  }
  if (id.presence_ == nullptr) {
    throw Error("slom.stale-handle",
                "the MeasID refers to no measurement; assign it the result of insertMeasurement", "MeasID");
  }
  throw Error("slom.foreign-handle",
              "the MeasID belongs to another estimator; use it only with the estimator whose "
              "insertMeasurement returned it",
              "MeasID");
}

void Problem::removeMeasurement(MeasurementPool& pool, int i) {
  if (const RuntimeMeasurement* const measurement = pool.runtimeMeasurement(i); measurement != nullptr)
    dropFirstEstimates(*measurement, pool.variables(i));
  for (int k = 0; k < pool.arity(); ++k) --table_[at(pool.variables(i)[k])].uses;
  pool.remove(i);
  if (uses_) ++uses_->removed;
  --measurement_count_;
  changes_.add({Change::Kind::measurement_removed, i, pool.index()}, size());
}

void Problem::scaleSigmas(const std::vector<std::vector<double>>& factors) {
  for (std::size_t p = 0; p < pools_.size(); ++p) pools_[p]->scaleSigmas(factors[p]);
  changes_.forgetAll();
  moves_.add(kAll, size());
}

std::vector<MeasurementPool::SavedNoise> Problem::withhold(
    const std::vector<std::vector<char>>& is_withheld) {
  std::vector<MeasurementPool::SavedNoise> saved;
  for (const auto& pool : pools_) saved.push_back(pool->saveNoise());
  try {
    for (std::size_t p = 0; p < pools_.size(); ++p) {
      std::vector<double> factors(is_withheld[p].size(), 1.0);
      for (std::size_t i = 0; i < factors.size(); ++i) {
        if (is_withheld[p][i] != 0) factors[i] = std::numeric_limits<double>::infinity();
      }
      pools_[p]->scaleSigmas(factors);
    }
  } catch (...) {
    restoreNoise(std::move(saved));
    throw;
  }
  moves_.add(kAll, size());
  return saved;
}

void Problem::restoreNoise(std::vector<MeasurementPool::SavedNoise> noise) noexcept {
  for (std::size_t p = 0; p < pools_.size(); ++p) pools_[p]->restoreNoise(std::move(noise[p]));
  moves_.add(kAll, size());
}

void Problem::raiseThrew(const std::string& measurement, const int* variables, int arity,
                         const std::exception_ptr& exception) const {
  const auto error = [&](const std::string& what) {
    return Error("slom.measurement-threw",
                 "the function of measurement " + measurement + " threw " + what + " at " +
                     valuesText(variables, arity) +
                     "; let it return NaN if it has no value, and the step is taken back",
                 measurement);
  };
  try {
    std::rethrow_exception(exception);
  } catch (const std::exception& e) {
    std::throw_with_nested(error("an exception (" + std::string(e.what()) + ")"));
  } catch (...) {
    std::throw_with_nested(error("something that is not a std::exception"));
  }
}

std::string Problem::nameForPool(const std::string& name) const {
  const auto taken = [&](const std::string& candidate) {
    return std::any_of(pools_.begin(), pools_.end(),
                       [&](const auto& pool) { return pool->name() == candidate; });
  };
  if (!taken(name)) return name;
  int copy = 2;
  while (taken(name + "-" + std::to_string(copy))) ++copy;
  return name + "-" + std::to_string(copy);
}

}  // namespace slom
