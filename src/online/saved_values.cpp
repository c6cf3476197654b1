#include "online/saved_values.hpp"

#include "base/index.hpp"

namespace slom {

SavedValues::~SavedValues() {
  for (auto& [store, values] : values_) {
    for (std::size_t i = 0; i < values.size(); ++i) store->destroy(values[i]);
  }
}

void SavedValues::keep(int variable) {
  if (!known_.insert(variable).second) return;
  const VariableRecord& record = problem_.variables()[at(variable)];
  ValueArray& values =
      values_.try_emplace(record.store, record.store->valueSize(), record.store->alignment()).first->second;
  record.store->construct(values.place(), record.store->valueAt(record.slot));
  variables_.push_back(variable);
  index_.push_back(values.size());
  values.grow();
}

void SavedValues::restore() {
  for (std::size_t i = 0; i < variables_.size(); ++i) {
    const VariableRecord& record = problem_.variables()[at(variables_[i])];
    problem_.overwrite(variables_[i], values_.at(record.store)[index_[i]]);
  }
}

}  // namespace slom
