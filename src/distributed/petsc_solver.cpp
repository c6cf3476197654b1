#include "slom/distributed/petsc_solver.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "distributed/block_assembly.hpp"
#include "distributed/index.hpp"
#include "distributed/krylov.hpp"
#include "distributed/ownership.hpp"
#include "slom/distributed/processes.hpp"
#include "slom/model/gauge_generators.hpp"
#include "slom/solve/reduced_system.hpp"

namespace slom::distributed {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The processes, with the unknowns of a problem.
class SolvingProcesses final : public Processes {
 public:
  double dot(const VectorXd& a, const VectorXd& b) const override {
    if (isAlone()) return a.dot(b);
    double own = 0;
    for (const auto& [first, count] : own_ranges) own += a.segment(first, count).dot(b.segment(first, count));
    return sum(own);
  }
  bool counts(int block) const override { return ownership.isOwn(block); }

  Ownership ownership;
  std::vector<std::pair<int, int>> own_ranges;  // first unknown and count
};

namespace {

/// Adds the time of its life to a sum.
class Timer {
 public:
  explicit Timer(double& seconds) : seconds_(seconds) {}
  ~Timer() { seconds_ += std::chrono::duration<double>(Clock::now() - start_).count(); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point start_ = Clock::now();
};

}  // namespace

struct PetscSolver::Implementation {
  Implementation(const Problem& table, SharedVariables all_shared, const PetscSolverOptions& given)
      : problem(table), shared(std::move(all_shared)), options(given), krylov(given) {}

  void number();
  void planBlocks();
  SolveStatus prepare(const VectorXd& damping, VectorXd& x);
  SolveStatus agreed(SolveStatus status) const;
  VectorXd scaleFor(const VectorXd& damping) const;
  void sumBlocks(const VectorXd& damping);
  SolveStatus statusOf(const Prepared& prepared) const;
  MatrixXd motions();
  double toleranceOfStep();
  bool finish(VectorXd& x, double tolerance_of_step);
  void chooseForm();
  void multiply(const double* x, double* y);

  /// Calls f(block, first local unknown, first own row) for each own block that remains.
  template <class F>
  void forEachOwn(const F& f) const {
    for (const int b : own_blocks) f(b, structure.offset[at(b)], int(row[at(b)] - first_row));
  }

