#include "calibrate/quality/lens.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "calibrate/lens_derivatives.hpp"

namespace slom::app::calib {
namespace {

/// The sum of u u^T + v v^T over rows u, v of Jacobians, its lower triangle by blocks of four rows. Sizes and
/// loops are known to the compiler: hundreds of candidates for further views have a hundred points each.
template <int N>
class SumOfSquares {
  static constexpr int blocks = (N + 3) / 4;
  using Column = std::array<Eigen::Array4d, blocks>;

 public:
  class Row {
   public:
    Row() { blocks_.fill(Eigen::Array4d::Zero()); }
    double* data() { return blocks_.front().data(); }

   private:
    friend class SumOfSquares;
    Column blocks_;
  };

  SumOfSquares() { columns_.fill(Row().blocks_); }
  void add(const Row& u, const Row& v) {
    addColumns(u.blocks_, v.blocks_, std::make_integer_sequence<int, N>(),
               std::make_integer_sequence<int, blocks>());
  }
  Eigen::Matrix<double, N, N> square() const {
    Eigen::Matrix<double, N, N> square;
    for (int j = 0; j < N; ++j) {
      for (int i = j; i < N; ++i) square(i, j) = square(j, i) = columns_[j][i / 4][i % 4];
    }
    return square;
  }

 private:
  template <int... j, int... block>
  void addColumns(const Column& u, const Column& v, std::integer_sequence<int, j...>,
                  std::integer_sequence<int, block...> all) {
    (addColumn<j>(u, v, all), ...);
  }
  template <int j, int... block>
  void addColumn(const Column& u, const Column& v, std::integer_sequence<int, block...>) {
    const double a = u[j / 4][j % 4], b = v[j / 4][j % 4];
    (addBlock<j, block>(u, v, a, b), ...);
  }
  template <int j, int block>
  void addBlock(const Column& u, const Column& v, double a, double b) {
    if constexpr (block >= j / 4) columns_[j][block] += a * u[block] + b * v[block];
  }

  std::array<Column, N> columns_;
};

template <class Camera>
class ModelLens : public Lens {
 public:
  explicit ModelLens(const CameraResult& camera) {
    for (int i = 0; i < n; ++i) camera_[i] = camera.parameters[std::size_t(i)].value;
    scale_ = calib::differentiate(camera_, Eigen::Vector3d(0, 0, 1)).by_point.norm() / std::sqrt(2.0);
  }

  int parameters() const override { return n; }

  vec2 project(const vec3& point) const override { return vec2(camera_.project(point)); }

  Projection differentiate(const vec3& point) const override {
    const auto d = calib::differentiate(camera_, point);
    return {{vec2(d.pixel), d.by_point}, d.by_parameters};
  }

  PointProjection differentiateByPoint(const vec3& point) const override {
    const auto d = calib::differentiate(camera_, point);
    return {vec2(d.pixel), d.by_point};
  }

  Square square(const SE3& left2camera, const SE3& left2world,
                const std::vector<vec3>& points) const override {
    const Eigen::Matrix3d R = left2camera.orient.toRotationMatrix();
    const Eigen::Matrix3d world2left = left2world.orient.toRotationMatrix().transpose();
    const Eigen::Vector3d origin = left2world.pos, offset = left2camera.pos;
    SumOfSquares<n + 6> sum;
    for (const vec3& point : points) {
      const Eigen::Vector3d in_left = world2left * (Eigen::Vector3d(point) - origin);
      const auto d = calib::differentiate(camera_, Eigen::Vector3d(R * in_left) + offset);
      typename SumOfSquares<n + 6>::Row rows[2];
      for (int row = 0; row < 2; ++row) {
        const Eigen::Vector3d by_point = d.by_point.row(row), by_left = R.transpose() * by_point,
                              by_turn = in_left.cross(by_left);
        double* const J = rows[row].data();
        for (int i = 0; i < n; ++i) J[i] = d.by_parameters(row, i);
        for (int i = 0; i < 3; ++i) J[n + i] = by_point[i], J[n + 3 + i] = by_turn[i];
      }
      sum.add(rows[0], rows[1]);
    }
    return sum.square();
  }

 private:
  static constexpr int n = Camera::DOF;
  Camera camera_;
};

/// Two unit vectors orthogonal to a ray and to each other, as columns; they turn with the ray.
Eigen::Matrix<double, 3, 2> tangents(const vec3& ray) {
  Eigen::Matrix<double, 3, 2> T;
  T.col(0) = Eigen::Vector3d(0, 1, 0).cross(ray).normalized();
  T.col(1) = Eigen::Vector3d(ray).cross(Eigen::Vector3d(T.col(0)));
  return T;
}

}  // namespace

std::optional<vec3> Lens::unproject(const vec2& pixel, vec3 ray) const {
  constexpr double longest_leg = 0.06;  // of a walk [rad], about
  constexpr int most_steps = 8;
  PointProjection at = differentiateByPoint(ray);
  const vec2 start = at.pixel;
  const int legs = 1 + int(std::min(100.0, (pixel - start).norm() / (longest_leg * scale_)));
  for (int leg = 1; leg <= legs; ++leg) {
    const vec2 target(start + double(leg) / legs * (pixel - start));
    double error = 0;
    for (int step = 0; step < most_steps; ++step) {
      const Eigen::Vector2d missing = target - at.pixel;
      error = missing.norm();
      if (error < 1e-7 || (leg < legs && error < 1e-2)) break;
      const Eigen::Matrix<double, 3, 2> T = tangents(ray);
      const Eigen::Matrix2d J = at.by_point * T;
      if (!(J.determinant() > 2e-4 * scale_ * scale_)) return {};  // folds over, or is about to
      const Eigen::Vector2d angle = J.inverse() * missing;
      if (!(angle.norm() < 0.5)) return {};
      ray = vec3((ray + T * angle).normalized());
      if (!(ray.z() > 1e-3)) return {};
      at = differentiateByPoint(ray);
    }
    if (!(error < 1e-2)) return {};
  }
  return ray;
}

std::unique_ptr<Lens> makeLens(const CameraResult& camera) {
  if (camera.model == Radial1<>::model_name) return std::make_unique<ModelLens<Radial1<>>>(camera);
  if (camera.model == Opencv4<>::model_name) return std::make_unique<ModelLens<Opencv4<>>>(camera);
  if (camera.model == Opencv5<>::model_name) return std::make_unique<ModelLens<Opencv5<>>>(camera);
  if (camera.model == Opencv8<>::model_name) return std::make_unique<ModelLens<Opencv8<>>>(camera);
  if (camera.model == Fisheye<>::model_name) return std::make_unique<ModelLens<Fisheye<>>>(camera);
  throw std::logic_error("slom calibrate: no lens of model " + camera.model);
}

}  // namespace slom::app::calib
