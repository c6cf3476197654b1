#include "compact.hpp"

#include <utility>

#include "base/index.hpp"

namespace slom {

namespace {

class Renumbered final : public InverseBlocks {
 public:
  Renumbered(std::unique_ptr<InverseBlocks> blocks, std::vector<int> number)
      : blocks_(std::move(blocks)), number_(std::move(number)) {}
  void block(int a, int b, double* out) const override {
    blocks_->block(number_[at(a)], number_[at(b)], out);
  }

 private:
  std::unique_ptr<InverseBlocks> blocks_;
  std::vector<int> number_;
};

}  // namespace

CompactStructure compact(const BlockStructure& structure) {
  std::vector<int> number(at(structure.blockCount()), -1), offset;
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (structure.isEmpty(b)) continue;
    number[at(b)] = static_cast<int>(offset.size());
    offset.push_back(structure.offset[at(b)]);
  }
  if (static_cast<int>(offset.size()) == structure.blockCount()) return {structure, {}};
  offset.push_back(structure.unknowns());
  CompactStructure result{{std::move(offset), structure.groups}, std::move(number)};
  for (MeasurementGroup& group : result.structure.groups) {
    for (int& block : group.blocks) block = block < 0 ? block : result.block[at(block)];
  }
  return result;
}

std::unique_ptr<InverseBlocks> CompactStructure::renumbered(std::unique_ptr<InverseBlocks> blocks) const {
  if (blocks == nullptr || block.empty()) return blocks;
  return std::make_unique<Renumbered>(std::move(blocks), block);
}

}  // namespace slom
