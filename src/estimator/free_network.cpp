// Fits of free networks: the values are as near to the start values as the measurements allow.
#include "analyze/free_network.hpp"

#include <algorithm>
#include <map>
#include <memory>

#include "base/index.hpp"
#include "estimator/state.hpp"
#include "linearize/variable_of.hpp"
#include "problem/value_snapshot.hpp"
#include "slom/optimize/optimizer.hpp"

namespace slom {

namespace {

using Eigen::VectorXd;

/// A minimal datum: fixes as many components as the network has free directions, so that the others are determined.
class MinimalDatum {
 public:
  /// Fixes the unknowns of the structure for which `is_held` is positive.
  MinimalDatum(Problem& problem, const ProblemStructure& structure, const VectorXd& is_held)
      : problem_(problem) {
    for (int unknown = 0; unknown < static_cast<int>(is_held.size()); ++unknown) {
      if (!(is_held[unknown] > 0)) continue;
      const int variable = variableOf(structure, unknown);
      held_[variable].push_back(unknown - structure.offsetOf(variable));
    }
    for (const auto& [variable, components] : held_) problem_.setFixed(variable, components, true);
  }
  ~MinimalDatum() {
    for (const auto& [variable, components] : held_) problem_.setFixed(variable, components, false);
  }
  MinimalDatum(const MinimalDatum&) = delete;
  MinimalDatum& operator=(const MinimalDatum&) = delete;

 private:
  Problem& problem_;
  std::map<int, std::vector<int>> held_;  // components by variable
};

/// Returns the movement since the snapshot, by unknown of the structure.
VectorXd movedSince(const ValueSnapshot& start, const Problem& problem, const ProblemStructure& structure) {
  VectorXd moved = VectorXd::Zero(structure.system.unknowns());
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    if (!structure.system.isEmpty(v)) start.difference(v, moved.data() + structure.offsetOf(v));
  }
  for (int unknown = 0; unknown < static_cast<int>(moved.size()); ++unknown) {
    const int variable = variableOf(structure, unknown);
    if (problem.activeSet().isFixedOrActive(variable, unknown - structure.offsetOf(variable)))
      moved[unknown] = 0;
  }
  return moved;
}

}  // namespace

bool Estimator::State::isFreeNetwork() {
  return gauge == FreeGauge::inner_constraints &&
         analyze([](const LinearizedProblem& linearized) { return linearized.freeDirections(); }) > 0;
}

std::unique_ptr<FreeNetwork> Estimator::State::freeNetwork() {
  try {
    return analyze([](const LinearizedProblem& linearized) {
      auto network = std::make_unique<FreeNetwork>(linearized);
      return network->isFree() ? std::move(network) : nullptr;
    });
  } catch (const Error&) {
    return nullptr;
  }
}

void Estimator::State::goOn(Summary& summary, Summary later) {
  const int before = summary.iterations;
  summary.iterations += later.iterations;
  summary.final_rss = later.final_rss;
  summary.seconds += later.seconds;
  summary.converged = later.converged;
  summary.stop_reason = later.stop_reason;
  summary.algorithm = later.algorithm;
  for (std::string& warning : later.warnings) summary.warnings.push_back(std::move(warning));
  for (IterationRecord& line : later.trace) {
    if (line.iteration == 0) continue;
    line.iteration += before;
    summary.trace.push_back(std::move(line));
  }
}

/// Fits with a minimal datum, which determines everything else. Then moves the network along its free directions onto
/// the start values. Repeats both, because a long move bends the network. The result does not depend on the datum.
///   source   Baarda, "S-transformations and criterion matrices", 1973
Summary Estimator::State::fitFreeNetwork(const Fit& fit, std::unique_ptr<FreeNetwork> network) {
  constexpr int most_rounds = 20;
  constexpr double kAtRest = 1e-12;  // relative to the typical sizes of the unknowns
  const ValueSnapshot start(problem);
  Summary summary;
  for (int round = 0; round < most_rounds; ++round) {
    {
      const MinimalDatum datum(problem, evaluator.structure(), network->damping());
      current.reset();
      if (round == 0) {
        summary = fit();
      } else {
        goOn(summary, fit());
      }
    }
    current.reset();
    if (!summary.converged) return summary;
    network = freeNetwork();
    if (network == nullptr) return summary;
    const ProblemStructure& structure = evaluator.structure();
    const VectorXd back = -network->freePartOf(movedSince(start, problem, structure));
    const VectorXd sizes = evaluator.typicalSizes();
    if ((back.array().abs() <= kAtRest * sizes.array()).all()) return summary;
    problem.applyStep(structure.system.offset, back.data());
    current.reset();
  }
  return summary;
}

}  // namespace slom
