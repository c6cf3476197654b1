#include "analyze/directions.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "base/index.hpp"
#include "base/words.hpp"

namespace slom {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Returns the noun for variables of a type, in the singular.
std::string nounOf(const std::string& type) {
  if (type.rfind("trafo<", 0) == 0) return "pose";
  if (type == "vect<2>" || type == "vect<3>" || type.rfind("Matrix<double, ", 0) == 0) return "point";
  return type;
}

std::string remedyOf(const Gauge& gauge, bool has_pose) {
  const bool is_rigid = gauge.has_translation || gauge.has_rotation;
  std::string text;
  if (is_rigid) text = has_pose ? "fix one pose or add a prior" : "fix enough of them, or add priors";
  if (gauge.has_scale) text += is_rigid ? ", and measure a length" : "measure a length or fix one";
  return text;
}

}  // namespace

Movement movementAlong(const VectorXd& direction, const VectorXd& scale, const std::vector<int>& unknowns,
                       const std::function<std::string(int)>& name_of) {
  const double least = kNegligibleEntry * direction.cwiseAbs().maxCoeff();
  std::vector<Index> order;
  for (Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction[i]) > least) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::abs(direction[a]) > std::abs(direction[b]) * (1 + 1e-6);
  });
  const auto amount = [&](Index k) { return direction[k] / scale[unknowns[static_cast<std::size_t>(k)]]; };
  Movement result;
  for (const Index i : order) {
    const double relative = amount(i) / amount(order.front());
    result.names.push_back(name_of(unknowns[static_cast<std::size_t>(i)]));
    result.amounts.push_back(std::string(relative > 0 ? "+" : "") + number(relative));
  }
  return result;
}

MatrixXd basisOfFewEntries(MatrixXd basis) {
  for (Index j = 0; j < basis.cols(); ++j) {
    Index row = 0, column = 0;
    basis.rightCols(basis.cols() - j).cwiseAbs().maxCoeff(&row, &column);
    basis.col(j).swap(basis.col(j + column));
    basis.col(j) /= basis(row, j);
    for (Index k = 0; k < basis.cols(); ++k) {
      if (k != j) basis.col(k) -= basis(row, k) * basis.col(j);
    }
  }
  return basis;
}

Finding findingOf(const Gauge& gauge, const ConnectedPart& part, const Problem& problem,
                  const ProblemStructure& structure) {
  struct Members {
    std::vector<std::string> names;
    int of = 0;
  };
  std::map<std::string, Members> members_of;  // by noun
  int row = 0;
  std::vector<std::string> names;
  for (const int variable : part.variables) {
    const int dof = structure.system.dof(variable);
    Members& members = members_of[nounOf(problem.variables()[at(variable)].store->typeName())];
    ++members.of;
    if (gauge.directions.middleRows(row, dof).norm() > kNegligibleEntry) {
      members.names.push_back(problem.variableName(variable));
      names.push_back(members.names.back());
    }
    row += dof;
  }
  std::vector<std::string> who;
  for (const auto& [noun, members] : members_of) {
    const int count = static_cast<int>(members.names.size());
    if (count == 0) continue;
    std::string which = counted(count, noun);
    if (count == members.of) which = count == 2 ? "both" + which.substr(1) : "all " + which;
    who.push_back(which + " (" + abridged(members.names) + ")");
  }
  std::string text = listed(who) + " can move together (" + gauge.text + ") without changing any residual: ";
  text[0] = static_cast<char>(std::toupper(text[0]));
  text += remedyOf(gauge, members_of.contains("pose"));
  return {Finding::Kind::gauge, true, text, names, static_cast<int>(gauge.count())};
}

}  // namespace slom
