/// The algorithms of the library by name, for programs whose users choose one, like the option `--algorithm` of slom.
///
///     if (const slom::NamedAlgorithm* found = slom::algorithmNamed("dogleg"))
///       est.changeAlgorithm(found->make().release());
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "slom/optimize/algorithm.hpp"

namespace slom {

/// An algorithm with the name by which users of a program choose it.
struct NamedAlgorithm {
  const char* name;                      ///< `lm`
  const char* description;               ///< a few words for help texts
  std::unique_ptr<Algorithm> (*make)();  ///< with default options
};

/// Returns all algorithms; the first one is the default of the Estimator.
std::span<const NamedAlgorithm> algorithms();
/// Returns the algorithm of this name; null if there is none.
const NamedAlgorithm* algorithmNamed(std::string_view name);

}  // namespace slom
