// The same residuals as users of Ceres write them, in the parameter blocks of its own examples:
//   bundle adjustment  camera = 9 numbers, the rotation as angle-axis, no manifold
//                      (examples/snavely_reprojection_error)
//   relative pose      position 3 and Eigen quaternion 4 of each pose, EigenQuaternionManifold
//                      (examples/slam/pose_graph_3d)
//   stereo camera      9 numbers of each camera, poses as in the pose graph
// Ceres computes each manifold's PlusJacobian once per evaluation and multiplies every Jacobian by it. So does this.
#include <array>
#include <cmath>
#include <memory>

#include <Eigen/Geometry>
#include <ceres/autodiff_cost_function.h>
#include <ceres/manifold.h>
#include <ceres/rotation.h>

#include "linearize/variants.hpp"
#include "support/snavely_residual.hpp"

namespace slom::bench {

namespace {

using CostFunctions = std::vector<std::unique_ptr<ceres::CostFunction>>;
template <int Rows, int Cols>
using RowMajor = Eigen::Matrix<double, Rows, Cols, Eigen::RowMajor>;
template <int Rows, int Cols>
using Block = Eigen::Map<RowMajor<Rows, Cols>>;
/// Columns of all parameters side by side.
template <int Rows, int Cols>
using Side = Eigen::Map<Eigen::Matrix<double, Rows, Cols>>;

constexpr const char* kName = "Ceres, automatic";

// ---- residuals

struct RelativePoseResidual {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;

  template <class T>
  bool operator()(const T* a_pos, const T* a_quaternion, const T* b_pos, const T* b_quaternion,
                  T* residual) const {
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> p_a(a_pos), p_b(b_pos);
    const Eigen::Map<const Eigen::Quaternion<T>> q_a(a_quaternion), q_b(b_quaternion);
    const Eigen::Quaternion<T> a_inverse = q_a.conjugate();
    const Eigen::Quaternion<T> error = rotation.conjugate().template cast<T>() * (a_inverse * q_b);
    Eigen::Map<Eigen::Matrix<T, 3, 1>> by_position(residual);
    by_position = a_inverse * (p_b - p_a) - position.template cast<T>();
    const T wxyz[4] = {error.w(), error.x(), error.y(), error.z()};
    ceres::QuaternionToAngleAxis(wxyz, residual + 3);
    return true;
  }
};

template <class T>
void projectOpenCV(const T* c, const Eigen::Matrix<T, 3, 1>& p, T* image) {
  const T x = p[0] / p[2];
  const T y = p[1] / p[2];
  const T xx = x * x, yy = y * y, xy2 = 2.0 * x * y;
  const T r2 = xx + yy;
  const T radial = 1.0 + r2 * (c[4] + r2 * (c[5] + r2 * c[8]));
  image[0] = c[0] * (x * radial + c[6] * xy2 + c[7] * (r2 + 2.0 * xx)) + c[2];
  image[1] = c[1] * (y * radial + c[6] * (r2 + 2.0 * yy) + c[7] * xy2) + c[3];
}

struct StereoResidual {
  Eigen::Vector3d on_board;
  Eigen::Vector4d pixels;

  template <class T>
  bool operator()(const T* left, const T* right, const T* rig_pos, const T* rig_quaternion,
                  const T* board_pos, const T* board_quaternion, T* residual) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Vector> t_rig(rig_pos), t_board(board_pos);
    const Eigen::Map<const Eigen::Quaternion<T>> q_rig(rig_quaternion), q_board(board_quaternion);
    const Vector in_left = q_board * on_board.template cast<T>() + t_board;
    const Vector in_right = q_rig * in_left + t_rig;
    projectOpenCV(left, in_left, residual);
    projectOpenCV(right, in_right, residual + 2);
    for (int k = 0; k < 4; ++k) residual[k] -= pixels[k];
    return true;
  }
};

// ---- variables and their tangent spaces

struct Pose {
  Eigen::Vector3d position;
  Eigen::Quaterniond rotation;

  explicit Pose(const SE3& pose) : position(pose.pos), rotation(pose.orient.quaternion()) {}
};

std::vector<Pose> posesOf(const std::vector<SE3>& poses) {
  std::vector<Pose> result;
  for (const SE3& pose : poses) result.emplace_back(pose);
  return result;
}

/// The PlusJacobians of the quaternions of some poses.
class PlusJacobians {
 public:
  explicit PlusJacobians(std::size_t count) : all_(count) {}
  void compute(const std::vector<Pose>& poses) {
    for (std::size_t i = 0; i < poses.size(); ++i) {
      manifold_.PlusJacobian(poses[i].rotation.coeffs().data(), all_[i].data());
    }
  }
  const RowMajor<4, 3>& operator[](int i) const { return all_[std::size_t(i)]; }

