#include "distributed/krylov.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <petscksp.h>
#include <utility>

#include "distributed/index.hpp"
#include "distributed/petsc_error.hpp"
#include "mtk/error.hpp"

namespace slom::distributed {

namespace {

/// Numbers of unknowns up to which MUMPS factorises, and from which multigrid pays.
constexpr std::int64_t kMostFactorised = 60'000, kFewestOfMultigrid = 600'000;
/// Fraction of a diagonal entry, 1 here, below which a pivot is rounding error.
constexpr double kLeastPivot = 1e-12;
/// Damping that gives a matrix without full rank a solution, which moves along its null space.
constexpr double kRegularization = 1e-9;

PetscMethod chosen(PetscMethod method, std::int64_t unknowns) {
  if (method != PetscMethod::automatic) return method;
  return unknowns <= kMostFactorised     ? PetscMethod::cholesky
         : unknowns < kFewestOfMultigrid ? PetscMethod::block_jacobi
                                         : PetscMethod::multigrid;
}

/// Returns a number between 1/2 and 1 for an unknown, always the same.
double scattered(std::int64_t unknown) {
  std::uint64_t bits = std::uint64_t(unknown) * 0x9e3779b97f4a7c15ULL;
  bits ^= bits >> 29;
  return 0.5 + 0.5 * double(bits >> 11) / double(std::uint64_t{1} << 53);
}

}  // namespace

struct Krylov::Implementation {
  explicit Implementation(const PetscSolverOptions& given) : options(given) {}
  ~Implementation() { destroy(); }

  void destroy() {
    KSPDestroy(&ksp);
    matrix.destroy();
    VecDestroy(&b);
    VecDestroy(&x);
  }
  void configure();
  void useMumps(PC pc) const;
  /// Returns the number of pivots of the factor that are 0 or negative; 0 if there is no such factor.
  int badPivots();
  bool isDirect() const;
  std::int64_t mostMoving();
  std::int64_t movingUnknown(const BlockAssembly& blocks);
  std::pair<std::int64_t, double> leastPivot();

  PetscSolverOptions options;
  SystemMatrix matrix;
  KSP ksp = nullptr;
  Vec b = nullptr, x = nullptr;
  std::int64_t first = 0, all = 0;
  int count = 0, block_size = 1;
  PetscMethod method = PetscMethod::automatic;
  long iterations = 0, cut_short = 0;
  bool wants_motions = false;
  bool has_given_tolerance = false;  // by -ksp_rtol
};

Krylov::Krylov(const PetscSolverOptions& options) : own_(new Implementation(options)) {}
Krylov::~Krylov() = default;

std::optional<bool> Krylov::wantsProducts() const {
  char text[32] = "";
  PetscBool is_set = PETSC_FALSE;
  require(PetscOptionsGetString(nullptr, nullptr, "-slom_matrix", text, sizeof text, &is_set));
  const std::string word = text;
  if (is_set == PETSC_TRUE && word != "free" && word != "assembled") {
    throw mtk::Error("slom.petsc-option",
                     "-slom_matrix " + word + ": unknown form of the matrix; give free or assembled",
                     "-slom_matrix");
  }
  if (is_set == PETSC_TRUE) return word == "free";
  if (own_->options.method == PetscMethod::automatic) return std::nullopt;
  return own_->options.method == PetscMethod::matrix_free;
}

void Krylov::plan(const BlockAssembly& blocks, std::int64_t first, int count, int block_size,
                  Product product) {
  Implementation& own = *own_;
  own.destroy();
  own.first = first;
  own.count = count;
  own.block_size = block_size;
  own.all = count;
  MPI_Allreduce(MPI_IN_PLACE, &own.all, 1, MPI_INT64_T, MPI_SUM, PETSC_COMM_WORLD);
  own.method = product ? PetscMethod::matrix_free : chosen(own.options.method, own.all);
  own.matrix.create(blocks, first, count, block_size, own.method, std::move(product));
  require(MatCreateVecs(own.matrix.blocks(), &own.x, &own.b));
  own.configure();
}

void Krylov::Implementation::useMumps(PC pc) const {
  require(PCSetType(pc, PCCHOLESKY));
  require(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  require(PCFactorSetUpMatSolverType(pc));
  Mat F = nullptr;
  require(PCFactorGetMatrix(pc, &F));
  require(MatMumpsSetIcntl(F, 24, 1));   // look for pivots that are 0
  require(MatMumpsSetIcntl(F, 14, 50));  // room for more fill than estimated [%]
  require(MatMumpsSetCntl(F, 1, 0));     // no pivoting: the matrix is positive definite, or rank is lost
  require(MatMumpsSetCntl(F, 3, -kLeastPivot));  // an absolute limit
}

void Krylov::Implementation::configure() {
  require(KSPCreate(PETSC_COMM_WORLD, &ksp));
  require(KSPSetOperators(ksp, matrix.system(), matrix.blocks()));
  require(KSPSetNormType(ksp, KSP_NORM_DEFAULT));
  require(KSPSetTolerances(ksp, options.tolerance, 1e-300, PETSC_DEFAULT, options.max_iterations));
  PC pc = nullptr;
  require(KSPGetPC(ksp, &pc));
  require(KSPSetType(ksp, KSPCG));
  switch (method) {
    case PetscMethod::automatic:
    case PetscMethod::cholesky:
      require(KSPSetType(ksp, KSPPREONLY));
      useMumps(pc);
      break;
    case PetscMethod::jacobi:
      require(PCSetType(pc, block_size > 1 ? PCPBJACOBI : PCJACOBI));
      break;
    case PetscMethod::block_jacobi:
    case PetscMethod::matrix_free:
      require(PCSetType(pc, PCBJACOBI));
      break;
    case PetscMethod::schwarz:
      require(PCSetType(pc, PCASM));
      require(PCASMSetType(pc, PC_ASM_BASIC));  // the restricted form is not symmetric
      break;
    case PetscMethod::multigrid:
      require(PCSetType(pc, PCGAMG));
      break;
  }
  require(KSPSetFromOptions(ksp));
  PetscBool is_given = PETSC_FALSE;
  require(PetscOptionsHasName(nullptr, nullptr, "-ksp_rtol", &is_given));
  has_given_tolerance = is_given == PETSC_TRUE;
  PetscBool is_cholesky = PETSC_FALSE;
  require(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &is_cholesky, PCCHOLESKY, PCLU, ""));
  PetscBool is_scalar = PETSC_FALSE;
  require(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(matrix.blocks()), &is_scalar, MATSEQAIJ,
                                    MATMPIAIJ, ""));
  // A matrix that is said to be positive definite is factorised without a look for pivots that are 0. PETSc refuses to
  // hear it of matrices in blocks.
  if (is_cholesky == PETSC_FALSE && is_scalar == PETSC_TRUE)
    require(MatSetOption(matrix.blocks(), MAT_SPD, PETSC_TRUE));
  PetscBool is_multigrid = PETSC_FALSE;
  require(PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &is_multigrid, PCGAMG, PCML, ""));
  wants_motions = is_multigrid == PETSC_TRUE;
}

