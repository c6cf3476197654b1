// Copies of pools of measurements. Slots, and so handles, are those of the original.
#include <algorithm>

#include "base/index.hpp"
#include "problem/group_keys.hpp"
#include "problem/pool_parts.hpp"

namespace slom {

void MeasurementPool::copyFrom(const MeasurementPool& other, const std::vector<VariableHandle>& handles) {
  losses_->all = other.losses_->all;
  std::vector<AnyVarID> variables;
  for (int i = 0; i < other.size(); ++i) {
    variables.clear();
    for (int k = 0; k < arity_; ++k) variables.emplace_back(handles[slom::at(other.variables(i)[k])]);
    if (!pushCopy(other, i, variables)) {
      throw Error(
          "slom.not-copyable",
          "measurement " + other.measurementName(i) +
              " cannot be copied, because its function or its data cannot be copied; pass what they own as a "
              "shared_ptr, or "
              "insert the measurements anew into another estimator",
          other.measurementName(i));
    }
    for (int k = 0; k < arity_; ++k) argument(i, k).rebind(variables[slom::at(k)]);
    const Loss* const loss = other.loss_[slom::at(i)];
    loss_.push_back(loss == nullptr ? nullptr : &*losses_->all.find(*loss));
  }
  loss_count_ = other.loss_count_;
  variables_ = other.variables_;
  rows_ = other.rows_;
  total_rows_ = other.total_rows_;
  noise_kind_ = other.noise_kind_;
  noise_at_ = other.noise_at_;
  noise_ = other.noise_;
  if (other.group_keys_) group_keys_ = detail::Pimpl<GroupKeys>(new GroupKeys(*other.group_keys_));
  serial_ = other.serial_;
  free_slots_.reserve(other.index_of_slot_.size() + 1);  // so remove() cannot fail
  slot_ = other.slot_;
  index_of_slot_ = other.index_of_slot_;
  generation_ = other.generation_;
  free_slots_ = other.free_slots_;
  own_inserted_ = other.own_inserted_;
  removed_since_compaction_ = other.removed_since_compaction_;

  origins_ = detail::Pimpl<Origins>(new Origins);
  if (other.origins_) {
    for (const Origins::Origin& origin : other.origins_->all) {
      if (!origin.presence.expired()) origins_->all.push_back(origin);
    }
  }
  std::vector<std::uint32_t> generations = generation_;
  for (std::size_t slot = 0; slot < generations.size(); ++slot) {
    if (index_of_slot_[slot] < 0) generations[slot] = VariableStoreBase::kFree;
  }
  origins_->all.push_back({other.presence_, std::move(generations)});
}

bool MeasurementPool::isFromOrigin(const MeasurementHandle& id) const {
  if (!origins_ || id.presence_ == nullptr) return false;
  return std::any_of(origins_->all.begin(), origins_->all.end(), [&](const Origins::Origin& origin) {
    return origin.presence.lock() == id.presence_ && id.ref_.slot < origin.generations.size() &&
           origin.generations[id.ref_.slot] == id.ref_.generation;
  });
}

}  // namespace slom
