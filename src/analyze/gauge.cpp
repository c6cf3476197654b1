#include "analyze/gauge.hpp"

#include <map>
#include <numeric>

#include "base/decompositions.hpp"
#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSame = 1e-6;  // limit of the difference of two directions of unit length

/// Returns A with columns of length 1; `length` receives the original lengths.
MatrixXd normalized(MatrixXd A, VectorXd& length) {
  length = A.colwise().norm();
  for (Index j = 0; j < A.cols(); ++j) A.col(j) /= length[j] > 0 ? length[j] : 1;
  return A;
}

MatrixXd orthonormalColumns(const MatrixXd& A) {
  const SVD svd = svdOf(A, Eigen::ComputeThinU);
  return svd.matrixU().leftCols((svd.singularValues().array() > kSame).count());
}

/// Variables of one type in a part, and the rows of their unknowns in the part.
struct Class {
  std::vector<int> variables, first_row;
  Index rows = 0;
};

/// Returns the variables with entries in the null space, by the store of their type.
std::map<const VariableStoreBase*, Class> classesOf(const Problem& problem, const ProblemStructure& structure,
                                                    const ConnectedPart& part, const MatrixXd& null_space) {
  std::map<const VariableStoreBase*, Class> classes;
  int row = 0;
  for (const int variable : part.variables) {
    const int dof = structure.system.dof(variable);
    if (null_space.middleRows(row, dof).norm() > kSame) {
      Class& own = classes[problem.variables()[at(variable)].store];
      own.variables.push_back(variable);
      own.first_row.push_back(row);
      own.rows += dof;
    }
    row += dof;
  }
  return classes;
}

/// Returns the gauge generators on the scaled unknowns of the class.
MatrixXd gaugeGeneratorsOf(const Problem& problem, const ConnectedPart& part, const Class& own,
                           WorldRole role, const VectorXd& scale) {
  MatrixXd all(own.rows, kGaugeGenerators);
  Index row = 0;
  for (std::size_t i = 0; i < own.variables.size(); ++i) {
    const VariableRecord& record = problem.variables()[at(own.variables[i])];
    MatrixXd motions(record.dof, kGaugeGenerators);
    record.store->gaugeGenerators(problem.linearizationPoint(own.variables[i]), role, motions.data());
    for (int c = 0; c < record.dof; ++c) {
      all.row(row++) = scale[part.unknowns[at(own.first_row[i] + c)]] * motions.row(c);
    }
  }
  return all;
}

MatrixXd rowsOf(const MatrixXd& A, const Problem& problem, const Class& own) {
  MatrixXd rows(own.rows, A.cols());
  Index row = 0;
  for (std::size_t i = 0; i < own.variables.size(); ++i) {
    const int dof = problem.variables()[at(own.variables[i])].dof;
    rows.middleRows(row, dof) = A.middleRows(own.first_row[i], dof);
    row += dof;
  }
  return rows;
}

/// Returns an orthonormal basis of the combinations of columns of A in which the given rows vanish.
MatrixXd vanishingIn(const MatrixXd& A, const MatrixXd& rows) {
  if (rows.rows() == 0) return A;
  const SVD svd = svdOf(rows, Eigen::ComputeFullV);
  const double limit = kSame * std::max(1e-300, A.norm());
  const Index rank = (svd.singularValues().array() > limit).count();
  return A * svd.matrixV().rightCols(A.cols() - rank);
}

/// Returns the rows of unknowns that no gauge generator changes.
MatrixXd rowsElsewhere(const Problem& problem, const ConnectedPart& part, const MatrixXd& null_space) {
  std::vector<int> rows;
  int row = 0;
  for (const int variable : part.variables) {
    const VariableRecord& record = problem.variables()[at(variable)];
    MatrixXd motions(record.dof, kGaugeGenerators);
    record.store->gaugeGenerators(problem.linearizationPoint(variable), WorldRole::in_world, motions.data());
    for (int c = 0; c < record.dof; ++c) {
      if (motions.row(c).isZero(0)) rows.push_back(row + c);
    }
    row += record.dof;
  }
  return null_space(rows, Eigen::all);
}