bool Krylov::Implementation::isDirect() const {
  PetscBool is_direct = PETSC_FALSE;
  if (ksp != nullptr) PetscObjectTypeCompare(reinterpret_cast<PetscObject>(ksp), KSPPREONLY, &is_direct);
  return is_direct == PETSC_TRUE;
}

int Krylov::Implementation::badPivots() {
  PC pc = nullptr;
  require(KSPGetPC(ksp, &pc));
  PetscBool is_cholesky = PETSC_FALSE;
  require(PetscObjectTypeCompare(reinterpret_cast<PetscObject>(pc), PCCHOLESKY, &is_cholesky));
  MatSolverType solver = nullptr;
  if (is_cholesky == PETSC_TRUE) require(PCFactorGetMatSolverType(pc, &solver));
  if (solver == nullptr || std::strcmp(solver, MATSOLVERMUMPS) != 0) return 0;
  Mat F = nullptr;
  require(PCFactorGetMatrix(pc, &F));
  PetscInt none = 0, negative = 0;
  require(MatMumpsGetInfog(F, 28, &none));
  require(MatMumpsGetInfog(F, 12, &negative));
  return int(none + negative);
}

/// Returns an unknown that moves most in one step of inverse iteration.
std::int64_t Krylov::Implementation::mostMoving() {
  PetscScalar* values = nullptr;
  require(VecGetArray(b, &values));
  for (int i = 0; i < count; ++i) values[i] = scattered(first + i);
  require(VecRestoreArray(b, &values));
  require(KSPSolve(ksp, b, x));
  require(VecAbs(x));
  PetscInt place = -1;
  PetscReal largest = 0;
  require(VecMax(x, &place, &largest));
  return place;
}

/// Finds an unknown that moves along the null space.
std::int64_t Krylov::Implementation::movingUnknown(const BlockAssembly& blocks) {
  matrix.fill(blocks, kRegularization);
  require(KSPSetUp(ksp));
  return mostMoving();
}

/// Returns the unknown that moves most, and the pivot that it would have as the last one: 1 over its entry of the
/// inverse. MUMPS takes a pivot that is rounding error for a good one if it is the last of a front.
std::pair<std::int64_t, double> Krylov::Implementation::leastPivot() {
  const std::int64_t unknown = mostMoving();
  require(VecSet(b, 0));
  if (unknown >= first && unknown < first + count)
    require(VecSetValue(b, PetscInt(unknown), 1, INSERT_VALUES));
  require(VecAssemblyBegin(b));
  require(VecAssemblyEnd(b));
  require(KSPSolve(ksp, b, x));
  PetscScalar variance = 0;
  require(VecDot(b, x, &variance));
  return {unknown, variance > 0 ? 1 / variance : 0};
}

