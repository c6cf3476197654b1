#include "distributed/container.hpp"

#include <cstdint>
#include <vector>

#include "distributed/messages.hpp"
#include "slom/io/container.hpp"

namespace slom::distributed {

void requireWhole(const Processes& processes, const std::string& file) {
  std::vector<std::uint64_t> sums;
  processes.agree([&] {
    const io::Container container(file);
    for (const io::ContainerSection& section : container.sections())
      sums.push_back(container.sum(section, io::rangeOf(section, processes.rank(), processes.size())));
  });
  const std::vector<std::uint64_t> all = gathered(processes, sums);
  processes.agree([&] {
    const io::Container container(file);
    for (std::size_t s = 0; s < sums.size(); ++s) {
      std::uint64_t sum = 0;
      for (std::size_t i = s; i < all.size(); i += sums.size()) sum += all[i];
      container.requireSum(container.sections()[s], sum);
    }
  });
}

}  // namespace slom::distributed
