/// Keys of the measurements of one pool. Each dimension has a table, 4 bytes per measurement, up to the last with a
/// key.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "slom/problem/measurement_pool.hpp"

namespace slom {

struct MeasurementPool::GroupKeys {
  std::vector<std::vector<int>> of_dimension;  // -1: none; measurements after the last entry have none

  int get(std::size_t dimension, std::size_t i) const {
    return dimension < of_dimension.size() && i < of_dimension[dimension].size() ? of_dimension[dimension][i]
                                                                                 : -1;
  }
  void set(std::size_t dimension, std::size_t i, int key) {
    if (dimension >= of_dimension.size()) of_dimension.resize(dimension + 1);
    std::vector<int>& keys = of_dimension[dimension];
    if (i >= keys.size()) keys.resize(i + 1, -1);
    keys[i] = key;
  }
  /// Moves the keys of measurement `last` to `hole`.
  void remove(std::size_t hole, std::size_t last) {
    for (std::vector<int>& keys : of_dimension) {
      if (hole < keys.size()) keys[hole] = last < keys.size() ? keys[last] : -1;
      if (last < keys.size()) keys.resize(last);
    }
  }
};

}  // namespace slom
