/// ReducedSystem: normal equations in blocks, with small independent blocks eliminated, for solvers of the rest.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "slom/solve/linear_solver.hpp"

namespace slom {

/// Sums up H = J^T J and g = J^T r from linearised measurements, and eliminates many small blocks, no two of which
/// share a measurement, such as points that cameras see. The reduced matrix S = H_cc - W V^-1 W^T is for another
/// solver, such as one on several processes. Vectors have an entry for each unknown of the structure.
class ReducedSystem final : public JacobianSink {
 public:
  ReducedSystem();
  ~ReducedSystem() override;

  /// Plans the elimination. `stays`: by block, not 0 for a block that must not be eliminated; empty: none must stay.
  /// Call planBlocks() or planProducts() next.
  void analyze(const BlockStructure& structure, const std::vector<char>& stays);
  /// Returns how many numbers the blocks of the lower triangle of S have.
  std::size_t numbersOfS() const;
  /// Plans the computation of S.
  void planBlocks();
  /// Plans products with S, in the memory of H. Of S, only the diagonal blocks are computed.
  void planProducts();
  /// Returns whether the block is eliminated.
  bool isEliminated(int block) const;
  /// Returns the number of eliminated blocks.
  int eliminatedCount() const;

  void beginLinearization() override;
  void add(const JacobianBatch& batch) override;
  std::span<const MeasurementPlace> partitions() const override;
  void endLinearization() override;
  /// Returns g.
  const Eigen::VectorXd& gradient() const;
  /// Returns the diagonal of H.
  const Eigen::VectorXd& diagonal() const;
  /// Returns d^T H d.
  double squaredNormOfJd(const Eigen::VectorXd& d) const;

  /// Computes S with `damping` (an entry for each unknown; empty: none) added to the eliminated blocks alone. Replaces
  /// x, a right-hand side, by the right-hand side of S; its entries for eliminated blocks are then for substitute().
  SolveStatus reduce(const Eigen::VectorXd& damping, Eigen::VectorXd& x);
  /// Calls f(a, b, values) for each block of the lower triangle of S, after reduce(): dof_a x dof_b numbers,
  /// column-major, with whole diagonal blocks. The order is the same for one structure. After planProducts(), only the
  /// diagonal blocks come. Before reduce(), the values are undefined.
  void forEachBlock(const std::function<void(int a, int b, const double* values)>& f) const;
  /// Replaces another right-hand side by the right-hand side of S, after reduce().
  void forward(Eigen::VectorXd& x) const;
  /// Computes y := S x for the blocks that are not eliminated, after planProducts() and reduce(). y is 0 for the others.
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y);
  /// Computes x of the eliminated blocks from x of the others.
  void substitute(Eigen::VectorXd& x) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> own_;
};

}  // namespace slom
