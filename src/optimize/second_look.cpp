#include "optimize/second_look.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "base/index.hpp"

namespace slom {

using Eigen::MatrixXd;

namespace {

/// What the variables of each type may be to the world: poses in it with poses in it, cameras that see it with points in it. Of more than a few
/// types all are the same.
std::vector<std::map<const VariableStoreBase*, WorldRole>> roles(const Problem& problem,
                                                                 const ProblemStructure& structure) {
  constexpr std::size_t few = 3;
  std::vector<const VariableStoreBase*> stores;
  for (int v = 0; v < structure.system.blockCount(); ++v) {
    const VariableStoreBase* const store = problem.variables()[at(v)].store;
    if (!structure.system.isEmpty(v) && std::find(stores.begin(), stores.end(), store) == stores.end())
      stores.push_back(store);
  }
  const unsigned all = (1u << std::min(stores.size(), few)) - 1;
  std::vector<std::map<const VariableStoreBase*, WorldRole>> result;
  for (unsigned choice = 0; choice <= all; ++choice) {
    if (stores.size() > few && choice != 0 && choice != all) continue;
    auto& role_of = result.emplace_back();
    for (std::size_t i = 0; i < stores.size(); ++i) {
      const bool sees = (choice >> std::min(i, few - 1) & 1u) != 0;
      role_of[stores[i]] = sees ? WorldRole::sees_world : WorldRole::in_world;
    }
  }
  return result;
}

}  // namespace

bool hasFreeGauge(const Problem& problem, const ProblemStructure& structure, const LinearSolver& solver) {
  constexpr double nothing = 1e-12;  // relative to the lengths of the columns
  const Eigen::VectorXd& H = solver.diagonal();
  std::vector<double> motions;
  for (const auto& role_of : roles(problem, structure)) {
    MatrixXd moved = MatrixXd::Zero(H.size(), kGaugeGenerators);
    for (int v = 0; v < structure.system.blockCount(); ++v) {
      if (structure.system.isEmpty(v)) continue;
      const VariableRecord& record = problem.variables()[at(v)];
      motions.resize(at(record.dof * kGaugeGenerators));
      record.store->gaugeGenerators(record.store->valueAt(record.slot), role_of.at(record.store),
                                    motions.data());
      moved.middleRows(structure.offsetOf(v), record.dof) =
          Eigen::Map<const MatrixXd>(motions.data(), record.dof, kGaugeGenerators);
    }
    for (int k = 0; k < kGaugeGenerators; ++k) {
      const double size = H.dot(moved.col(k).cwiseAbs2());
      if (size > 0 && solver.squaredNormOfJd(moved.col(k)) <= nothing * nothing * size) return true;
    }
  }
  return false;
}

SecondLook lookAgain(const Problem& problem, const ProblemStructure& structure, const LinearSolver& first,
                     SolveStatus failed, double digits, const std::function<void(LinearSolver&)>& fill) {
  SecondLook look;
  look.status = failed;
  look.status.least = first.leastOfColumn();
  std::unique_ptr<LinearSolver> careful = first.careful(digits);
  if (careful == nullptr) return look;
  look.was_asked = true;
  careful->analyze(structure.system);
  fill(*careful);
  if (hasFreeGauge(problem, structure, *careful)) {
    look.status.least = 0;  // it is certain, whatever a solver takes for its limit
    return look;
  }
  Eigen::VectorXd ignored;
  look.status = careful->solve({}, ignored);
  look.status.least = careful->leastOfColumn();
  if (look.status.ok) look.solver = std::move(careful);
  return look;
}

}  // namespace slom
