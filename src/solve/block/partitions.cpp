#include "partitions.hpp"

#include <utility>

#include "base/index.hpp"

namespace slom {

namespace {
/// Limits of the partitions: at most 2^kMostHalvings contiguous ranges of measurements. A range has at least
/// kFewestMeasurements measurements and starts at a multiple of kPartitionAlignment, the batch size of the
/// linearisation. Private accumulators have fewer than kMostPrivatePerProduct numbers per product.
constexpr int kMostHalvings = 4, kFewestMeasurements = 256, kPartitionAlignment = 64;
constexpr double kMostPrivatePerProduct = 1.0 / 8;

/// Returns the number of products that measurement m adds to the blocks of H.
double productsOf(const BlockStructure& structure, const MeasurementGroup& group, int m) {
  double sum = 0, before = 0;
  for (int k = 0; k < group.arity; ++k) {
    const int block = group.blocks[at(m) * at(group.arity) + at(k)];
    const double dof = block < 0 ? 0 : structure.dof(block);
    sum += dof * (dof + before);
    before += dof;
  }
  return sum;
}

/// Cuts the measurements into at most `count` partitions of about the same work. Returns their first measurements.
std::vector<MeasurementPlace> cut(const BlockStructure& structure, int count) {
  const auto workOf = [&](const MeasurementGroup& group) {
    return group.size() == 0 ? 0.0 : productsOf(structure, group, 0) * group.size();
  };
  double total = 0;
  for (const MeasurementGroup& group : structure.groups) total += workOf(group);
  std::vector<MeasurementPlace> partitions{{0, 0}};
  double before = 0;
  for (int g = 0; g < static_cast<int>(structure.groups.size()); ++g) {
    const MeasurementGroup& group = structure.groups[at(g)];
    const double work = workOf(group);
    while (work > 0) {
      const double share = (total * static_cast<double>(partitions.size()) / count - before) / work;
      const int index = static_cast<int>(share * group.size() / kPartitionAlignment) * kPartitionAlignment;
      if (share >= 1 || index >= group.size() || static_cast<int>(partitions.size()) == count) break;
      partitions.push_back({g, index});
    }
    before += work;
  }
  return partitions;
}
}  // namespace

std::vector<MeasurementPlace> choosePartitions(const BlockStructure& structure) {
  int measurements = 0;
  for (const MeasurementGroup& group : structure.groups) measurements += group.size();
  int halvings = 0;
  while (halvings < kMostHalvings && measurements >> (halvings + 1) >= kFewestMeasurements) ++halvings;
  if (halvings == 0) return {};
  const std::vector<MeasurementPlace> finest = cut(structure, 1 << halvings);
  double products = 0;
  // accumulators[s] counts entries of private accumulators with the finest partitions, a half of them, a quarter, ...
  double accumulators[kMostHalvings] = {};
  std::vector<signed char> met(at(structure.blockCount()), -1);
  int partition = 0;
  for (int g = 0; g < static_cast<int>(structure.groups.size()); ++g) {
    const MeasurementGroup& group = structure.groups[at(g)];
    const int* block = group.blocks.data();
    for (int m = 0; m < group.size(); ++m) {
      partition = partitionOf(finest, partition, {g, m});
      products += productsOf(structure, group, m);
      for (int k = 0; k < group.arity; ++k, ++block) {
        if (*block < 0) continue;
        const int before = std::exchange(met[at(*block)], static_cast<signed char>(partition));
        if (before < 0 || before == partition) continue;
        const double dof = structure.dof(*block);
        for (int s = 0; s < halvings && before >> s != partition >> s; ++s)
          accumulators[s] += dof * (dof + 1);
      }
    }
  }
  int s = 0;
  while (s < halvings && accumulators[s] > kMostPrivatePerProduct * products) ++s;
  if (s == halvings) return {};
  std::vector<MeasurementPlace> partitions;
  for (std::size_t p = 0; p < finest.size(); p += std::size_t{1} << s) partitions.push_back(finest[p]);
  return partitions;
}

int partitionOf(const std::vector<MeasurementPlace>& partitions, int partition,
                const MeasurementPlace& measurement) {
  const auto begins = [&](const MeasurementPlace& next) {
    return std::pair(next.group, next.index) <= std::pair(measurement.group, measurement.index);
  };
  while (at(partition + 1) < partitions.size() && begins(partitions[at(partition + 1)])) ++partition;
  return partition;
}

}  // namespace slom
