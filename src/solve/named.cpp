#include "slom/solve/named.hpp"

#include <algorithm>
#include <vector>

#include "solve/named_list.hpp"

namespace slom {

namespace {

const std::vector<NamedSolver>& allSolvers() {
  static const std::vector<NamedSolver> all{
#define SLOM_SOLVER(name) detail::solvers::name,
#include "solve/named_list.inc"
#undef SLOM_SOLVER
  };
  return all;
}

}  // namespace

std::span<const NamedSolver> solvers() {
  static const std::vector<NamedSolver> available = [] {
    std::vector<NamedSolver> solvers = allSolvers();
    std::erase_if(solvers, [](const NamedSolver& one) { return one.missing != nullptr; });
    return solvers;
  }();
  return available;
}

const NamedSolver* solverNamed(std::string_view name) {
  const std::vector<NamedSolver>& all = allSolvers();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const NamedSolver& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

}  // namespace slom
