// Cost of CHOLMOD for J^T J of a pose graph, at its start and with the J of Ceres.
#include <algorithm>
#include <cholmod.h>
#include <limits>
#include <vector>

#include <Eigen/SparseCore>
#include <ceres/crs_matrix.h>

#include "fit/ceres_problem.hpp"
#include "fit/run.hpp"
#include "fit/stopwatch.hpp"

namespace slom::bench {

namespace {

/// Number of operations above which the simplicial method is omitted, because it takes long and is slower.
constexpr double kMostSimplicialFlops = 1e10;

Eigen::SparseMatrix<double> normalMatrix(CeresProblem& problem) {
  ceres::Problem::EvaluateOptions options;  // omits the columns of fixed variables
  problem.problem.GetParameterBlocks(&options.parameter_blocks);
  std::erase_if(options.parameter_blocks,
                [&](const double* block) { return problem.problem.IsParameterBlockConstant(block); });
  ceres::CRSMatrix crs;
  problem.problem.Evaluate(options, nullptr, nullptr, nullptr, &crs);
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> rows(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(),
      crs.cols.data(), crs.values.data());
  const Eigen::SparseMatrix<double> J(rows);
  const Eigen::SparseMatrix<double> H = J.transpose() * J;
  Eigen::SparseMatrix<double> lower = H.triangularView<Eigen::Lower>();
  lower.makeCompressed();
  return lower;
}

}  // namespace

template <class Pose>
Factorization factorizeByCholmod(const io::PoseGraph<Pose>& graph) {
  Eigen::SparseMatrix<double> H = normalMatrix(*ceresProblemOf(graph, 0));
  cholmod_sparse A{};
  A.nrow = A.ncol = static_cast<std::size_t>(H.rows());
  A.nzmax = static_cast<std::size_t>(H.nonZeros());
  A.p = H.outerIndexPtr();
  A.i = H.innerIndexPtr();
  A.x = H.valuePtr();
  A.stype = -1;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_REAL;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  Factorization result;
  result.symbolic_seconds = result.numeric_seconds = std::numeric_limits<double>::infinity();
  for (const int supernodal : {CHOLMOD_SUPERNODAL, CHOLMOD_SIMPLICIAL}) {
    if (supernodal == CHOLMOD_SIMPLICIAL && result.flops > kMostSimplicialFlops) continue;
    cholmod_common common;
    cholmod_start(&common);
    common.supernodal = supernodal;
    cholmod_factor* factor = nullptr;
    const double symbolic = bestSecondsOf([&] {
      cholmod_free_factor(&factor, &common);
      factor = cholmod_analyze(&A, &common);
    });
    const double numeric = bestSecondsOf([&] { cholmod_factorize(&A, factor, &common); });
    result.flops = common.fl;
    result.symbolic_seconds = std::min(result.symbolic_seconds, symbolic);
    result.numeric_seconds = std::min(result.numeric_seconds, numeric);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  return result;
}

template Factorization factorizeByCholmod(const io::PoseGraph<io::Pose2>&);
template Factorization factorizeByCholmod(const io::PoseGraph<io::Pose3>&);

}  // namespace slom::bench
