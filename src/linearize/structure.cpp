#include "slom/linearize/structure.hpp"

#include <algorithm>
#include <iterator>

#include "base/index.hpp"

namespace slom {

namespace {

int dofOf(const Problem& problem, int variable) {
  const VariableRecord& record = problem.variables()[at(variable)];
  return record.store != nullptr && problem.activeSet().isOptimized(variable) ? record.dof : 0;
}

int blockOf(const Problem& problem, int variable) { return dofOf(problem, variable) > 0 ? variable : -1; }

int tableSize(const Problem& problem) { return static_cast<int>(problem.variables().size()); }

/// Computes the offsets of blocks from `first` on.
void layOutBlocks(const Problem& problem, int first, std::vector<int>& offset) {
  offset.resize(at(tableSize(problem)) + 1);
  for (int v = first; v < tableSize(problem); ++v) offset[at(v) + 1] = offset[at(v)] + dofOf(problem, v);
}

void writeBlocks(const Problem& problem, const MeasurementPool& pool, int i, int* blocks) {
  for (int k = 0; k < pool.arity(); ++k) blocks[k] = blockOf(problem, pool.variables(i)[k]);
}

/// Writes the group after those of the pools, if there is one: components that are fixed or at an active bound.
void writeConstrained(const Problem& problem, std::vector<MeasurementGroup>& groups) {
  groups.resize(problem.pools().size());
  const IndexSet& constrained = problem.activeSet().constrained();
  if (constrained.empty()) return;
  MeasurementGroup group{1, {}};
  for (const int v : constrained) {
    if (blockOf(problem, v) >= 0) group.blocks.push_back(v);
  }
  groups.push_back(std::move(group));
}

int countResiduals(const Problem& problem) {
  int sum = 0;
  for (const auto& pool : problem.pools()) sum += pool->totalRows();
  return sum;
}

/// Returns whether two of the blocks differ.
bool doMeet(std::span<const int> blocks) {
  int one = -1;
  for (const int block : blocks) {
    if (block >= 0 && one >= 0 && block != one) return true;
    if (block >= 0) one = block;
  }
  return false;
}

/// Update of a structure. The contents of a pool decide; recorded changes only say where to look.
class Update {
 public:
  Update(const Problem& problem, ProblemStructure& structure)
      : problem_(problem), structure_(structure), touched_(problem.pools().size()) {}

  StructureChanges run(std::span<const Change> changes) {
    for (const Change& change : changes) note(change);
    has_other_constraints_ =
        has_other_constraints_ || hasConstraintGroup() == problem_.activeSet().constrained().empty();
    resizeBlocks();
    addPools();
    for (std::size_t p = 0; p < touched_.size(); ++p) updateGroup(p);
    if (has_other_constraints_) {
      writeConstrained(problem_, structure_.system.groups);
      result_.measurements = true;
    }
    structure_.residuals = countResiduals(problem_);
    return result_;
  }

 private:
  void note(const Change& change) {
    using Kind = Change::Kind;
    if (change.pool >= 0) {
      touched_[at(change.pool)].push_back(change.index);
      return;
    }
    const int variable = change.index;
    has_other_constraints_ =
        has_other_constraints_ || change.kind == Kind::constraint || isOrWasConstrained(variable);
    if (change.kind != Kind::constraint) variables_.push_back(variable);
    if (change.kind == Kind::variable_fixed || change.kind == Kind::variable_freed) {
      problem_.forEachUse(
          variable, [&](const MeasurementPool& pool, int i) { touched_[at(pool.index())].push_back(i); });
    }
  }

  bool hasConstraintGroup() const {
    return static_cast<int>(structure_.system.groups.size()) > structure_.pools;
  }

  bool isOrWasConstrained(int variable) const {
    if (problem_.activeSet().isConstrained(variable)) return true;
    if (!hasConstraintGroup()) return false;
    const std::vector<int>& constrained = structure_.system.groups.back().blocks;
    return std::binary_search(constrained.begin(), constrained.end(), variable);
  }

  void resizeBlocks() {
    const int before = structure_.system.blockCount();
    int first = before;
    for (const int v : variables_) {
      const int dof = v < before ? structure_.system.dof(v) : 0;
      if (dof == dofOf(problem_, v)) continue;
      first = std::min(first, v);
      result_.blocks = true;
    }
    if (first == tableSize(problem_)) return;
    layOutBlocks(problem_, first, structure_.system.offset);
    result_.measurements = true;
  }

  /// Inserts the pools before the group of components that are fixed or at an active bound, if there is one.
  void addPools() {
    const auto end = structure_.system.groups.begin() + structure_.pools;
    std::vector<MeasurementGroup> added;
    for (std::size_t p = at(structure_.pools); p < touched_.size(); ++p)
      added.push_back({problem_.pools()[p]->arity(), {}});
    result_.measurements = result_.measurements || !added.empty();
    structure_.system.groups.insert(end, std::move_iterator(added.begin()), std::move_iterator(added.end()));
    structure_.pools = static_cast<int>(touched_.size());
  }

  void updateGroup(std::size_t p) {
    const MeasurementPool& pool = *problem_.pools()[p];
    std::vector<int>& blocks = structure_.system.groups[p].blocks;
    const std::size_t arity = at(pool.arity()), size = at(pool.size()) * arity;
    const auto measurement = [&](std::size_t start) {
      return std::span<const int>(blocks).subspan(start, arity);
    };
    if (touched_[p].empty()) return;
    const std::size_t before = blocks.size();
    for (std::size_t start = size; start < before; start += arity) noteDifference(measurement(start));
    blocks.resize(size, -1);
    std::vector<int> now(arity);
    for (const int i : touched_[p]) {
      const std::size_t start = at(i) * arity;
      if (start >= size) continue;
      writeBlocks(problem_, pool, i, now.data());
      const std::span<const int> was = measurement(start);
      if (start < before && std::equal(now.begin(), now.end(), was.begin())) continue;
      noteDifference(was);
      noteDifference(now);
      std::copy(now.begin(), now.end(), blocks.begin() + static_cast<std::ptrdiff_t>(start));
    }
  }

  void noteDifference(std::span<const int> blocks) {
    result_.measurements = true;
    result_.meetings = result_.meetings || doMeet(blocks);
  }

  const Problem& problem_;
  ProblemStructure& structure_;
  std::vector<std::vector<int>> touched_;  // measurements of each pool
  std::vector<int> variables_;             // those that may have changed in size
  bool has_other_constraints_ = false;
  StructureChanges result_;
};

}  // namespace

ProblemStructure makeStructure(const Problem& problem) {
  ProblemStructure result;
  result.system.offset.assign(1, 0);
  layOutBlocks(problem, 0, result.system.offset);
  for (const auto& pool : problem.pools()) {
    MeasurementGroup group{pool->arity(), std::vector<int>(at(pool->size()) * at(pool->arity()))};
    for (int i = 0; i < pool->size(); ++i)
      writeBlocks(problem, *pool, i, group.blocks.data() + at(i) * at(pool->arity()));
    result.system.groups.push_back(std::move(group));
  }
  writeConstrained(problem, result.system.groups);
  result.pools = static_cast<int>(problem.pools().size());
  result.residuals = countResiduals(problem);
  return result;
}

StructureChanges updateStructure(const Problem& problem, std::span<const Change> changes,
                                 ProblemStructure& structure) {
  return Update(problem, structure).run(changes);
}

}  // namespace slom
