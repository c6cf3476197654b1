/// The keys of the measurements of one pool: four bytes for each measurement and dimension, from the first to the last one that has a key.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "slom/problem/measurement_pool.hpp"

namespace slom {

struct MeasurementPool::GroupKeys {
  std::vector<std::vector<int>> of_dimension;  // -1: none, as of measurements after the last entry

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
  /// Measurement `last` takes the place of `hole`.
  void remove(std::size_t hole, std::size_t last) {
    for (std::vector<int>& keys : of_dimension) {
      if (hole < keys.size()) keys[hole] = last < keys.size() ? keys[last] : -1;
      if (last < keys.size()) keys.resize(last);
    }
  }
};

}  // namespace slom