/// Returns the combinations of gauge generators that, on this class, lie in the null space. `elsewhere` holds the rows
/// of the null space that no gauge generator changes, such as those of focal lengths.
Gauge commonMotions(const MatrixXd& motions, const MatrixXd& null_rows, const MatrixXd& null_space,
                    const MatrixXd& elsewhere) {
  Gauge result;
  VectorXd length;
  const MatrixXd G = normalized(motions, length);
  PivotedQR qr = pivotedQrOf(G);
  qr.setThreshold(1e-9);
  const SVD null_svd = svdOf(null_rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Index rank = qr.rank(), null_rank = (null_svd.singularValues().array() > kSame).count();
  if (rank == 0 || null_rank == 0 || null_rank == null_rows.rows()) return result;
  const MatrixXd Q = columnsOfQ(qr, rank);
  const MatrixXd U = null_svd.matrixU().leftCols(null_rank);
  const SVD angles = svdOf(Q.transpose() * U, Eigen::ComputeThinU);
  const Index count = (angles.singularValues().array() > 1 - kSame).count();
  // If the dimensions of two subspaces add up to more than that of the whole space, the excess is always in common.
  if (count <= std::max<Index>(0, rank + null_rank - null_rows.rows())) return result;
  const VectorXd inverse = null_svd.singularValues().head(null_rank).cwiseInverse();
  const MatrixXd coefficients = null_svd.matrixV().leftCols(null_rank) * inverse.asDiagonal() * U.transpose();
  MatrixXd common = Q * angles.matrixU().leftCols(count);
  common = vanishingIn(common, elsewhere * (coefficients * common));
  if (common.cols() == 0) return result;
  result.motions = leastSquares(qr, common);
  result.length = length.unaryExpr([](double l) { return l > 0 ? l : 1.0; });
  result.directions = orthonormalColumns(null_space * (coefficients * common));
  return result;
}

/// Returns `x, y, z` if A spans all three axes, or else the vectors that span the columns of A: `x`, `(0.6 0.8 0)`.
std::string axes(const MatrixXd& A) {
  PivotedQR qr = pivotedQrOf(A);
  qr.setThreshold(kSame);
  const MatrixXd basis = columnsOfQ(qr, qr.rank());
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis) {
    if (basis.row(axis).norm() > 1 - kSame) names.push_back(std::string(1, "xyz"[axis]));
  }
  if (static_cast<Index>(names.size()) < basis.cols()) {
    names.clear();
    for (Index j = 0; j < basis.cols(); ++j) {
      Index largest = 0;
      basis.col(j).cwiseAbs().maxCoeff(&largest);
      const Eigen::Vector3d axis = basis.col(j) / (basis(largest, j) > 0 ? 1.0 : -1.0);
      std::string text = "(";
      for (int i = 0; i < 3; ++i)
        text += std::string(i > 0 ? " " : "") + number(std::abs(axis[i]) < kSame ? 0 : axis[i]);
      names.push_back(text + ")");
    }
  }
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Describes pure translations, the motions beyond them, and the scale.
void describe(Gauge& gauge) {
  const MatrixXd& motions = gauge.motions;
  const auto inUnits = [&](const MatrixXd& A, int first) {
    return MatrixXd(gauge.length.segment(first, 3).cwiseInverse().asDiagonal() * A.middleRows(first, 3));
  };
  const MatrixXd translations = vanishingIn(motions, motions.middleRows(3, 4));
  gauge.has_scale = motions.bottomRows(1).norm() > kSame * motions.norm();
  gauge.has_translation = translations.cols() > 0;
  gauge.has_rotation = motions.cols() - translations.cols() > (gauge.has_scale ? 1 : 0);
  const auto append = [&](const std::string& part) { gauge.text += (gauge.text.empty() ? "" : "; ") + part; };
  if (gauge.has_translation) append("translation " + axes(inUnits(translations, 0)));
  if (gauge.has_rotation)
    append("rotation about " + axes(inUnits(vanishingIn(motions, motions.bottomRows(1)), 3)));
  if (gauge.has_scale) append("scale");
}

}  // namespace

std::vector<ConnectedPart> connectedParts(const BlockStructure& structure) {
  std::vector<int> root(at(structure.blockCount()));
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int b) {
    while (root[at(b)] != b) b = root[at(b)] = root[at(root[at(b)])];
    return b;
  };
  for (const MeasurementGroup& group : structure.groups) {
    for (int m = 0; m < group.size(); ++m) {
      int first = -1;
      for (int k = 0; k < group.arity; ++k) {
        const int block = group.blocks[at(m * group.arity + k)];
        if (block < 0) continue;
        if (first < 0) first = find(block);
        const int other = find(block);
        root[at(std::max(first, other))] = std::min(first, other);
        first = std::min(first, other);
      }
    }
  }
  std::vector<int> part_of(root.size(), -1);
  std::vector<ConnectedPart> parts;
  for (int b = 0; b < structure.blockCount(); ++b) {
    if (structure.isEmpty(b)) continue;
    int& part = part_of[at(find(b))];
    if (part < 0) {
      part = static_cast<int>(parts.size());
      parts.emplace_back();
    }
    parts[at(part)].variables.push_back(b);
    for (int c = 0; c < structure.dof(b); ++c)
      parts[at(part)].unknowns.push_back(structure.offset[at(b)] + c);
  }
  return parts;
}

Gauge findGauge(const Problem& problem, const ProblemStructure& structure, const ConnectedPart& part,
                const MatrixXd& null_space, const VectorXd& scale) {
  Gauge best;
  const MatrixXd elsewhere = rowsElsewhere(problem, part, null_space);
  for (const auto& [store, own] : classesOf(problem, structure, part, null_space)) {
    const MatrixXd null_rows = rowsOf(null_space, problem, own);
    for (const WorldRole role : {WorldRole::in_world, WorldRole::sees_world}) {
      Gauge found =
          commonMotions(gaugeGeneratorsOf(problem, part, own, role, scale), null_rows, null_space, elsewhere);
      if (found.count() > best.count()) best = std::move(found);
    }
  }
  if (best.count() > 0) describe(best);
  return best;
}

}  // namespace slom
