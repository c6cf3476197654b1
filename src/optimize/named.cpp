#include "slom/optimize/named.hpp"

#include <algorithm>

#include "optimize/named_list.hpp"

namespace slom {

std::span<const NamedAlgorithm> algorithms() {
  static const NamedAlgorithm all[] = {
#define SLOM_ALGORITHM(name) detail::algorithms::name,
#include "optimize/named_list.inc"
#undef SLOM_ALGORITHM
  };
  return all;
}

const NamedAlgorithm* algorithmNamed(std::string_view name) {
  const std::span<const NamedAlgorithm> all = algorithms();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const NamedAlgorithm& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace slom
