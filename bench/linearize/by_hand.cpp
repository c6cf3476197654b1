// Closed formulas. Rotations are perturbed on the right, R exp(d), tangents are (translation, rotation):
//   P = R X + t,  a' = (d u / d P)'  gives  d u / d t = a',  d u / d X = (R' a)',  d u / d rotation = (X x R' a)'
#include <cmath>

#include "linearize/variants.hpp"

namespace slom::bench {

namespace {

struct Vec3 {
  double x, y, z;
};

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 load(const mtk::vect<3>& v) { return {v[0], v[1], v[2]}; }

/// Unit quaternion.
struct Quat {
  double x, y, z, w;
};

Quat load(const mtk::SO3<>& R) { return {R.x(), R.y(), R.z(), R.w()}; }

/// Returns conj(a) * b.
Quat between(const Quat& a, const Quat& b) {
  return {a.w * b.x - a.x * b.w - a.y * b.z + a.z * b.y, a.w * b.y + a.x * b.z - a.y * b.w - a.z * b.x,
          a.w * b.z - a.x * b.y + a.y * b.x - a.z * b.w, a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z};
}

/// Rotation matrix.
struct Mat3 {
  Vec3 row0, row1, row2;

  explicit Mat3(const Quat& q) {
    const double x2 = 2 * q.x, y2 = 2 * q.y, z2 = 2 * q.z;
    const double xx = q.x * x2, xy = q.x * y2, xz = q.x * z2, yy = q.y * y2, yz = q.y * z2, zz = q.z * z2;
    const double wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
    row0 = {1 - (yy + zz), xy - wz, xz + wy};
    row1 = {xy + wz, 1 - (xx + zz), yz - wx};
    row2 = {xz - wy, yz + wx, 1 - (xx + yy)};
  }
  Vec3 operator*(const Vec3& v) const {
    return {row0.x * v.x + row0.y * v.y + row0.z * v.z, row1.x * v.x + row1.y * v.y + row1.z * v.z,
            row2.x * v.x + row2.y * v.y + row2.z * v.z};
  }
  /// Returns R' v.
  Vec3 back(const Vec3& v) const {
    return {row0.x * v.x + row1.x * v.y + row2.x * v.z, row0.y * v.x + row1.y * v.y + row2.y * v.z,
            row0.z * v.x + row1.z * v.y + row2.z * v.z};
  }
  Vec3 move(const Vec3& v, const mtk::vect<3>& t) const {
    const Vec3 turned = *this * v;
    return {turned.x + t[0], turned.y + t[1], turned.z + t[2]};
  }
};

/// Writes the row vector v to columns c, c + 1, c + 2 of a row; J points at its first entry.
template <int Rows>
void putRow(double* J, int c, const Vec3& v) {
  J[Rows * c] = v.x;
  J[Rows * (c + 1)] = v.y;
  J[Rows * (c + 2)] = v.z;
}

// ---- bundle adjustment

void linearizeBal(const BalCamera& camera, const mtk::vect<3>& point, const mtk::vect<2>& pixel, double* r,
                  double* J) {
  const Mat3 R(load(camera.pose.orient));
  const Vec3 X = load(point);
  const Vec3 P = R.move(X, camera.pose.pos);
  const double f = camera.lens[0], k1 = camera.lens[1], k2 = camera.lens[2];
  const double to_image = -1 / P.z;
  const double x = P.x * to_image, y = P.y * to_image, r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * k2), slope = 2 * (k1 + 2 * k2 * r2);
  r[0] = f * radial * x - pixel[0];
  r[1] = f * radial * y - pixel[1];

