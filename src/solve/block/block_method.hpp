/// The ways in which the block solver solves (H + damping) x = b once H is there, and the choice among them.
#pragma once

#include <memory>
#include <string>

#include <Eigen/Core>

#include "normal_equations.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

/// A pivot below this share of its diagonal entry is rounding error.
inline constexpr double kPivotTolerance = 1e-12;

/// Vectors are by unknown; damping may be empty.
class BlockMethod {
 public:
  virtual ~BlockMethod() = default;

  /// Prepares solutions with H + damping; nothing is done where that is prepared already. x, where given, is the right-hand
  /// side of a step, which exact methods solve forward at the same time.
  SolveStatus prepare(const Eigen::VectorXd& damping, Eigen::VectorXd* x = nullptr);
  /// x := the solution for the x that was given to prepare(), as exact as a step needs it.
  SolveStatus solveStep(Eigen::VectorXd& x) { return finishStep(x, is_forward_solved_); }
  /// Number of calls of prepare() that had something to do.
  long preparations() const { return preparations_; }
  /// To be called whenever H has new numbers.
  void forget() { has_undamped_ = false; }

  /// x := (H + damping)^-1 x, to rounding.
  virtual SolveStatus solve(Eigen::VectorXd& x) = 0;
  /// See BlockSolver; null where there is no factor.
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
  bool is_forward_solved_ = false;  // the right-hand side given to the last prepare()
  SolveStatus undamped_status_;
};

/// Lays out the equations for what it chooses; they must outlive it.
std::unique_ptr<BlockMethod> chooseMethod(const BlockStructure& structure, const BlockSolverOptions& options,
                                          NormalEquations& equations);

}  // namespace slom
