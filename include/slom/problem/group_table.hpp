/// The groups of measurements that may share errors: names of dimensions and keys, by number.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "slom/model/group.hpp"

namespace slom {

/// The key of a group: a number or a text.
struct GroupKey {
  std::int64_t number = 0;
  std::string text;
  bool is_text = false;

  /// `17`, `left`
  std::string name() const { return is_text ? text : std::to_string(number); }
};

/// Dimensions and keys are numbered from 0 in the order in which they come first. Numbers stay when measurements go.
class GroupTable {
 public:
  /// The number of dimensions.
  int dimensionCount() const { return static_cast<int>(dimensions_.size()); }
  /// The name of dimension d.
  const std::string& dimension(int d) const { return dimensions_[static_cast<std::size_t>(d)].name; }
  /// Its number; -1: there is none of this name.
  int find(std::string_view dimension) const;
  /// Its number; the dimension is new where there was none.
  int findOrAdd(std::string_view dimension);

  /// The keys of dimension d, by number.
  const std::vector<GroupKey>& keys(int d) const { return dimensions_[static_cast<std::size_t>(d)].keys; }
  /// The number of the group's key in dimension d; new where it was not there.
  int findOrAddKey(int d, const Group& group);

 private:
  struct Dimension {
    std::string name;
    std::vector<GroupKey> keys;
    std::unordered_map<std::int64_t, int> by_number;
    std::map<std::string, int, std::less<>> by_text;
  };
  std::vector<Dimension> dimensions_;
};

}  // namespace slom