  const double scale = f * to_image;
  const double u_x = scale * (radial + slope * x * x), u_y = scale * slope * x * y;
  const double v_y = scale * (radial + slope * y * y);
  const Vec3 u_P{u_x, u_y, u_x * x + u_y * y}, v_P{u_y, v_y, u_y * x + v_y * y};
  const Vec3 u_X = R.back(u_P), v_X = R.back(v_P);
  putRow<2>(J, 0, u_P);
  putRow<2>(J + 1, 0, v_P);
  putRow<2>(J, 3, cross(X, u_X));
  putRow<2>(J + 1, 3, cross(X, v_X));
  J[12] = radial * x, J[13] = radial * y;
  J[14] = f * r2 * x, J[15] = f * r2 * y;
  J[16] = r2 * J[14], J[17] = r2 * J[15];
  putRow<2>(J, 9, u_X);
  putRow<2>(J + 1, 9, v_X);
}

// ---- relative pose

/// Writes the rotation vector p of q to `out` and the inverse of the right Jacobian of SO(3) at p,
///   I + [p]x / 2 + c [p]x^2,  c = (1 - |p| / 2 cot(|p| / 2)) / |p|^2,
/// to the 3 x 3 block D of a matrix of 6 rows.
void logarithm(const Quat& q, double* out, double* D) {
  const double sign = q.w < 0 ? -1 : 1;
  const double w = sign * q.w, n2 = q.x * q.x + q.y * q.y + q.z * q.z;
  double factor, c;  // p = factor * (q.x, q.y, q.z)
  if (n2 < 1e-6) {
    factor = 2 / w * (1 - n2 / (w * w) * (1.0 / 3 - n2 / (5 * w * w)));
    c = 1.0 / 12 + factor * factor * n2 / 720;
  } else {
    const double n = std::sqrt(n2);
    factor = 2 * std::atan2(n, w) / n;
    c = (1 - factor * w / 2) / (factor * factor * n2);
  }
  factor *= sign;
  const double x = factor * q.x, y = factor * q.y, z = factor * q.z;
  out[0] = x, out[1] = y, out[2] = z;
  const double cx = c * x, cy = c * y, cz = c * z;
  const double xx = cx * x, yy = cy * y, zz = cz * z, xy = cx * y, xz = cx * z, yz = cy * z;
  D[0] = 1 - (yy + zz), D[6] = xy - z / 2, D[12] = xz + y / 2;
  D[1] = xy + z / 2, D[7] = 1 - (xx + zz), D[13] = yz - x / 2;
  D[2] = xz - y / 2, D[8] = yz + x / 2, D[14] = 1 - (xx + yy);
}

void linearizeRelativePose(const SE3& a, const SE3& b, const SE3& measured, double* r, double* J) {
  const Quat qa = load(a.orient), q = between(qa, load(b.orient));  // q: b seen from a
  const Mat3 Ra(qa), R(q);
  const Vec3 d = Ra.back({b.pos[0] - a.pos[0], b.pos[1] - a.pos[1], b.pos[2] - a.pos[2]});
  r[0] = d.x - measured.pos[0], r[1] = d.y - measured.pos[1], r[2] = d.z - measured.pos[2];

  double* const a_pos = J;
  double* const a_orient = J + 18;
  double* const b_pos = J + 36;
  double* const b_orient = J + 54;
  logarithm(between(load(measured.orient), q), r + 3, b_orient + 3);

  const Vec3 column[3] = {Ra.row0, Ra.row1, Ra.row2};  // of Ra'
  for (int c = 0; c < 3; ++c) {
    double* const minus = a_pos + 6 * c;
    double* const plus = b_pos + 6 * c;
    plus[0] = column[c].x, plus[1] = column[c].y, plus[2] = column[c].z;
    minus[0] = -column[c].x, minus[1] = -column[c].y, minus[2] = -column[c].z;
    for (int k = 3; k < 6; ++k) minus[k] = plus[k] = 0;
    for (int k = 0; k < 3; ++k) b_orient[6 * c + k] = 0;
  }
  a_orient[0] = 0, a_orient[6] = -d.z, a_orient[12] = d.y;
  a_orient[1] = d.z, a_orient[7] = 0, a_orient[13] = -d.x;
  a_orient[2] = -d.y, a_orient[8] = d.x, a_orient[14] = 0;
  const Vec3 row[3] = {R.row0, R.row1, R.row2};  // column c of R' is row c of R
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 3; ++k) {
      const double* D = b_orient + 3 + k;
      a_orient[6 * c + 3 + k] = -(D[0] * row[c].x + D[6] * row[c].y + D[12] * row[c].z);
    }
  }
}

// ---- stereo camera

