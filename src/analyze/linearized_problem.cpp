#include "analyze/linearized_problem.hpp"

#include <algorithm>
#include <optional>

#include "analyze/diagnose.hpp"
#include "analyze/free_network.hpp"
#include "analyze/null_space.hpp"
#include "analyze/singular.hpp"
#include "base/index.hpp"
#include "optimize/active_bounds.hpp"
#include "optimize/lengths.hpp"
#include "optimize/second_look.hpp"
#include "slom/solve/block_solver.hpp"

namespace slom {

using Eigen::MatrixXd;

namespace {

/// Largest variance inflation at which the normal equations are trusted. Beyond it, variances would have fewer than 6 digits.
constexpr double kMostInflation = 1e10;
constexpr int kMostCarefulUnknowns = 20'000;  // above, factorising J takes long

}  // namespace

struct LinearizedProblem::Results {
  /// A sink that keeps all rows it receives.
  struct RowKeeper final : JacobianSink {
    JacobianRows rows, unweighted;

    void beginLinearization() override {
      rows.clear();
      unweighted.clear();
    }
    void add(const JacobianBatch& batch) override { rows.add(batch); }
    bool wantsUnweighted() const override { return true; }
    void addUnweighted(const JacobianBatch& batch) override { unweighted.add(batch); }
    void endLinearization() override {}
  };

  RowKeeper kept;
  ActiveSet active;
  Eigen::VectorXd gradient, diagonal;
  double rss = 0, squared_norm = 0;
  bool is_linearized = false;

  std::unique_ptr<LinearSolver> exact;    // in place of the lent solver, if that iterates
  std::unique_ptr<LinearSolver> careful;  // in place of the solver before it, if that found a loss of rank
  bool careful_failed = false;
  SolveStatus careful_status;
  std::uint64_t content = ~std::uint64_t{0};  // Evaluator::contentOfSolver() once these rows are in it

