#include "graph/start/chordal.hpp"

#include <vector>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "error.hpp"

namespace slom::app::graph {

namespace {

/// H X = B with blocks of N rows, a block for each pose that is not held.
template <int N>
class NormalEquations {
 public:
  NormalEquations(std::vector<int> block, int blocks, int columns)
      : block_(std::move(block)), B_(Eigen::MatrixXd::Zero(N * blocks, columns)) {}

  /// Adds w |X_j - M X_i - c|^2; `value(p)` is X of a held pose. M is orthogonal.
  template <class M, class C, class Value>
  void add(double w, int i, int j, const M& m, const C& c, const Value& value) {
    const int a = block_[std::size_t(i)], b = block_[std::size_t(j)];
    if (b >= 0) addDiagonal(b, w), B_.middleRows<N>(N * b) += w * c;
    if (a >= 0) addDiagonal(a, w), B_.middleRows<N>(N * a) -= w * m.transpose() * c;
    if (a >= 0 && b >= 0) {
      for (int r = 0; r < N; ++r) {
        for (int s = 0; s < N; ++s) {
          a < b ? addEntry(N * b + r, N * a + s, -w * m(r, s)) : addEntry(N * a + s, N * b + r, -w * m(r, s));
        }
      }
    } else if (b >= 0) {
      B_.middleRows<N>(N * b) += w * m * value(i);
    } else if (a >= 0) {
      B_.middleRows<N>(N * a) += w * m.transpose() * value(j);
    }
  }

  Eigen::MatrixXd solve() {
    Eigen::SparseMatrix<double> H(B_.rows(), B_.rows());
    H.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(H);
    if (ldlt.info() != Eigen::Success)
      throw UserError("--init chordal: the linear system cannot be solved; use --init spanning-tree");
    return ldlt.solve(B_);
  }

 private:
  void addDiagonal(int block, double w) {
    for (int r = 0; r < N; ++r) addEntry(N * block + r, N * block + r, w);
  }
  void addEntry(int row, int column, double value) { entries_.emplace_back(row, column, value); }

  std::vector<int> block_;  // of each pose; -1: held
  std::vector<Eigen::Triplet<double>> entries_;
  Eigen::MatrixXd B_;
};

/// The rotation nearest to a matrix, in the Frobenius norm.
mtk::SO2<> nearestRotation(const Eigen::Matrix2d& M) { return mtk::SO2<>(M); }
mtk::SO3<> nearestRotation(const Eigen::Matrix3d& M) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return mtk::SO3<>(
      Eigen::Matrix3d(svd.matrixU() * Eigen::Vector3d(1, 1, sign).asDiagonal() * svd.matrixV().transpose()));
}

}  // namespace

template <class Pose>
void relaxChordally(PoseGraph<Pose>& graph) {
  constexpr int N = dim<Pose>;
  using Matrix = Eigen::Matrix<double, N, N>;
  using Scalar = Eigen::Matrix<double, 1, 1>;
  std::vector<int> block(graph.poses.size(), -1);
  int blocks = 0;
  for (std::size_t p = 0; p < graph.poses.size(); ++p) {
    if (!graph.poses[p].held) block[p] = blocks++;
  }
  const auto pose = [&](int p) -> Pose& { return graph.poses[std::size_t(p)].value; };

  NormalEquations<N> rotations(block, blocks, N);  // X_p = R_p^T
  for (const auto& edge : graph.edges) {
    const double w = edge.information.diagonal().template tail<dof<Pose> - N>().mean();
    rotations.add(w, edge.from, edge.to, Matrix(edge.measured.orient.inverse().toRotationMatrix()),
                  Matrix::Zero(), [&](int p) { return Matrix(pose(p).orient.inverse().toRotationMatrix()); });
  }
  const Eigen::MatrixXd X = rotations.solve();
  for (std::size_t p = 0; p < block.size(); ++p) {
    if (block[p] >= 0)
      graph.poses[p].value.orient = nearestRotation(Matrix(X.middleRows<N>(N * block[p]).transpose()));
  }

  NormalEquations<1> positions(block, blocks, N);
  for (const auto& edge : graph.edges) {
    const double w = edge.information.diagonal().template head<N>().mean();
    const Point<Pose> moved = pose(edge.from).orient * edge.measured.pos;
    positions.add(w, edge.from, edge.to, Scalar(Scalar::Ones()), moved.transpose(),
                  [&](int p) { return pose(p).pos.transpose().eval(); });
  }
  const Eigen::MatrixXd T = positions.solve();
  for (std::size_t p = 0; p < block.size(); ++p) {
    if (block[p] >= 0) graph.poses[p].value.pos = T.row(block[p]).transpose();
  }
}

template void relaxChordally(PoseGraph<Pose2>&);
template void relaxChordally(PoseGraph<Pose3>&);

}  // namespace slom::app::graph