Prepared Krylov::prepare(const BlockAssembly& blocks, const std::function<Eigen::MatrixXd()>& motions) {
  Implementation& own = *own_;
  if (own.all == 0) return {};
  own.matrix.fill(blocks, 0);
  if (own.wants_motions) {
    own.matrix.setNearNullSpace(motions());
    require(KSPDestroy(&own.ksp));  // the levels of earlier numbers would not suit these
    own.configure();
  }
  require(KSPSetOperators(own.ksp, own.matrix.system(), own.matrix.blocks()));
  require(KSPSetUp(own.ksp));
  require(KSPSetUpOnBlocks(own.ksp));
  PC pc = nullptr;
  require(KSPGetPC(own.ksp, &pc));
  PCFailedReason failed = PC_NOERROR;
  require(PCGetFailedReason(pc, &failed));
  if (failed == PC_NOERROR && own.badPivots() == 0) {
    if (!own.isDirect()) return {};
    const auto [unknown, pivot] = own.leastPivot();
    return pivot >= kLeastPivot ? Prepared{} : Prepared{false, unknown};
  }
  if (!own.isDirect()) return {false, -1};
  return {false, own.movingUnknown(blocks)};
}

bool Krylov::solveStep(Eigen::VectorXd& x, double tolerance) {
  PetscReal given = 0;
  if (own_->has_given_tolerance) require(KSPGetTolerances(own_->ksp, &given, nullptr, nullptr, nullptr));
  return solveTo(x, own_->has_given_tolerance ? given : tolerance, true);
}

bool Krylov::solve(Eigen::VectorXd& x) {
  constexpr double careful = 1e-2;
  return solveTo(x, careful * own_->options.tolerance, false);
}

bool Krylov::solveTo(Eigen::VectorXd& x, double tolerance, bool is_step) {
  Implementation& own = *own_;
  if (own.all == 0) return true;
  PetscReal relative = 0, absolute = 0, divergence = 0;
  PetscInt most = 0;
  require(KSPGetTolerances(own.ksp, &relative, &absolute, &divergence, &most));
  require(KSPSetTolerances(own.ksp, tolerance, absolute, divergence, most));
  PetscScalar* values = nullptr;
  require(VecGetArray(own.b, &values));
  std::copy_n(x.data(), own.count, values);
  require(VecRestoreArray(own.b, &values));
  require(KSPSolve(own.ksp, own.b, own.x));
  require(KSPSetTolerances(own.ksp, relative, absolute, divergence, most));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  require(KSPGetConvergedReason(own.ksp, &reason));
  PetscInt iterations = 0;
  require(KSPGetIterationNumber(own.ksp, &iterations));
  own.iterations += iterations;
  if (reason == KSP_DIVERGED_ITS && is_step) ++own.cut_short;
  const PetscScalar* solution = nullptr;
  require(VecGetArrayRead(own.x, &solution));
  std::copy_n(solution, own.count, x.data());
  require(VecRestoreArrayRead(own.x, &solution));
  // A step that is not found to the tolerance still leads downhill.
  return reason > 0 || (is_step && reason == KSP_DIVERGED_ITS);
}

bool Krylov::isExact() const { return own_->isDirect(); }
long Krylov::iterations() const { return own_->iterations; }

std::string Krylov::description() const {
  if (own_->ksp == nullptr) return "PETSc, which has solved nothing yet";
  KSPType ksp_type = nullptr;
  PCType pc_type = nullptr;
  PC pc = nullptr;
  KSPGetPC(own_->ksp, &pc);
  KSPGetType(own_->ksp, &ksp_type);
  PCGetType(pc, &pc_type);
  int processes = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &processes);
  MatSolverType solver = nullptr;
  PetscBool is_factor = PETSC_FALSE;
  PetscObjectTypeCompareAny(reinterpret_cast<PetscObject>(pc), &is_factor, PCCHOLESKY, PCLU, "");
  if (is_factor == PETSC_TRUE) PCFactorGetMatSolverType(pc, &solver);
  const std::string name = [&]() -> std::string {
    const std::string pc_name = pc_type == nullptr ? "" : pc_type;
    if (own_->isDirect()) return pc_name + (solver != nullptr ? std::string(" by ") + solver : "");
    return std::string(ksp_type == nullptr ? "" : ksp_type) + " with " + pc_name +
           (own_->matrix.hasProduct() ? ", without a matrix" : "");
  }();
  return "PETSc on " + std::to_string(processes) + (processes == 1 ? " process: " : " processes: ") + name +
         ", " + std::to_string(own_->all) + " unknowns" +
         (own_->cut_short == 0
              ? ""
              : "; " + std::to_string(own_->cut_short) + " solutions not found to the tolerance");
}

}  // namespace slom::distributed
