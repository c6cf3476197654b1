/// Groups of measurements that may share errors: their table, and the keys of measurements.
#include "slom/problem/group_table.hpp"

#include <algorithm>

#include "base/index.hpp"
#include "problem/group_keys.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

void detail::requireDistinctDimensions(const Group* groups, int count) {
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < i; ++j) {
      if (groups[i].dimension != groups[j].dimension) continue;
      const std::string name(groups[i].dimension);
      throw Error(
          "slom.bad-group",
          "a measurement is put into two groups" + (name.empty() ? "" : " of \"" + name + "\"") +
              "; pass slom::group once, or once for each of several names: slom::group(\"image\", 17)",
          name.empty() ? "group" : name);
    }
  }
}

int GroupTable::find(std::string_view dimension) const {
  const auto found = std::find_if(dimensions_.begin(), dimensions_.end(),
                                  [&](const Dimension& one) { return one.name == dimension; });
  return found == dimensions_.end() ? -1 : static_cast<int>(found - dimensions_.begin());
}

int GroupTable::findOrAdd(std::string_view dimension) {
  const int found = find(dimension);
  if (found >= 0) return found;
  dimensions_.push_back({std::string(dimension), {}, {}, {}});
  return dimensionCount() - 1;
}

int GroupTable::findOrAddKey(int d, const Group& group) {
  Dimension& own = dimensions_[at(d)];
  const int next = static_cast<int>(own.keys.size());
  if (group.is_text) {
    if (const auto found = own.by_text.find(group.text); found != own.by_text.end()) return found->second;
    own.keys.push_back({0, std::string(group.text), true});
    own.by_text.emplace(group.text, next);
  } else {
    if (const auto found = own.by_number.find(group.number); found != own.by_number.end())
      return found->second;
    own.keys.push_back({group.number, {}, false});
    own.by_number.emplace(group.number, next);
  }
  return next;
}

int MeasurementPool::groupKey(int dimension, int i) const {
  return group_keys_ ? group_keys_->get(at(dimension), at(i)) : -1;
}

void MeasurementPool::setGroupKey(int dimension, int i, int key) {
  if (!group_keys_) group_keys_ = detail::Pimpl<GroupKeys>(new GroupKeys);
  group_keys_->set(at(dimension), at(i), key);
}

void Problem::assignGroups(MeasurementPool& pool, int i, const Group* groups, int count) {
  if (!groups_) groups_ = detail::Pimpl<GroupTable>(new GroupTable);
  for (int k = 0; k < count; ++k) {
    const int dimension = groups_->findOrAdd(groups[k].dimension);
    pool.setGroupKey(dimension, i, groups_->findOrAddKey(dimension, groups[k]));
  }
}

}  // namespace slom
