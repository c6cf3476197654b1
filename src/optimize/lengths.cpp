#include "optimize/lengths.hpp"

#include "base/words.hpp"

namespace slom {

namespace {
[[noreturn]] void raise(const std::string& whose, const std::string& what, Eigen::Index entries, int unknowns,
                        const std::string& subject) {
  const std::string has = entries == 1 ? " has 1 entry" : " has " + std::to_string(entries) + " entries";
  throw Error("slom.wrong-length",
              what + " of " + whose + has + ", but the problem has " + counted(unknowns, "unknown") +
                  "; give one entry for each",
              subject);
}

void requireLength(const LinearSolver& solver, const std::string& what, Eigen::Index entries, int unknowns) {
  if (entries != unknowns)
    raise("the solver " + solver.description(), what, entries, unknowns, solver.description());
}
}  // namespace

void requireGradientLengths(const LinearSolver& solver, int unknowns) {
  requireLength(solver, "gradient()", solver.gradient().size(), unknowns);
  requireLength(solver, "diagonal()", solver.diagonal().size(), unknowns);
}

void requireSolutionLength(const LinearSolver& solver, Eigen::Index rows, int unknowns) {
  requireLength(solver, "the solution", rows, unknowns);
}

void requireStepLength(Eigen::Index entries, int unknowns) {
  if (entries != unknowns) raise("the algorithm", "the step", entries, unknowns, "step");
}

}  // namespace slom
