#include "iterative_method.hpp"

#include <algorithm>
#include <cmath>

namespace slom {

using Eigen::VectorXd;

namespace {
/// Tolerance if an exact solution is requested.
constexpr double kExactTolerance = 1e-13;
}  // namespace

IterativeMethod::IterativeMethod(std::string system, const BlockSolverOptions& options,
                                 const NormalEquations& equations, int eliminated)
    : system_(std::move(system)), options_(options), equations_(equations) {
  reduced_.analyze(equations.H(), eliminated, options.preconditioner);
}

SolveStatus IterativeMethod::factorize(const VectorXd& damping, VectorXd*) {
  return reduced_.prepare(equations_.H(), equations_.offset(), damping, kPivotTolerance);
}

SolveStatus IterativeMethod::iterate(double tolerance, int max_iterations, bool is_rough_enough,
                                     VectorXd& x) {
  const BlockLower& H = equations_.H();
  const std::vector<int>& offset = equations_.offset();
  const EliminatedBlocks& eliminated = reduced_.eliminated();
  eliminated.reduceVector(H, offset, x);
  VectorXd rest;
  const auto outcome =
      conjugateGradients(reduced_, reduced_.reducedOf(x, offset), tolerance, max_iterations, rest);
  iterations_ += outcome.iterations;
  ++solutions_;
  if (!outcome.ok || !(outcome.has_converged || is_rough_enough))
    return {false, offset[static_cast<std::size_t>(eliminated.count())], 0};
  reduced_.putInto(rest, offset, x);
  eliminated.substitute(H, offset, x);
  return {};
}

SolveStatus IterativeMethod::solve(VectorXd& x) {
  const int enough = 10 * static_cast<int>(x.size()) + 100;
  return iterate(kExactTolerance, enough, false, x);
}

SolveStatus IterativeMethod::finishStep(VectorXd& x, bool) {
  return iterate(forcing(), options_.max_iterations, true, x);
}

double IterativeMethod::forcing() {
  const VectorXd &g = equations_.gradient(), &diagonal = equations_.diagonal();
  double squared = 0;
  for (Eigen::Index i = 0; i < g.size(); ++i) squared += diagonal[i] > 0 ? g[i] * g[i] / diagonal[i] : 0;
  largest_gradient_ = std::max(largest_gradient_, std::sqrt(squared));
  if (!(largest_gradient_ > 0)) return options_.forcing;
  return std::min(options_.forcing, std::sqrt(std::sqrt(squared) / largest_gradient_));
}

std::string IterativeMethod::description() const {
  std::string text = system_ + ", conjugate gradients with ";
  switch (reduced_.preconditioner()) {
    case BlockSolverOptions::Preconditioner::schur_jacobi:
      text += reduced_.eliminated().count() > 0 ? "Schur-Jacobi" : "block Jacobi";
      break;
    case BlockSolverOptions::Preconditioner::block_jacobi:
      text += "block Jacobi";
      break;
    case BlockSolverOptions::Preconditioner::power_series:
      text += "power series";
      break;
  }
  text += " preconditioner";
  if (solutions_ == 0) return text;
  return text + ", " + std::to_string(static_cast<int>(std::lround(iterations_ / solutions_))) +
         " iterations per step";
}

}  // namespace slom