/// Projects P by camera c. Writes the residual to r[0], r[1], and derivatives by P to u_P, v_P. Writes derivatives by
/// the nine parameters to the two rows at J of a matrix of 4 rows.
void linearizeProjection(const mtk::vect<9>& c, const Vec3& P, const double* pixel, double* r, double* J,
                         Vec3& u_P, Vec3& v_P) {
  const double fx = c[0], fy = c[1], k1 = c[4], k2 = c[5], p1 = c[6], p2 = c[7], k3 = c[8];
  const double inverse_z = 1 / P.z;
  const double x = P.x * inverse_z, y = P.y * inverse_z;
  const double xx = x * x, yy = y * y, xy = x * y, r2 = xx + yy, r4 = r2 * r2;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)), slope = 2 * (k1 + r2 * (2 * k2 + 3 * k3 * r2));
  const double along_x = r2 + 2 * xx, along_y = r2 + 2 * yy;
  const double xd = x * radial + 2 * p1 * xy + p2 * along_x, yd = y * radial + p1 * along_y + 2 * p2 * xy;
  r[0] = fx * xd + c[2] - pixel[0];
  r[1] = fy * yd + c[3] - pixel[1];

  const double fx_x = fx * x, fy_y = fy * y;
  const double u[9] = {xd, 0, 1, 0, fx_x * r2, fx_x * r4, 2 * fx * xy, fx * along_x, fx_x * r4 * r2};
  const double v[9] = {0, yd, 0, 1, fy_y * r2, fy_y * r4, fy * along_y, 2 * fy * xy, fy_y * r4 * r2};
  for (int k = 0; k < 9; ++k) J[4 * k] = u[k], J[4 * k + 1] = v[k];

  const double mixed = slope * xy + 2 * p1 * x + 2 * p2 * y;
  const double x_x = radial + slope * xx + 2 * p1 * y + 6 * p2 * x;
  const double y_y = radial + slope * yy + 6 * p1 * y + 2 * p2 * x;
  const double sx = fx * inverse_z, sy = fy * inverse_z;
  u_P = {sx * x_x, sx * mixed, -sx * (x_x * x + mixed * y)};
  v_P = {sy * mixed, sy * y_y, -sy * (mixed * x + y_y * y)};
}

void putZeros(double* J, int first, int last) {
  for (int c = first; c < last; ++c) J[4 * c] = J[4 * c + 1] = 0;
}

void linearizeStereo(const StereoIntrinsics& intrinsics, const SE3& left2right, const SE3& board2left,
                     const mtk::vect<3>& on_board, const mtk::vect<4>& pixels, double* r, double* J) {
  const Mat3 to_left(load(board2left.orient)), to_right(load(left2right.orient));
  const Vec3 X = load(on_board), L = to_left.move(X, board2left.pos), P = to_right.move(L, left2right.pos);
  Vec3 left[2], right[2];
  linearizeProjection(intrinsics.left, L, pixels.data(), r, J, left[0], left[1]);
  linearizeProjection(intrinsics.right, P, pixels.data() + 2, r + 2, J + 4 * 9 + 2, right[0], right[1]);
  putZeros(J + 2, 0, 9);
  putZeros(J, 9, 24);
  for (int k = 0; k < 2; ++k) {
    const Vec3 by_board = to_left.back(left[k]);
    putRow<4>(J + k, 24, left[k]);
    putRow<4>(J + k, 27, cross(X, by_board));
    double* const row = J + 2 + k;
    const Vec3 right_by_left = to_right.back(right[k]), right_by_board = to_left.back(right_by_left);
    putRow<4>(row, 18, right[k]);
    putRow<4>(row, 21, cross(L, right_by_left));
    putRow<4>(row, 24, right_by_left);
    putRow<4>(row, 27, cross(X, right_by_board));
  }
}

constexpr const char* kName = "by hand";

}  // namespace

Variant byHand(const BalData& data) {
  return kernelVariant<2, 12>(kName, kMeasurements, [&data](int i, double* r, double* J) {
    const auto& z = data.observations[std::size_t(i)];
    linearizeBal(data.cameras[std::size_t(z.camera)], data.points[std::size_t(z.point)], z.pixel, r, J);
  });
}

Variant byHand(const PoseGraphData& data) {
  return kernelVariant<6, 12>(kName, kMeasurements, [&data](int i, double* r, double* J) {
    const auto& z = data.edges[std::size_t(i)];
    linearizeRelativePose(data.poses[std::size_t(z.a)], data.poses[std::size_t(z.b)], z.measured, r, J);
  });
}

Variant byHand(const StereoData& data) {
  return kernelVariant<4, 30>(kName, kMeasurements, [&data](int i, double* r, double* J) {
    const auto& z = data.corners[std::size_t(i)];
    linearizeStereo(data.intrinsics, data.left2right, data.board2left[std::size_t(z.view)], z.on_board,
                    z.pixels, r, J);
  });
}

}  // namespace slom::bench
