/// Methods by which the block solver solves (H + damping) x = b for a given H, and the choice among them.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "normal_equations.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

/// Fraction of its diagonal entry below which a pivot is rounding error.
inline constexpr double kPivotTolerance = 1e-12;

/// A method. Vectors are by unknown; damping may be empty.
class BlockMethod {
 public:
  virtual ~BlockMethod() = default;

  /// Prepares solutions with H + damping, unless that is prepared already. x, if given, is the right-hand side of a
  /// step; exact methods solve it forward at the same time.
  SolveStatus prepare(const Eigen::VectorXd& damping, Eigen::VectorXd* x = nullptr);
  /// Solves x, which was given to prepare(), as exactly as a step needs.
  SolveStatus solveStep(Eigen::VectorXd& x) { return finishStep(x, is_forward_solved_); }
  /// Returns the number of calls of prepare() that did work.
  long preparations() const { return preparations_; }
  /// Forgets what is prepared. Call it whenever H has new numbers.
  void forget() { has_undamped_ = false; }

  /// Computes x := (H + damping)^-1 x, to rounding.
  virtual SolveStatus solve(Eigen::VectorXd& x) = 0;
  /// Does the same for each column of X. After a failure, X is undefined.
  virtual SolveStatus solveColumns(Eigen::MatrixXd& X);
  /// Returns blocks of the inverse, see BlockSolver; null if there is no factor.
  virtual std::unique_ptr<InverseBlocks> invertBlocks() = 0;
  virtual bool isExact() const = 0;
  virtual double flops() const = 0;
  virtual std::string description() const = 0;

 protected:
  virtual SolveStatus factorize(const Eigen::VectorXd& damping, Eigen::VectorXd* x) = 0;
  virtual SolveStatus finishStep(Eigen::VectorXd& x, bool is_forward_solved) = 0;

 private:
  bool has_undamped_ = false;
  long preparations_ = 0;
  bool is_forward_solved_ = false;  // true: the right-hand side of the last prepare()
  SolveStatus undamped_status_;
};

/// Chooses a method and lays out the equations for it. The equations must outlive the method.
std::unique_ptr<BlockMethod> chooseMethod(const BlockStructure& structure, const BlockSolverOptions& options,
                                          NormalEquations& equations);

}  // namespace slom
