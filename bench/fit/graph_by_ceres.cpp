// Pose graphs by Ceres, with the parameter blocks of its own examples (examples/slam). In the plane: position 2, and
// angle 1 with an angle manifold. In space: position 3, and Eigen quaternion 4 with EigenQuaternionManifold. The
// residual is that of `slom graph`: z^-1 (a^-1 b), translation and rotation vector, whitened by L^T for the information
// L L^T.
#include <memory>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "fit/ceres_problem.hpp"
#include "fit/run.hpp"
#include "fit/stopwatch.hpp"

namespace slom::bench {

namespace {

using io::Pose2;
using io::Pose3;

template <class T>
T wrapped(const T& angle) {
  const T turns = ceres::floor((angle + T(EIGEN_PI)) / T(2 * EIGEN_PI));
  return angle - T(2 * EIGEN_PI) * turns;
}

struct AngleManifold {
  template <class T>
  bool Plus(const T* x, const T* delta, T* result) const {
    *result = wrapped(*x + *delta);
    return true;
  }
  template <class T>
  bool Minus(const T* y, const T* x, T* result) const {
    *result = wrapped(*y - *x);
    return true;
  }
};

template <int N>
Eigen::Matrix<double, N, N> rootOf(const io::Symmetric<N>& information) {
  return Eigen::Matrix<double, N, N>(information).llt().matrixU();
}

struct PlaneEdge {
  Eigen::Vector2d position;
  double angle;
  Eigen::Matrix3d root;

  template <class T>
  bool operator()(const T* pa, const T* aa, const T* pb, const T* ab, T* residual) const {
    const T ca = ceres::cos(*aa), sa = ceres::sin(*aa);
    const T dx = pb[0] - pa[0], dy = pb[1] - pa[1];
    const T x = ca * dx + sa * dy - position[0], y = ca * dy - sa * dx - position[1];
    const double c = std::cos(angle), s = std::sin(angle);
    Eigen::Map<Eigen::Matrix<T, 3, 1>> r(residual);
    r << c * x + s * y, c * y - s * x, wrapped(*ab - *aa - T(angle));
    r.applyOnTheLeft(root.cast<T>());
    return true;
  }
};

struct SpaceEdge {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;
  Eigen::Matrix<double, 6, 6> root;

  template <class T>
  bool operator()(const T* pa, const T* qa, const T* pb, const T* qb, T* residual) const {
    using Vec3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Vec3> a(pa), b(pb);
    const Eigen::Map<const Eigen::Quaternion<T>> ra(qa), rb(qb);
    const Eigen::Quaternion<T> back = ra.conjugate();
    const Eigen::Quaternion<T> z = rotation.cast<T>();
    const Eigen::Quaternion<T> turn = z.conjugate() * (back * rb);
    const T wxyz[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
    Eigen::Map<Eigen::Matrix<T, 6, 1>> r(residual);
    r.template head<3>() = z.conjugate() * (back * Vec3(b - a) - position.cast<T>());
    ceres::QuaternionToAngleAxis(wxyz, residual + 3);
    r.applyOnTheLeft(root.cast<T>());
    return true;
  }
};

/// Parameter blocks of a pose for Ceres.
template <class Pose>
struct Blocks;
template <>
struct Blocks<Pose2> {
  explicit Blocks(const Pose2& pose) : position{pose.pos[0], pose.pos[1]}, rotation{pose.orient.angle()} {}
  double position[2], rotation[1];
  static constexpr int position_size = 2, rotation_size = 1;
  static std::shared_ptr<ceres::Manifold> manifold() {
    return std::make_shared<ceres::AutoDiffManifold<AngleManifold, 1, 1>>();
  }
  static ceres::CostFunction* cost(const io::Edge<Pose2>& edge) {
    return new ceres::AutoDiffCostFunction<PlaneEdge, 3, 2, 1, 2, 1>(new PlaneEdge{
        Eigen::Vector2d(edge.measured.pos), edge.measured.orient.angle(), rootOf<3>(edge.information)});
  }
};
template <>
struct Blocks<Pose3> {
  explicit Blocks(const Pose3& pose) : position{pose.pos[0], pose.pos[1], pose.pos[2]} {
    const Eigen::Quaterniond q = quaternionOf(pose);
    std::copy_n(q.coeffs().data(), 4, rotation);
  }
  static Eigen::Quaterniond quaternionOf(const Pose3& pose) {
    return Eigen::Quaterniond(Eigen::Matrix3d(pose.orient.toRotationMatrix())).normalized();
  }
  double position[3], rotation[4];
  static constexpr int position_size = 3, rotation_size = 4;
  static std::shared_ptr<ceres::Manifold> manifold() {
    return std::make_shared<ceres::EigenQuaternionManifold>();
  }
  static ceres::CostFunction* cost(const io::Edge<Pose3>& edge) {
    return new ceres::AutoDiffCostFunction<SpaceEdge, 6, 3, 4, 3, 4>(new SpaceEdge{
        Eigen::Vector3d(edge.measured.pos), quaternionOf(edge.measured), rootOf<6>(edge.information)});
  }
};

template <class Pose>
class GraphProblem final : public CeresProblem {
 public:
  GraphProblem(const io::PoseGraph<Pose>& graph, double huber)
      : CeresProblem(huber), manifold_(Blocks<Pose>::manifold()) {
    blocks_.reserve(graph.poses.size());
    for (const auto& node : graph.poses) blocks_.emplace_back(node.value);
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      problem.AddParameterBlock(blocks_[i].position, Blocks<Pose>::position_size);
      problem.AddParameterBlock(blocks_[i].rotation, Blocks<Pose>::rotation_size, manifold_.get());
      this->blocks.push_back({blocks_[i].position, blocks_[i].rotation});
      if (!graph.poses[i].fixed) continue;
      problem.SetParameterBlockConstant(blocks_[i].position);
      problem.SetParameterBlockConstant(blocks_[i].rotation);
    }
    for (const auto& edge : graph.edges) {
      Blocks<Pose>&a = blocks_[static_cast<std::size_t>(edge.from)],
      &b = blocks_[static_cast<std::size_t>(edge.to)];
      problem.AddResidualBlock(Blocks<Pose>::cost(edge), loss(), a.position, a.rotation, b.position,
                               b.rotation);
    }
  }

 private:
  std::shared_ptr<ceres::Manifold> manifold_;
  std::vector<Blocks<Pose>> blocks_;
};

}  // namespace

template <class Pose>
std::unique_ptr<CeresProblem> ceresProblemOf(const io::PoseGraph<Pose>& graph, double huber) {
  return std::make_unique<GraphProblem<Pose>>(graph, huber);
}
template std::unique_ptr<CeresProblem> ceresProblemOf(const io::PoseGraph<Pose2>&, double);
template std::unique_ptr<CeresProblem> ceresProblemOf(const io::PoseGraph<Pose3>&, double);

template <class Pose>
Run fitByCeres(const io::PoseGraph<Pose>& graph, const Limits& limits) {
  std::unique_ptr<CeresProblem> problem;
  const double build = secondsOf([&] { problem = ceresProblemOf(graph, limits.huber); });
  Run run = solveByCeres(*problem, ceres::SPARSE_NORMAL_CHOLESKY, limits);
  run.build_seconds = build;
  return run;
}
template Run fitByCeres(const io::PoseGraph<Pose2>&, const Limits&);
template Run fitByCeres(const io::PoseGraph<Pose3>&, const Limits&);

}  // namespace slom::bench
