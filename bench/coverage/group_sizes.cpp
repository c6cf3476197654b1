#include "coverage/group_sizes.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "support/clustered_designs.hpp"

namespace slom::bench {

namespace {

using namespace slom::testing::clusters;

constexpr std::array kCorrections{ClusterCorrection::cr2, ClusterCorrection::cr3,
                                  ClusterCorrection::by_leverage};

const char* nameOf(Sizes sizes) {
  return sizes == Sizes::equal ? "equal" : sizes == Sizes::one_large ? "one large" : "lognormal";
}

void printRow(const Design& design, int runs) {
  std::mt19937_64 random(static_cast<std::uint64_t>(1000 * design.ways +
                                                    100 * static_cast<int>(design.sizes) + design.groups +
                                                    (design.is_ordered ? 10'000 : 0)));
  std::array<Tally, kCorrections.size()> tallies;
  for (int run = 0; run < runs; ++run) {
    Estimator est;
    est.setThreads(1);
    const auto p = simulate(est, design, random);
    est.optimize({.most_parameters = 0});
    for (std::size_t i = 0; i < kCorrections.size(); ++i)
      tallies[i].add(design, est.clustered(optionsOf(design, kCorrections[i])), p);
  }
  std::printf("| %d%s | %s | %d |", design.ways, design.is_ordered ? ", in order" : "", nameOf(design.sizes),
              design.groups);
  for (const Tally& tally : tallies) {
    const std::size_t worst = tally.worst();
    const char* const mark = &tally == &tallies.back() ? "**" : "";
    std::printf(" %s%.1f %%%s | %.2f |", mark, 100.0 * tally.holds[worst] / tally.runs, mark,
                tally.printedOverTrue(worst));
  }
  const Tally& by_default = tallies.back();
  std::printf(" %.1f %% |", 100.0 * by_default.named / by_default.runs);
  if (by_default.unnamed > 0) {
    const int least = *std::min_element(by_default.holds_unnamed.begin(), by_default.holds_unnamed.end());
    std::printf(" %.1f %% of %d |\n", 100.0 * least / by_default.unnamed, by_default.unnamed);
  } else {
    std::printf(" |\n");
  }
  std::fflush(stdout);
}

}  // namespace

void printGroupSizes(int runs) {
  std::printf(
      "\n## Sizes of groups\n\n"
      "| ways | sizes | groups | cr2 holds | printed / true | cr3 holds | printed / true | default holds | printed / true | named | "
      "default holds, not named |\n"
      "| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  constexpr std::array kSizes{Sizes::equal, Sizes::one_large, Sizes::lognormal};
  for (const int ways : {1, 2}) {
    for (const Sizes sizes : kSizes) {
      for (const int groups : {5, 10, 20, 50}) printRow({ways, sizes, groups}, runs);
    }
  }
  for (const Sizes sizes : kSizes) {
    for (const int groups : {10, 20, 50}) printRow({1, sizes, groups, true}, runs);
  }
  std::printf(
      "\nA constant and a slope over a number that grows with the group; with two ways a slope for each. The errors that a group shares are twice the others. "
      "%d simulations each. Sizes: \"equal\", 10 measurements a group; \"one large\", 400 in the first group and 3 in each of the others; \"lognormal\", "
      "2 + exp(2 + 1.2 n), with n normal. In two ways the rows have these sizes, and columns are random. \"In order\": with `ordered`, though successive groups are not alike.\n\n"
      "* Each share is that of the component with the lowest one. \"Printed / true\" is the root mean square of its printed standard deviations, divided by that of its errors.\n"
      "* \"Default\" is `ClusterCorrection::by_leverage`.\n"
      "* \"Named\": simulations in which the report says that single groups carry some values, or that there are few groups. The last column is the share in the others, "
      "which the report does not set apart.\n"
      "* The default decides by what the leverages of groups let expect as well as by the residuals, as the residuals of a large group may happen to be small. With `ordered` it takes "
      "cr3 where that is to be 1.5 times as large as cr2, otherwise from 1.2 times on.\n",
      runs);
}

}  // namespace slom::bench
