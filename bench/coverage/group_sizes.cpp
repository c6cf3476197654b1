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
      tallies[i].add(design, clustered(est, optionsOf(design, kCorrections[i])), p);
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
      "\nThe fit has a constant and a slope over a number that grows with the group; with two ways there is a slope for each way. The errors that a group shares are twice as large as the others. "
      "There are %d simulations for each row.\n\n"
      "* Sizes: \"equal\" has 10 measurements in each group; \"one large\" has 400 in the first group and 3 in each of the others; \"lognormal\" has 2 + exp(2 + 1.2 n), with n normal. With two ways, "
      "the rows have these sizes, and the columns are random.\n"
      "* \"In order\": `ordered` is set, although successive groups are not alike.\n"
      "* Each percentage is for the component with the lowest percentage. \"Printed / true\" is the root mean square of its printed standard deviations, divided by the root mean square of its errors.\n"
      "* \"Default\" is `ClusterCorrection::by_leverage`.\n"
      "* \"Named\" is the percentage of simulations in which the report warns that single groups determine some values, or that there are few groups. The last column is for the other "
      "simulations, without such a warning.\n"
      "* The default takes cr3 from a ratio of cr3 to cr2 of 1.2 on, with `ordered` from 1.5 on. It computes the ratio from the residuals and from the leverages of the groups, because the residuals "
      "of a large group may be small by chance.\n",
      runs);
}

}  // namespace slom::bench