  std::unique_ptr<InverseBlocks> inverse;
  std::unique_ptr<FreeNetwork> free_network;
  std::unique_ptr<NearNullSpace> null_space;
  std::optional<int> free_directions;
  std::optional<Diagnosis> diagnosis;
};

LinearizedProblem::LinearizedProblem(const Problem& problem, Evaluator& evaluator)
    : problem_(problem),
      evaluator_(evaluator),
      structure_(evaluator.structure()),
      structure_revision_(problem.structureRevision()),
      value_revision_(problem.valueRevision()),
      results_(new Results) {}

LinearizedProblem::~LinearizedProblem() = default;

bool LinearizedProblem::isCurrent() const {
  return structure_revision_ == problem_.structureRevision() && value_revision_ == problem_.valueRevision();
}

void LinearizedProblem::linearize() const {
  Results& own = *results_;
  if (own.is_linearized) return;
  own.kept.rows.analyze(structure_.system);
  own.kept.unweighted.analyze(structure_.system);
  own.active = problem_.activeSet();
  Linearizer linearizer;
  own.rss = linearizeAtBounds(problem_, structure_, linearizer, own.active, own.kept,
                              [&own] { return own.kept.rows.gradient(); });
  own.gradient = own.kept.rows.gradient();
  own.squared_norm = linearizer.squaredNormSent();
  own.diagonal = own.kept.rows.diagonal();
  if (!(own.rss <= Linearizer::kLargestRss) || !own.gradient.allFinite() || !own.diagonal.allFinite())
    linearizer.raiseOverflow(problem_);
  own.is_linearized = true;
}

const ActiveSet& LinearizedProblem::activeSet() const {
  linearize();
  return results_->active;
}

int LinearizedProblem::freeUnknowns() const {
  return structure_.system.unknowns() - activeSet().fixedOrActiveCount();
}

double LinearizedProblem::rss() const {
  linearize();
  return results_->rss;
}

const JacobianRows& LinearizedProblem::rows() const {
  linearize();
  return results_->kept.rows;
}

const JacobianRows& LinearizedProblem::unweightedRows() const {
  linearize();
  return results_->kept.unweighted;
}

const Eigen::VectorXd& LinearizedProblem::gradient() const {
  linearize();
  return results_->gradient;
}

const Eigen::VectorXd& LinearizedProblem::diagonal() const {
  linearize();
  return results_->diagonal;
}

MatrixXd LinearizedProblem::times(const MatrixXd& V) const { return rows().times(V); }

double LinearizedProblem::orthogonality() const {
  linearize();
  return Evaluator::orthogonality(gradient(), diagonal(), results_->squared_norm);
}

/// Returns the solver, filled with these rows. Iterative solvers do not notice poorly determined directions and give
/// variances far too small. If the estimator's solver iterates, a factorising one replaces it, unless its factor is too
/// large.
LinearSolver& LinearizedProblem::solver() const {
  linearize();
  Results& own = *results_;
  if (own.careful != nullptr) return *own.careful;
  if (own.exact != nullptr) return *own.exact;
  if (own.content == evaluator_.contentOfSolver()) return evaluator_.solver();
  if (!evaluator_.isSolverExact()) {
    auto exact = std::make_unique<BlockSolver>();
    exact->analyze(structure_.system);
    if (exact->isExact()) {
      own.kept.rows.sendTo(*exact);
      own.exact = std::move(exact);
      return *own.exact;
    }
  }
  LinearSolver& lent = evaluator_.lendSolver();
  own.kept.rows.sendTo(lent);
  own.content = evaluator_.contentOfSolver();
  return lent;
}

bool LinearizedProblem::isExact() const { return solver().isExact(); }

SolveStatus LinearizedProblem::lookAgain(SolveStatus status, bool& has_changed) const {
  Results& own = *results_;
  has_changed = false;
  if (status.ok || own.careful != nullptr) return status;
  if (own.careful_failed) return own.careful_status;
  SecondLook look = slom::lookAgain(problem_, structure_, solver(), status, digitsOfDerivatives(),
                                    [&](LinearSolver& careful) { own.kept.rows.sendTo(careful); });
  own.careful = std::move(look.solver);
  has_changed = own.careful != nullptr;
  own.careful_failed = !has_changed;
  own.careful_status = look.status;
  return look.status;
}

SolveStatus LinearizedProblem::solveFor(const MatrixXd& B, MatrixXd& X) const {
  bool has_changed = false;
  SolveStatus status = lookAgain(solver().solveFor(B, X), has_changed);
  if (has_changed) status = solver().solveFor(B, X);
  if (status.ok) requireSolutionLength(solver(), X.rows(), structure_.system.unknowns());
  return status;
}

bool LinearizedProblem::needsMoreDigits(double inflation) const {
  return inflation > kMostInflation && isExact() && structure_.system.unknowns() <= kMostCarefulUnknowns;
}

/// Tries a solver that keeps more digits. Returns whether it replaces the present one.
bool LinearizedProblem::becomeCareful() const {
  bool has_changed = false;
  static_cast<void>(lookAgain(SolveStatus{false, 0, 0, 0}, has_changed));
  return has_changed;
}

double LinearizedProblem::largestInflation(const InverseBlocks& inverse) const {
  const BlockStructure& blocks = structure_.system;
  double largest = 0;
  MatrixXd C;
  for (int b = 0; b < blocks.blockCount(); ++b) {
    if (blocks.isEmpty(b)) continue;
    C.resize(blocks.dof(b), blocks.dof(b));
    inverse.block(b, b, C.data());
    largest = std::max(
        largest,
        C.diagonal().cwiseProduct(diagonal().segment(blocks.offset[at(b)], blocks.dof(b))).maxCoeff());
  }
  return largest;
}

const FreeNetwork& LinearizedProblem::freeNetwork() const {
  if (results_->free_network == nullptr) results_->free_network = std::make_unique<FreeNetwork>(*this);
  return *results_->free_network;
}

MatrixXd LinearizedProblem::covarianceColumns(FreeGauge gauge, int first, int count) const {
  if (gauge == FreeGauge::inner_constraints) return freeNetwork().columns(first, count);
  MatrixXd columns, unit = MatrixXd::Zero(structure_.system.unknowns(), count);
  unit.middleRows(first, count).setIdentity();
  const SolveStatus status = solveFor(unit, columns);
  if (!status.ok) throw undetermined(status);
  const auto inflation =
      columns.middleRows(first, count).diagonal().cwiseProduct(diagonal().segment(first, count));
  if (count > 0 && needsMoreDigits(inflation.maxCoeff()) && becomeCareful())
    static_cast<void>(solveFor(unit, columns));
  for (int i = 0; i < count; ++i) {  // conjugate gradients do not detect a loss of rank
    if (!(columns(first + i, i) >= 0)) throw undetermined(SolveStatus{false, first + i, 0, 0});
  }
  return columns;
}

MatrixXd LinearizedProblem::covarianceTimes(FreeGauge gauge, const MatrixXd& B) const {
  if (gauge == FreeGauge::inner_constraints) return freeNetwork().times(B);
  MatrixXd X;
  const SolveStatus status = solveFor(B, X);
  if (!status.ok) throw undetermined(status);
  return X;
}

const InverseBlocks* LinearizedProblem::findInverse(SolveStatus& status) const {
  std::unique_ptr<InverseBlocks>& inverse = results_->inverse;
  status = {};
  if (inverse != nullptr) return inverse.get();
  bool has_changed = false;
  status = lookAgain(solver().invertBlocks(structure_.system, inverse), has_changed);
  if (has_changed) status = solver().invertBlocks(structure_.system, inverse);
  if (!status.ok) return nullptr;
  if (needsMoreDigits(largestInflation(*inverse)) && becomeCareful())
    static_cast<void>(solver().invertBlocks(structure_.system, inverse));
  return inverse.get();
}

bool LinearizedProblem::hasInverse() const {
  SolveStatus ignored;
  return findInverse(ignored) != nullptr;
}

const InverseBlocks* LinearizedProblem::knownInverse(FreeGauge gauge) const {
  return gauge == FreeGauge::inner_constraints ? nullptr : results_->inverse.get();
}

const InverseBlocks& LinearizedProblem::inverse(FreeGauge gauge) const {
  if (gauge == FreeGauge::inner_constraints) return freeNetwork();
  SolveStatus status;
  const InverseBlocks* const inverse = findInverse(status);
  if (inverse == nullptr) throw undetermined(status);
  return *inverse;
}

const NearNullSpace& LinearizedProblem::nearNullSpace() const {
  if (results_->null_space == nullptr)
    results_->null_space = std::make_unique<NearNullSpace>(findNearNullSpace(*this, kNearNull));
  return *results_->null_space;
}

int LinearizedProblem::freeDirections() const {
  std::optional<int>& count = results_->free_directions;
  if (count) return *count;
  const int unknowns = structure_.system.unknowns();
  MatrixXd none;
  const bool is_unique = unknowns == 0 || (isExact() && solveFor(MatrixXd(unknowns, 0), none).ok);
  count = is_unique ? 0 : nearNullSpace().dimension(digitsOfDerivatives());
  return *count;
}

const Diagnosis& LinearizedProblem::diagnosis() const {
  if (!results_->diagnosis) results_->diagnosis = diagnose(*this);
  return *results_->diagnosis;
}

Error LinearizedProblem::undetermined(const SolveStatus& status) const {
  for (const Finding& finding : diagnosis().findings) {
    if (finding.kind == Finding::Kind::gauge) {
      return {"slom.free-gauge",
              "the gauge is free, so there are no covariances. " + finding.text +
                  "; setFreeGauge(slom::FreeGauge::inner_constraints) fits a free network"};
    }
  }
  if (!isExact() && freeDirections() == 0) {
    return {
        "slom.rank-deficient",
        "the iterative solver finds no inverse of J^T J: the matrix is too close to singular, although the "
        "measurements determine every unknown; choose a solver that factorises, such as BlockQR, "
        "with changeSolver()"};
  }
  for (const Finding& finding : diagnosis().findings) {
    if (finding.kind == Finding::Kind::undetermined || finding.kind == Finding::Kind::unobserved_component)
      return {"slom.rank-deficient",
              "not all unknowns are determined, so there are no covariances: " + finding.text,
              finding.names.empty() ? "" : finding.names.front()};
  }
  return singularError(problem_, structure_, status);
}

}  // namespace slom
