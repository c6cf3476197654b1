#include "distributed/system_matrix.hpp"

#include <algorithm>
#include <petscpc.h>
#include <string>
#include <utility>
#include <vector>

#include "distributed/index.hpp"
#include "distributed/petsc_error.hpp"

namespace slom::distributed {

void SystemMatrix::destroy() {
  MatDestroy(&S_);
  MatDestroy(&A_);
}

void SystemMatrix::create(const BlockAssembly& blocks, std::int64_t first, int count, int block_size,
                          PetscMethod method, Product product) {
  destroy();
  product_ = std::move(product);
  first_ = first;
  count_ = count;
  block_size_ = block_size;
  // By rows of blocks: blocks here and elsewhere, and those of them on and above the diagonal.
  std::vector<PetscInt> here(at(count / block_size) + 1, 0), elsewhere(here), upper_here(here),
      upper_elsewhere(here);
  for (const BlockAssembly::Entry& entry : blocks.entries()) {
    const bool is_here = entry.column >= first && entry.column < first + count;
    for (int i = 0; i < entry.rows / block_size; ++i) {
      const std::size_t row = at(int(entry.row - first) / block_size + i);
      (is_here ? here : elsewhere)[row] += entry.columns / block_size;
      if (entry.column >= entry.row)
        (is_here ? upper_here : upper_elsewhere)[row] += entry.columns / block_size;
    }
  }
  require(MatCreate(PETSC_COMM_WORLD, &A_));
  require(MatSetSizes(A_, count, count, PETSC_DETERMINE, PETSC_DETERMINE));
  int least = count;
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD);
  require(MatSetType(A_, type(method, least > 0)));
  require(MatSetFromOptions(A_));
  require(MatXAIJSetPreallocation(A_, block_size, here.data(), elsewhere.data(), upper_here.data(),
                                  upper_elsewhere.data()));
  setOptions();
  if (!product_) return;
  require(MatCreateShell(PETSC_COMM_WORLD, count, count, PETSC_DETERMINE, PETSC_DETERMINE, this, &S_));
  require(MatShellSetOperation(S_, MATOP_MULT, reinterpret_cast<void (*)()>(&multiply)));
  require(MatSetOption(S_, MAT_SYMMETRIC, PETSC_TRUE));
}

void SystemMatrix::setOptions() {
  require(MatSetOption(A_, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  require(MatSetOption(A_, MAT_SYMMETRIC, PETSC_TRUE));
  require(MatSetOption(A_, MAT_SYMMETRY_ETERNAL, PETSC_TRUE));
  PetscBool is_half = PETSC_FALSE;
  require(
      PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(A_), &is_half, MATSEQSBAIJ, MATMPISBAIJ, ""));
  if (is_half == PETSC_TRUE) require(MatSetOption(A_, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
}

/// Returns the kind of matrix: blocks take less memory than rows of numbers, and of a half of them still less, but each
/// suits fewer preconditioners.
MatType SystemMatrix::type(PetscMethod method, bool has_rows_everywhere) const {
  if (block_size_ == 1 || method == PetscMethod::cholesky || method == PetscMethod::multigrid) return MATAIJ;
  char word[64] = "";
  PetscBool is_given = PETSC_FALSE, has_sub = PETSC_FALSE;
  require(PetscOptionsGetString(nullptr, nullptr, "-pc_type", word, sizeof word, &is_given));
  require(PetscOptionsHasName(nullptr, nullptr, "-sub_pc_type", &has_sub));
  const std::string preconditioner = word;
  if (is_given == PETSC_TRUE)
    return preconditioner == PCBJACOBI || preconditioner == PCPBJACOBI ? MATBAIJ : MATAIJ;
  const bool is_by_process = method == PetscMethod::block_jacobi || method == PetscMethod::matrix_free;
  // PETSc crashes where it factorises no rows of half a matrix.
  return is_by_process && has_sub == PETSC_FALSE && has_rows_everywhere ? MATSBAIJ : MATBAIJ;
}

/// PETSc's function for products.
PetscErrorCode SystemMatrix::multiply(Mat S, Vec x, Vec y) {
  SystemMatrix* own = nullptr;
  PetscErrorCode code = MatShellGetContext(S, &own);
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  if (code == 0) code = VecGetArrayRead(x, &from);
  if (code == 0) code = VecGetArray(y, &to);
  if (code != 0) return code;
  try {
    own->product_(from, to);
  } catch (...) {  // it must not pass through PETSc
    return PETSC_ERR_LIB;
  }
  code = VecRestoreArrayRead(x, &from);
  return code != 0 ? code : VecRestoreArray(y, &to);
}

void SystemMatrix::fill(const BlockAssembly& blocks, double added_diagonal) {
  std::vector<PetscInt> rows, columns;
  std::vector<PetscScalar> values;
  const auto& entries = blocks.entries();
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    const BlockAssembly::Entry& head = entries[begin];
    columns.clear();
    for (; end < entries.size() && entries[end].row == head.row; ++end) {
      for (int j = 0; j < entries[end].columns / block_size_; ++j)
        columns.push_back(PetscInt(entries[end].column / block_size_ + j));
    }
    values.clear();
    for (int i = 0; i < head.rows; ++i) {
      for (std::size_t e = begin; e < end; ++e) {
        const double* const block = blocks.values(entries[e]) + i * entries[e].columns;
        values.insert(values.end(), block, block + entries[e].columns);
        if (entries[e].column == head.row)
          values[values.size() - at(entries[e].columns - i)] += added_diagonal;
      }
    }
    rows.clear();
    for (int i = 0; i < head.rows / block_size_; ++i) rows.push_back(PetscInt(head.row / block_size_ + i));
    require((block_size_ > 1 ? MatSetValuesBlocked : MatSetValues)(A_, PetscInt(rows.size()), rows.data(),
                                                                   PetscInt(columns.size()), columns.data(),
                                                                   values.data(), INSERT_VALUES));
  }
  require(MatAssemblyBegin(A_, MAT_FINAL_ASSEMBLY));
  require(MatAssemblyEnd(A_, MAT_FINAL_ASSEMBLY));
}

void SystemMatrix::setNearNullSpace(const Eigen::MatrixXd& motions) {
  std::vector<Vec> basis;
  for (Eigen::Index k = 0; k < motions.cols(); ++k) {
    Vec v = nullptr;
    require(MatCreateVecs(A_, &v, nullptr));
    PetscScalar* values = nullptr;
    require(VecGetArray(v, &values));
    std::copy_n(motions.col(k).data(), count_, values);
    require(VecRestoreArray(v, &values));
    for (int pass = 0; pass < 2; ++pass) {
      for (const Vec earlier : basis) {
        PetscScalar product = 0;
        require(VecDot(v, earlier, &product));
        require(VecAXPY(v, -product, earlier));
      }
    }
    PetscReal norm = 0;
    require(VecNormalize(v, &norm));
    if (norm > 1e-8) {
      basis.push_back(v);
    } else {
      require(VecDestroy(&v));
    }
  }
  if (basis.empty()) return;
  MatNullSpace near = nullptr;
  require(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, PetscInt(basis.size()), basis.data(), &near));
  require(MatSetNearNullSpace(A_, near));
  require(MatNullSpaceDestroy(&near));
  for (Vec& v : basis) require(VecDestroy(&v));
}

}  // namespace slom::distributed
