/// A structure without its empty blocks, so that orders and factors need not handle them.
#pragma once

#include <memory>
#include <vector>

#include "slom/linearize/structure.hpp"
#include "slom/solve/linear_solver.hpp"

namespace slom {

struct CompactStructure {
  BlockStructure structure;
  std::vector<int>
      block;  ///< block that each block of the whole structure is here, -1 if that is empty; no entries if none is empty

  /// Returns blocks of H^-1 by the numbers of the whole structure.
  std::unique_ptr<InverseBlocks> renumbered(std::unique_ptr<InverseBlocks> blocks) const;
};

/// Removes the empty blocks. Unknowns keep their numbers.
CompactStructure compact(const BlockStructure& structure);

}  // namespace slom
