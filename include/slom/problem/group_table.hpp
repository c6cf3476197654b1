/// GroupTable: the groups of measurements that may share errors, with numbers for the names of dimensions and for keys.
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

  /// Returns text such as `17`, `left`.
  std::string name() const { return is_text ? text : std::to_string(number); }
};

/// Dimensions and keys, numbered from 0 in the order of their first use. Numbers stay when measurements are removed.
class GroupTable {
 public:
  /// Returns the number of dimensions.
  int dimensionCount() const { return static_cast<int>(dimensions_.size()); }
  /// Returns the name of dimension d.
  const std::string& dimension(int d) const { return dimensions_[static_cast<std::size_t>(d)].name; }
  /// Returns the number of a dimension; -1 if there is none of this name.
  int find(std::string_view dimension) const;
  /// Returns the number of a dimension; adds the dimension if it is new.
  int findOrAdd(std::string_view dimension);

  /// Returns the keys of dimension d, by number.
  const std::vector<GroupKey>& keys(int d) const { return dimensions_[static_cast<std::size_t>(d)].keys; }
  /// Returns the number of the group's key in dimension d; adds the key if it is new.
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
