#include "slom/model/gauge_generators.hpp"

#include <Eigen/Geometry>

namespace slom::detail {

namespace {

using Eigen::Vector3d;

Vector3d vectorOf(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

/// The column of a motion, from a row on.
struct Columns {
  double* out;
  int dof;
  double& operator()(int row, int motion) const { return out[motion * dof + row]; }
};

constexpr int kScale = 6;

}  // namespace

void GaugeGeneratorWriter::addVector(const Vector& p, int dim, int at) const {
  const Columns entry{out_, dof_};
  const Vector3d v = vectorOf(p);
  for (int k = 0; k < dim && role_ == WorldRole::in_world; ++k) entry(at + k, k) = 1;
  for (int k = dim == 2 ? 2 : 0; k < 3; ++k) {
    const Vector3d turned = Vector3d::Unit(k).cross(v);
    for (int i = 0; i < dim; ++i) entry(at + i, 3 + k) = turned[i];
  }
  for (int i = 0; i < dim; ++i) entry(at + i, kScale) = v[i];
}

void GaugeGeneratorWriter::addRotation2(int at) const {
  Columns{out_, dof_}(at, 5) = role_ == WorldRole::sees_world ? -1 : 1;
}

void GaugeGeneratorWriter::addRotation3(const Matrix& rotation, int at) const {
  const Columns entry{out_, dof_};
  const bool sees = role_ == WorldRole::sees_world;
  for (int k = 0; k < 3; ++k) {
    const Vector3d row = vectorOf(rotation[static_cast<std::size_t>(k)]);
    for (int i = 0; i < 3; ++i) entry(at + i, 3 + k) = sees ? (i == k ? -1.0 : 0.0) : row[i];
  }
}

void GaugeGeneratorWriter::addSeeingPosition(const Vector& p, const Matrix& rotation, int dim, int at) const {
  const Columns entry{out_, dof_};
  for (int i = 0; i < dim; ++i) {
    const Vector3d row = vectorOf(rotation[static_cast<std::size_t>(i)]);
    for (int k = 0; k < dim; ++k) entry(at + i, k) = -row[k];
    entry(at + i, kScale) = vectorOf(p)[i];
  }
}

void GaugeGeneratorWriter::addDirection(const Vector& direction, int at) const {
  if (role_ == WorldRole::sees_world) return;
  constexpr double small = 1e-6;
  const Columns entry{out_, dof_};
  const Vector3d v = vectorOf(direction);
  const mtk::S2<double> unmoved(v);
  for (int k = 0; k < 3; ++k) {
    const Vector3d turned = v + small * Vector3d::Unit(k).cross(v);
    const auto d = mtk::difference(mtk::S2<double>(turned), unmoved);
    for (int i = 0; i < 2; ++i) entry(at + i, 3 + k) = d[i] / small;
  }
}

}  // namespace slom::detail