 private:
  ceres::EigenQuaternionManifold manifold_;
  std::vector<RowMajor<4, 3>> all_;
};

/// Converts columns. A step d of EigenQuaternionManifold turns by 2 d in the outer frame, a step of SLoM by d in the
/// inner frame.
template <int Rows, class Columns>
void toInnerFrame(Columns columns, const mtk::SO3<>& R) {
  const Eigen::Matrix<double, Rows, 3> by_outer = columns;
  columns = by_outer * R.toRotationMatrix() / 2;
}

/// Returns d R exp(d) / d p for angle-axis p, the right Jacobian of SO(3),
///   I - (1 - cos|p|) / |p|^2 [p]x + (|p| - sin|p|) / |p|^3 [p]x^2.
Eigen::Matrix3d rightJacobian(const Eigen::Vector3d& p) {
  const double angle = p.norm(), square = angle * angle;
  Eigen::Matrix3d S;
  S << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
  return Eigen::Matrix3d::Identity() - (1 - std::cos(angle)) / square * S +
         (angle - std::sin(angle)) / (square * angle) * S * S;
}

/// Rearranges consecutive row-major blocks of these widths side by side.
template <int Rows, int... Widths>
void putSideBySide(double* J) {
  constexpr int cols = (Widths + ...);
  const RowMajor<1, Rows* cols> blocks = Block<1, Rows * cols>(J);
  Side<Rows, cols> all(J);
  int first = 0;
  const auto put = [&](auto block) {
    all.middleCols(first, block.cols()) = block;
    first += static_cast<int>(block.cols());
  };
  (put(Eigen::Map<const RowMajor<Rows, Widths>>(blocks.data() + Rows * first)), ...);
}

/// Returns the variant that evaluates `problem`, which leaves row-major blocks of these widths. For checks, not for
/// timing, the blocks are brought to the layout of SLoM, and by convert(i, J) to its coordinates.
template <int Rows, int... Widths, class Problem, class Convert>
Variant evaluated(std::shared_ptr<Problem> problem, Convert convert) {
  constexpr int cols = (Widths + ...);
  Variant variant = kernelVariant<Rows, cols>(
      kName, kMeasurements, [problem](int i, double* r, double* J) { problem->evaluate(i, r, J); });
  variant.derivatives = [convert, compute = variant.derivatives] {
    Derivatives all = compute();
    for (int i = 0; i < all.count; ++i) {
      putSideBySide<Rows, Widths...>(all.jacobian(i));
      convert(i, Side<Rows, cols>(all.jacobian(i)));
    }
    return all;
  };
  return variant;
}

// ---- evaluation

// Each class holds the cost functions, their parameter blocks, and the variables at fixed addresses. evaluate(i, r, J)
// writes the Jacobian block by block, row-major, as Ceres does.

struct BalProblem {
  explicit BalProblem(const BalData& data) {
    for (const auto& camera : data.cameras) {
      const auto rotation = mtk::SO3<>::log(camera.pose.orient);
      std::array<double, 9> numbers;
      for (int k = 0; k < 3; ++k) {
        numbers[std::size_t(k)] = rotation[k];
        numbers[std::size_t(k + 3)] = camera.pose.pos[k];
        numbers[std::size_t(k + 6)] = camera.lens[k];
      }
      cameras.push_back(numbers);
    }
    for (const auto& point : data.points) points.push_back({point[0], point[1], point[2]});
    for (const auto& z : data.observations) {
      costs.emplace_back(new ceres::AutoDiffCostFunction<SnavelyResidual, 2, 9, 3>(
          new SnavelyResidual{z.pixel[0], z.pixel[1]}));
      parameters.push_back({cameras[std::size_t(z.camera)].data(), points[std::size_t(z.point)].data()});
    }
  }

  /// Columns: rotation, translation, lens, point.
  void evaluate(int i, double* r, double* J) const {
    double* jacobians[] = {J, J + 18};
    costs[std::size_t(i)]->Evaluate(parameters[std::size_t(i)].data(), r, jacobians);
  }

  std::vector<std::array<double, 9>> cameras;
  std::vector<std::array<double, 3>> points;
  CostFunctions costs;
  std::vector<std::array<const double*, 2>> parameters;
};

struct PoseGraphProblem {
  explicit PoseGraphProblem(const PoseGraphData& data)
      : edges(data.edges), poses(posesOf(data.poses)), plus(poses.size()) {
    for (const auto& z : data.edges) {
      const Pose measured(z.measured);
      costs.emplace_back(new ceres::AutoDiffCostFunction<RelativePoseResidual, 6, 3, 4, 3, 4>(
          new RelativePoseResidual{measured.position, measured.rotation}));
      const Pose &a = poses[std::size_t(z.a)], &b = poses[std::size_t(z.b)];
      parameters.push_back(
          {a.position.data(), a.rotation.coeffs().data(), b.position.data(), b.rotation.coeffs().data()});
    }
  }