  const Problem& problem;
  SharedVariables shared;
  PetscSolverOptions options;
  SolvingProcesses processes;
  BlockStructure structure;
  ReducedSystem system;
  BlockAssembly assembly;
  Krylov krylov;
  VectorXd gradient, diagonal, scale;
  std::vector<int> own_blocks;     // those that remain, ascending
  std::vector<std::int64_t> row;   // by block that remains: its first row across all processes
  std::vector<std::int64_t> rows;  // first row of each process; one more for the end
  std::int64_t first_row = 0;
  int row_count = 0;
  bool is_prepared = false;      // without damping
  bool shares_nothing = false;   // although there are several processes
  bool is_free = false;          // products instead of a matrix
  VectorXd damping_of_products;  // by unknown, or empty
  double largest_gradient = 0;   // so far, scaled by the diagonal
  long preparations = 0;
  SolveStatus prepared_status;
};

PetscSolver::PetscSolver(const Estimator& est, SharedVariables shared, const PetscSolverOptions& options)
    : own_(new Implementation(est.table(), std::move(shared), options)) {}
PetscSolver::~PetscSolver() = default;

const Problem& PetscSolver::table() const { return own_->problem; }

bool PetscSolver::hasUnknowns(int variable) const {
  return variable < own_->structure.blockCount() && !own_->structure.isEmpty(variable);
}

void PetscSolver::analyze(const BlockStructure& structure) {
  Implementation& own = *own_;
  ++counts_.analyses;
  own.is_prepared = false;
  own.largest_gradient = 0;
  own.structure = structure;
  own.processes.ownership.find(own.processes, own.problem, own.structure, own.shared);
  own.shares_nothing = !own.processes.isAlone() && own.processes.all(own.shared.entries().empty());
  own.processes.agree([&] { own.system.analyze(own.structure, own.processes.ownership.isShared()); });
  own.chooseForm();
  own.number();
  own.planBlocks();
}

/// Chooses between the blocks of the remaining system and products with it.
void PetscSolver::Implementation::chooseForm() {
  // A number of S is here, and for both triangles in the assembly and in PETSc, there with its column.
  constexpr double bytes_of_number = 8 + 2 * 8 + 2 * 12, most_bytes = 4e9;
  processes.agree([&] {
    const std::optional<bool> wanted = krylov.wantsProducts();
    is_free = wanted ? *wanted : bytes_of_number * double(system.numbersOfS()) > most_bytes;
  });
  is_free = processes.any(is_free);
  processes.agree([&] {
    if (is_free) {
      system.planProducts();
    } else {
      system.planBlocks();
    }
  });
}

/// Numbers the rows of the remaining system: those of each process one after another.
void PetscSolver::Implementation::number() {
  own_blocks.clear();
  processes.own_ranges.clear();
  row_count = 0;
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (structure.isEmpty(b) || !processes.counts(b)) continue;
    auto& ranges = processes.own_ranges;
    if (!ranges.empty() && ranges.back().first + ranges.back().second == structure.offset[at(b)]) {
      ranges.back().second += structure.dof(b);
    } else {
      ranges.emplace_back(structure.offset[at(b)], structure.dof(b));
    }
    if (system.isEliminated(b)) continue;
    own_blocks.push_back(b);
    row_count += structure.dof(b);
  }
  rows.assign(1, 0);
  for (const std::string& text : processes.gather(std::to_string(row_count)))
    rows.push_back(rows.back() + std::stoll(text));
  first_row = rows[at(processes.rank())];
  row.assign(at(structure.blockCount()), -1);
  std::int64_t next = first_row;
  for (const int b : own_blocks) {
    row[at(b)] = next;
    next += structure.dof(b);
  }
  processes.ownership.spread(processes, row);
}

void PetscSolver::Implementation::planBlocks() {
  const auto owner = [&](std::int64_t first) {
    return int(std::upper_bound(rows.begin(), rows.end(), first) - rows.begin()) - 1;
  };
  std::vector<BlockAssembly::Block> blocks;
  system.forEachBlock([&](int a, int b, const double*) {
    blocks.push_back(
        {row[at(a)], row[at(b)], structure.dof(a), structure.dof(b), owner(row[at(a)]), owner(row[at(b)])});
  });
  assembly.plan(processes, blocks);
  int smallest = std::numeric_limits<int>::max(), largest = 0;
  for (const int b : own_blocks) {
    smallest = std::min(smallest, structure.dof(b));
    largest = std::max(largest, structure.dof(b));
  }
  const int smallest_of_all = int(-processes.max(-double(smallest))),
            largest_of_all = int(processes.max(largest));
  krylov.plan(assembly, first_row, row_count, smallest_of_all == largest_of_all ? largest_of_all : 1,
              is_free ? [this](const double* x, double* y) { multiply(x, y); } : Krylov::Product());
}

void PetscSolver::beginLinearization() {
  own_->is_prepared = false;
  own_->system.beginLinearization();
}
void PetscSolver::add(const JacobianBatch& batch) { own_->system.add(batch); }
std::span<const MeasurementPlace> PetscSolver::partitions() const { return own_->system.partitions(); }
void PetscSolver::endLinearization() {
  own_->system.endLinearization();
  own_->gradient = own_->system.gradient();
  own_->diagonal = own_->system.diagonal();
}

void PetscSolver::completeLinearization() {
  own_->processes.ownership.addUp(own_->processes, {&own_->gradient, &own_->diagonal});
}

const Collective& PetscSolver::collective() const { return own_->processes; }

/// Returns the failure of all processes if any failed.
SolveStatus PetscSolver::Implementation::agreed(SolveStatus status) const {
  if (processes.all(status.ok)) return status;
  return status.ok ? SolveStatus{false, -1, 0, 0} : status;
}

VectorXd PetscSolver::Implementation::scaleFor(const VectorXd& damping) const {
  VectorXd size = diagonal;
  if (damping.size() > 0) size += damping;
  return size.unaryExpr([](double s) { return s > 0 && std::isfinite(s) ? 1 / std::sqrt(s) : 1.0; });
}

/// Sums up the remaining system, with rows and columns scaled so that H + damping has the diagonal 1.
void PetscSolver::Implementation::sumBlocks(const VectorXd& damping) {
  assembly.begin();
  std::vector<double> scaled;
  system.forEachBlock([&](int a, int b, const double* values) {
    const int rows_a = structure.dof(a), columns_b = structure.dof(b);
    scaled.resize(at(rows_a * columns_b));
    double* to = scaled.data();
    for (int j = 0; j < columns_b; ++j) {
      for (int i = 0; i < rows_a; ++i)
        *to++ = *values++ * scale[structure.offset[at(a)] + i] * scale[structure.offset[at(b)] + j];
    }
    if (a == b && damping.size() > 0 && processes.counts(a)) {
      for (int i = 0; i < rows_a; ++i) {
        const int unknown = structure.offset[at(a)] + i;
        scaled[at(i * rows_a + i)] += damping[unknown] * scale[unknown] * scale[unknown];
      }
    }
    assembly.add(scaled.data());
  });
  assembly.finish(processes);
}

SolveStatus PetscSolver::Implementation::statusOf(const Prepared& prepared) const {
  if (prepared.ok) return {};
  SolveStatus status{false, -1, 0, 0};
  const std::int64_t local = prepared.unknown - first_row;
  if (prepared.unknown < 0 || local < 0 || local >= row_count) return status;
  forEachOwn([&](int b, int unknown, int own_row) {
    if (local >= own_row && local < own_row + structure.dof(b))
      status.unknown = unknown + int(local) - own_row;
  });
  return status;
}

/// Multiplies own rows by the scaled system with damping.
void PetscSolver::Implementation::multiply(const double* x, double* y) {
  VectorXd moved = VectorXd::Zero(structure.unknowns()), image;
  forEachOwn([&](int b, int unknown, int own_row) {
    for (int i = 0; i < structure.dof(b); ++i) moved[unknown + i] = x[own_row + i] * scale[unknown + i];
  });
  processes.ownership.spread(processes, moved);
  system.multiply(moved, image);
  processes.ownership.addUpAtOwners(processes, {&image});
  forEachOwn([&](int b, int unknown, int own_row) {
    for (int i = 0; i < structure.dof(b); ++i) {
      const int u = unknown + i;
      y[own_row + i] =
          scale[u] * (image[u] + (damping_of_products.size() > 0 ? damping_of_products[u] * moved[u] : 0));
    }
  });
}

/// Prepares solutions with H + damping, and turns x into the right-hand side of the remaining system.
SolveStatus PetscSolver::Implementation::prepare(const VectorXd& damping, VectorXd& x) {
  // A process without unknowns has an empty vector in any case.
  const bool is_damped = processes.any(damping.size() > 0);
  if (!is_damped && is_prepared) {
    system.forward(x);
    return prepared_status;
  }
  const SolveStatus reduced = agreed(system.reduce(damping, x));
  if (!reduced.ok) return reduced;
  ++preparations;
  scale = scaleFor(damping);
  if (is_free) damping_of_products = damping;
  sumBlocks(damping);
  prepared_status = statusOf(krylov.prepare(assembly, [this] { return motions(); }));
  is_prepared = !is_damped;
  return prepared_status;
}

/// Returns the motions of the world, in own rows of the scaled system, that hardly change any residual.
MatrixXd PetscSolver::Implementation::motions() {
  constexpr double hardly = 1e-2;  // of |J_i| |d_i|, all unknowns together
  MatrixXd best(row_count, 0);
  for (const WorldRole role : {WorldRole::in_world, WorldRole::sees_world}) {
    MatrixXd moved = MatrixXd::Zero(structure.unknowns(), kGaugeGenerators);
    std::vector<double> generators;
    for (int v = 0; v < structure.blockCount(); ++v) {
      if (structure.isEmpty(v)) continue;
      const VariableRecord& record = problem.variables()[at(v)];
      generators.assign(at(record.dof * kGaugeGenerators), 0.0);
      record.store->gaugeGenerators(problem.linearizationPoint(v), role, generators.data());
      moved.middleRows(structure.offset[at(v)], record.dof) =
          Eigen::Map<const MatrixXd>(generators.data(), record.dof, kGaugeGenerators);
    }
    std::vector<int> kept;
    for (int k = 0; k < kGaugeGenerators; ++k) {
      const VectorXd motion = moved.col(k);
      const double size = processes.dot(diagonal, motion.cwiseAbs2());
      const double change = processes.sum(system.squaredNormOfJd(motion));
      if (size > 0 && change <= hardly * size) kept.push_back(k);
    }
    if (int(kept.size()) <= best.cols()) continue;
    best.resize(row_count, Eigen::Index(kept.size()));
    for (std::size_t k = 0; k < kept.size(); ++k) {
      forEachOwn([&](int b, int unknown, int own_row) {
        for (int i = 0; i < structure.dof(b); ++i)
          best(own_row + i, Eigen::Index(k)) = moved(unknown + i, kept[k]) / scale[unknown + i];
      });
    }
  }
  return best;
}

/// Returns the tolerance of conjugate gradients for the next step (PetscSolverOptions::forcing).
double PetscSolver::Implementation::toleranceOfStep() {
  if (krylov.isExact()) return options.tolerance;
  const auto inverse = [](double s) { return s > 0 ? 1 / s : 0.0; };
  const double size = std::sqrt(processes.dot(gradient.cwiseProduct(diagonal.unaryExpr(inverse)), gradient));
  largest_gradient = std::max(largest_gradient, size);
  const double falling = largest_gradient > 0 ? std::sqrt(size / largest_gradient) : 1;
  return std::max(options.tolerance, std::min(options.forcing, falling));
}

/// Solves the remaining system for x, which has its right-hand side, and substitutes. `tolerance_of_step`: of a step; 0:
/// of other solutions. Returns false if PETSc failed.
bool PetscSolver::Implementation::finish(VectorXd& x, double tolerance_of_step) {
  VectorXd remaining = x;
  // Every process has its part of the right-hand side at the unknowns that it shares.
  processes.ownership.addUp(processes, {&remaining});
  VectorXd own_rows(row_count);
  forEachOwn([&](int b, int unknown, int own_row) {
    for (int i = 0; i < structure.dof(b); ++i)
      own_rows[own_row + i] = remaining[unknown + i] * scale[unknown + i];
  });
  if (!(tolerance_of_step > 0 ? krylov.solveStep(own_rows, tolerance_of_step) : krylov.solve(own_rows)))
    return false;
  forEachOwn([&](int b, int unknown, int own_row) {
    for (int i = 0; i < structure.dof(b); ++i) x[unknown + i] = own_rows[own_row + i] * scale[unknown + i];
  });
  processes.ownership.spread(processes, x);
  system.substitute(x);
  return true;
}

SolveStatus PetscSolver::solve(const VectorXd& damping, VectorXd& step) {
  VectorXd x = -own_->system.gradient();
  {
    const Timer timer(seconds_.factorize);
    const SolveStatus status = own_->prepare(damping, x);
    counts_.factorizations = own_->preparations;
    if (!status.ok) return status;
  }
  const Timer timer(seconds_.solve);
  if (!own_->finish(x, own_->toleranceOfStep())) return {false, -1, 0, 0};
  step = std::move(x);
  return {};
}

SolveStatus PetscSolver::solveFor(const MatrixXd& B, MatrixXd& X) {
  MatrixXd all(B.rows(), B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j) {
    VectorXd x = B.col(j);
    const SolveStatus status = own_->prepare({}, x);
    if (!status.ok) return status;
    if (!own_->finish(x, 0)) return {false, -1, 0, 0};
    all.col(j) = x;
  }
  X = std::move(all);
  return {};
}

bool PetscSolver::isExact() const { return own_->krylov.isExact(); }
const VectorXd& PetscSolver::gradient() const { return own_->gradient; }
const VectorXd& PetscSolver::diagonal() const { return own_->diagonal; }
double PetscSolver::squaredNormOfJd(const VectorXd& d) const {
  return own_->processes.sum(own_->system.squaredNormOfJd(d));
}
std::string PetscSolver::description() const {
  return own_->krylov.description() +
         (own_->shares_nothing ? "; no shared variables, so each process fits a problem of its own" : "");
}
long PetscSolver::iterations() const { return own_->krylov.iterations(); }

}  // namespace slom::distributed
