/// The algorithms of the library by name, for programs whose users choose one, as those of the command do by `--algorithm`.
///
///     if (const slom::NamedAlgorithm* found = slom::algorithmNamed("dogleg"))
///       est.changeAlgorithm(found->make().release());
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "slom/optimize/algorithm.hpp"

namespace slom {

/// An algorithm that users of a program choose by its name.
struct NamedAlgorithm {
  const char* name;                      ///< `lm`
  const char* description;               ///< what it is, in a few words
  std::unique_ptr<Algorithm> (*make)();  ///< with default options
};

/// The first one is the default of the Estimator.
std::span<const NamedAlgorithm> algorithms();
/// Null: there is none of this name.
const NamedAlgorithm* algorithmNamed(std::string_view name);

}  // namespace slom
