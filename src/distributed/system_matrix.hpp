/// SystemMatrix: PETSc's matrix of a BlockAssembly, or a product in its place.
#pragma once

#include <cstdint>
#include <functional>
#include <petscmat.h>

#include <Eigen/Core>

#include "distributed/block_assembly.hpp"
#include "slom/distributed/petsc_solver.hpp"

namespace slom::distributed {

/// A symmetric matrix with own rows first ... first + count - 1 in each process.
class SystemMatrix {
 public:
  /// Computes y := S x for own rows, in all processes.
  using Product = std::function<void(const double* x, double* y)>;

  SystemMatrix() = default;
  ~SystemMatrix() { destroy(); }
  SystemMatrix(const SystemMatrix&) = delete;
  SystemMatrix& operator=(const SystemMatrix&) = delete;

  /// Makes the matrix in the form that suits the method. `block_size`: of all blocks; 1: they differ. With a `product`,
  /// `blocks` has the diagonal blocks alone.
  void create(const BlockAssembly& blocks, std::int64_t first, int count, int block_size, PetscMethod method,
              Product product);
  void destroy();
  /// Takes the numbers of the blocks, with `added_diagonal` on the diagonal.
  void fill(const BlockAssembly& blocks, double added_diagonal);
  /// Names vectors of own rows that the matrix nearly maps to 0.
  void setNearNullSpace(const Eigen::MatrixXd& motions);

  /// Returns the matrix of the blocks, for preconditioners.
  Mat blocks() const { return A_; }
  /// Returns the matrix of the system: the product if there is one.
  Mat system() const { return S_ != nullptr ? S_ : A_; }
  bool hasProduct() const { return S_ != nullptr; }

 private:
  void setOptions();
  MatType type(PetscMethod method, bool has_rows_everywhere) const;
  static PetscErrorCode multiply(Mat S, Vec x, Vec y);

  Mat A_ = nullptr, S_ = nullptr;
  Product product_;
  std::int64_t first_ = 0;
  int count_ = 0, block_size_ = 1;
};

}  // namespace slom::distributed
