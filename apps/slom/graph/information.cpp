#include "graph/information.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "error.hpp"

namespace slom::app::graph {

namespace {

constexpr std::size_t most_lines = 5;  // lines named in a message

/// Decides as the library does: by the pivots of the Cholesky factor at unit diagonal.
bool isPositiveDefinite(const Eigen::MatrixXd& m) {
  if (!(m.diagonal().array() > 0).all()) return false;
  if (m.isDiagonal(0)) return true;
  const Eigen::VectorXd scale = m.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * m * scale.asDiagonal());
  return llt.info() == Eigen::Success && llt.matrixLLT().diagonal().minCoeff() > 1e-8;
}

Eigen::MatrixXd repaired(const Eigen::MatrixXd& m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(m);
  const double floor = repaired_eigenvalue * eigen.eigenvalues().cwiseAbs().maxCoeff();
  const Eigen::MatrixXd& V = eigen.eigenvectors();
  const Eigen::MatrixXd product = V * eigen.eigenvalues().cwiseMax(floor).asDiagonal() * V.transpose();
  return (product + product.transpose()) / 2;
}

class Check {
 public:
  Check(const std::string& file, bool repair) : file_(file), repair_(repair) {}

  /// Checks edges, sightings, bearings or priors.
  void operator()(auto& edges) {
    for (auto& edge : edges) {
      if (isPositiveDefinite(edge.information)) continue;
      if (edge.information.isZero(0)) {
        throw UserError(fmt::format("{}:{}: the information is 0, so nothing is measured; remove the line",
                                    file_, edge.line));
      }
      ++count_;
      if (lines_.size() < most_lines) lines_.push_back(edge.line);
      if (repair_) edge.information = repaired(edge.information);
    }
  }

  int finish() const {
    if (count_ == 0 || repair_) return count_;
    throw UserError(fmt::format(
        "{}: the information of {} is not positive definite ({} {}{}); correct it, or pass "
        "--repair-information to use the nearest positive definite matrix",
        file_, count_ == 1 ? "1 edge" : fmt::format("{} edges", count_), count_ == 1 ? "line" : "lines",
        fmt::join(lines_, ", "), count_ > int(lines_.size()) ? ", ..." : ""));
  }

 private:
  const std::string& file_;
  bool repair_;
  int count_ = 0;
  std::vector<int> lines_;
};

}  // namespace

template <class Pose>
int checkInformation(PoseGraph<Pose>& graph, bool repair) {
  Check check(graph.file, repair);
  check(graph.edges);
  check(graph.sightings);
  check(graph.bearings);
  check(graph.pose_priors);
  check(graph.position_priors);
  for (auto& [sighting, sensed] : graph.as_sensed) {
    if (!isPositiveDefinite(sensed.information)) sensed.information = repaired(sensed.information);
  }
  return check.finish();
}

template int checkInformation(PoseGraph<Pose2>&, bool);
template int checkInformation(PoseGraph<Pose3>&, bool);

}  // namespace slom::app::graph
