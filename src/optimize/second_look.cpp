#include "optimize/second_look.hpp"

#include <vector>

#include "base/index.hpp"

namespace slom {

using Eigen::MatrixXd;

bool hasFreeGauge(const Problem& problem, const ProblemStructure& structure, const LinearSolver& solver) {
  constexpr double nothing = 1e-12;  // relative to the lengths of the columns
  const Eigen::VectorXd& H = solver.diagonal();
  std::vector<double> motions;
  for (const WorldRole role : {WorldRole::in_world, WorldRole::sees_world}) {
    MatrixXd moved = MatrixXd::Zero(H.size(), kGaugeGenerators);
    for (int v = 0; v < structure.system.blockCount(); ++v) {
      if (structure.system.isEmpty(v)) continue;
      const VariableRecord& record = problem.variables()[at(v)];
      motions.resize(at(record.dof * kGaugeGenerators));
      record.store->gaugeGenerators(problem.linearizationPoint(v), role, motions.data());
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
    look.status.least = 0;  // certain, whatever limit a solver uses
    return look;
  }
  Eigen::VectorXd ignored;
  look.status = careful->solve({}, ignored);
  look.status.least = careful->leastOfColumn();
  if (look.status.ok) look.solver = std::move(careful);
  return look;
}

}  // namespace slom