  void evaluate(int i, double* r, double* J) {
    if (i == 0) plus.compute(poses);
    RowMajor<6, 4> a_rotation, b_rotation;
    double* jacobians[] = {J, a_rotation.data(), J + 36, b_rotation.data()};
    costs[std::size_t(i)]->Evaluate(parameters[std::size_t(i)].data(), r, jacobians);
    Block<6, 3>(J + 18).noalias() = a_rotation * plus[edges[std::size_t(i)].a];
    Block<6, 3>(J + 54).noalias() = b_rotation * plus[edges[std::size_t(i)].b];
  }

  const std::vector<PoseGraphData::Edge>& edges;
  std::vector<Pose> poses;
  PlusJacobians plus;
  CostFunctions costs;
  std::vector<std::array<const double*, 4>> parameters;
};

struct StereoProblem {
  explicit StereoProblem(const StereoData& data)
      : corners(data.corners),
        left(data.intrinsics.left),
        right(data.intrinsics.right),
        rig{Pose(data.left2right)},
        boards(posesOf(data.board2left)),
        rig_plus(1),
        board_plus(boards.size()) {
    for (const auto& z : data.corners) {
      costs.emplace_back(new ceres::AutoDiffCostFunction<StereoResidual, 4, 9, 9, 3, 4, 3, 4>(
          new StereoResidual{z.on_board, z.pixels}));
      const Pose& board = boards[std::size_t(z.view)];
      parameters.push_back({left.data(), right.data(), rig[0].position.data(),
                            rig[0].rotation.coeffs().data(), board.position.data(),
                            board.rotation.coeffs().data()});
    }
  }

  void evaluate(int i, double* r, double* J) {
    if (i == 0) {
      rig_plus.compute(rig);
      board_plus.compute(boards);
    }
    RowMajor<4, 4> rig_rotation, board_rotation;
    double* jacobians[] = {J, J + 36, J + 72, rig_rotation.data(), J + 96, board_rotation.data()};
    costs[std::size_t(i)]->Evaluate(parameters[std::size_t(i)].data(), r, jacobians);
    Block<4, 3>(J + 84).noalias() = rig_rotation * rig_plus[0];
    Block<4, 3>(J + 108).noalias() = board_rotation * board_plus[corners[std::size_t(i)].view];
  }

  const std::vector<StereoData::Corner>& corners;
  mtk::vect<9> left, right;
  std::vector<Pose> rig, boards;
  PlusJacobians rig_plus, board_plus;
  CostFunctions costs;
  std::vector<std::array<const double*, 6>> parameters;
};

}  // namespace

Variant byCeres(const BalData& data) {
  return evaluated<2, 9, 3>(std::make_shared<BalProblem>(data), [&data](int i, Side<2, 12> J) {
    const auto& camera = data.cameras[std::size_t(data.observations[std::size_t(i)].camera)];
    const Eigen::Matrix<double, 2, 3> by_angle_axis = J.leftCols<3>(), by_translation = J.middleCols<3>(3);
    J.leftCols<3>() = by_translation;
    J.middleCols<3>(3) = by_angle_axis * rightJacobian(mtk::SO3<>::log(camera.pose.orient)).inverse();
  });
}

Variant byCeres(const PoseGraphData& data) {
  return evaluated<6, 3, 3, 3, 3>(std::make_shared<PoseGraphProblem>(data), [&data](int i, Side<6, 12> J) {
    const auto& z = data.edges[std::size_t(i)];
    toInnerFrame<6>(J.middleCols<3>(3), data.poses[std::size_t(z.a)].orient);
    toInnerFrame<6>(J.rightCols<3>(), data.poses[std::size_t(z.b)].orient);
  });
}

Variant byCeres(const StereoData& data) {
  return evaluated<4, 9, 9, 3, 3, 3, 3>(std::make_shared<StereoProblem>(data), [&data](int i, Side<4, 30> J) {
    const auto& z = data.corners[std::size_t(i)];
    toInnerFrame<4>(J.middleCols<3>(21), data.left2right.orient);
    toInnerFrame<4>(J.rightCols<3>(), data.board2left[std::size_t(z.view)].orient);
  });
}

}  // namespace slom::bench
