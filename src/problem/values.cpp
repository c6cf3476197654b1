// The values of all variables: moving, saving and restoring them.
#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

std::optional<std::span<const Change>> Problem::changesSince(std::uint64_t structure_revision) const {
  return changes_.since(structure_revision);
}

std::optional<std::span<const int>> Problem::movedSince(std::uint64_t value_revision) const {
  return moves_.since(value_revision);
}

void Problem::save() {
  for (const TypedStore& own : stores_) own.store->save();
  saved_travelled_ = travelled_;
}

void Problem::restore() {
  for (const TypedStore& own : stores_) own.store->restore();
  std::copy(saved_travelled_.begin(), saved_travelled_.end(), travelled_.begin());
  moves_.add(kAll, size());
}

void Problem::move(int variable, const double* d) {
  const VariableRecord& record = table_[at(variable)];
  record.store->boxplus(record.store->valueAt(record.slot), d);
  double most = 0;
  for (int i = 0; i < record.dof; ++i) most = std::max(most, std::abs(d[i]));
  travelled_[at(variable)] += most;
  moves_.add(variable, size());
}

void Problem::applyStep(const std::vector<int>& offset, const double* step) {
  for (const TypedStore& own : stores_) own.store->applyStep(offset, step);
  for (std::size_t v = 0; v < table_.size(); ++v) {
    double most = 0;
    for (int i = offset[v]; i < offset[v + 1]; ++i) most = std::max(most, std::abs(step[i]));
    travelled_[v] += most;
  }
  moves_.add(kAll, size());
}

}  // namespace slom
