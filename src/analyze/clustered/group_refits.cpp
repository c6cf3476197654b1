#include "analyze/clustered/group_refits.hpp"

#include <limits>

#include "base/index.hpp"
#include "problem/value_snapshot.hpp"

namespace slom {

namespace {

/// A guard that leaves out a group during its lifetime. The group's measurements have no weight. Variables that no
/// other measurement depends on are fixed.
class WithoutGroup {
 public:
  WithoutGroup(Problem& problem, const Clustering& way, int group, ValueSnapshot& start)
      : problem_(problem), start_(start), active_(problem.activeSet()) {
    std::vector<std::vector<char>> is_withheld;
    std::vector<char> is_seen(problem.variables().size(), 0);  // true: another measurement depends on it
    for (std::size_t p = 0; p < way.of_pool.size(); ++p) {
      const MeasurementPool& pool = *problem.pools()[p];
      std::vector<char>& own = is_withheld.emplace_back(way.of_pool[p].size(), 0);
      for (int i = 0; i < pool.size(); ++i) {
        own[at(i)] = way.of_pool[p][at(i)] == group ? 1 : 0;
        for (int k = 0; k < pool.arity() && own[at(i)] == 0; ++k) is_seen[at(pool.variables(i)[k])] = 1;
      }
    }
    for (std::size_t v = 0; v < is_seen.size(); ++v) {
      if (is_seen[v] == 0 && problem.variables()[v].store != nullptr &&
          problem.activeSet().isOptimized(static_cast<int>(v)))
        alone_.push_back(static_cast<int>(v));
    }
    noise_ = problem.withhold(is_withheld);
    for (const int v : alone_) problem.setOptimized(v, false);
  }
  ~WithoutGroup() {
    for (const int v : alone_) problem_.setOptimized(v, true);
    problem_.activeSet() = std::move(active_);
    start_.restore();
    problem_.restoreNoise(std::move(noise_));
  }
  WithoutGroup(const WithoutGroup&) = delete;
  WithoutGroup& operator=(const WithoutGroup&) = delete;

  const std::vector<int>& alone() const { return alone_; }

 private:
  Problem& problem_;
  ValueSnapshot& start_;
  ActiveSet active_;  // before this guard
  std::vector<int> alone_;
  std::vector<MeasurementPool::SavedNoise> noise_;
};

}  // namespace

GroupRefits refitWithoutGroups(Problem& problem, const ProblemStructure& structure, const Clustering& way,
                               const std::function<bool()>& fit) {
  const std::vector<int> offset = structure.system.offset;  // a copy: fits without a group have other offsets
  GroupRefits result{
      Eigen::MatrixXd::Constant(way.count(), offset.back(), std::numeric_limits<double>::quiet_NaN()), {}};
  ValueSnapshot start(problem);
  std::vector<double> d;
  for (int g = 0; g < way.count(); ++g) {
    const WithoutGroup without(problem, way, g, start);
    if (!fit()) {
      result.failed.push_back(way.names[at(g)]);
      continue;
    }
    std::size_t next_alone = 0;
    for (int v = 0; v + 1 < static_cast<int>(offset.size()); ++v) {
      const int dof = offset[at(v + 1)] - offset[at(v)];
      const bool is_alone = next_alone < without.alone().size() && without.alone()[next_alone] == v;
      next_alone += is_alone ? 1 : 0;
      if (dof == 0 || is_alone) continue;
      d.resize(at(dof));
      start.difference(v, d.data());
      for (int c = 0; c < dof; ++c) result.change(g, offset[at(v)] + c) = d[at(c)];
    }
  }
  return result;
}

}  // namespace slom
