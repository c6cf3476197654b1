/// All algorithms, for tests of their common properties.
#pragma once

#include <memory>
#include <vector>

#include <slom/estimator.hpp>
#include <slom/optimize/named.hpp>

namespace slom::testing {

inline std::vector<std::unique_ptr<Algorithm>> allAlgorithms() {
  std::vector<std::unique_ptr<Algorithm>> all;
  for (const NamedAlgorithm& one : slom::algorithms()) all.push_back(one.make());
  return all;
}

}  // namespace slom::testing
