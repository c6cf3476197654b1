#include "slom/linearize/structure.hpp"

namespace slom {

ProblemStructure makeStructure(const Problem& problem) {
  ProblemStructure result;
  const auto& table = problem.variables();
  result.block_of_variable.assign(table.size(), -1);
  result.offset_of_variable.assign(table.size(), -1);
  int unknowns = 0;
  for (std::size_t v = 0; v < table.size(); ++v) {
    if (table[v].store == nullptr || !problem.activeSet().isOptimized(static_cast<int>(v)) ||
        table[v].dof == 0)
      continue;
    result.block_of_variable[v] = static_cast<int>(result.variable_of_block.size());
    result.offset_of_variable[v] = unknowns;
    result.variable_of_block.push_back(static_cast<int>(v));
    result.system.offset.push_back(unknowns);
    unknowns += table[v].dof;
  }
  result.system.offset.push_back(unknowns);

  for (const auto& pool : problem.pools()) {
    MeasurementGroup group{pool->arity(), {}};
    group.blocks.reserve(static_cast<std::size_t>(pool->size()) * static_cast<std::size_t>(pool->arity()));
    for (int i = 0; i < pool->size(); ++i) {
      for (int k = 0; k < pool->arity(); ++k) {
        group.blocks.push_back(result.block_of_variable[static_cast<std::size_t>(pool->variables(i)[k])]);
      }
      result.residuals += pool->rows(i);
    }
    result.system.groups.push_back(std::move(group));
  }
  if (!problem.activeSet().constrained().empty()) {
    MeasurementGroup held{1, {}};
    for (const int v : problem.activeSet().constrained()) {
      const int block = result.block_of_variable[static_cast<std::size_t>(v)];
      if (block >= 0) held.blocks.push_back(block);
    }
    result.system.groups.push_back(std::move(held));
  }
  return result;
}

}  // namespace slom
