// The residuals of a problem once more, with derivatives, for the judge of fits.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "fuzz/fit/jet.hpp"
#include "fuzz/fit/problem.hpp"

namespace slom::fuzz::fit {

using Vector3 = std::array<Jet, 3>;

struct Quaternion {
  Jet x, y, z, w;

  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
  }
  Quaternion inverse() const { return {-x, -y, -z, w}; }
  Vector3 rotated(const Vector3& p) const {
    const Quaternion q = *this * Quaternion{p[0], p[1], p[2], 0} * inverse();
    return {q.x, q.y, q.z};
  }
};

/// A variable's value: x [+] d at d = 0, with derivatives by d.
struct Place {
  Vector3 position;
  Jet angle;
  Quaternion q{0, 0, 0, 1};
};

inline Quaternion unitQuaternion(const double* c) {
  const long double x = c[0], y = c[1], z = c[2], w = c[3], n = std::sqrt(x * x + y * y + z * z + w * w);
  return {x / n, y / n, z / n, w / n};
}

inline Place placeOf(Type type, const Value& value) {
  Place place;
  const std::size_t n = std::size_t(positionOf(type));
  for (std::size_t i = 0; i < n; ++i) place.position[i] = value[i];
  if (type == Type::pose2) place.angle = value[2];
  if (type == Type::rotation || type == Type::pose3) place.q = unitQuaternion(value.data() + n);
  return place;
}

/// The same with unknowns from number `first` on.
inline Place placeOf(Type type, const Value& value, int first) {
  Place place = placeOf(type, value);
  const int n = positionOf(type);
  for (int i = 0; i < n; ++i) place.position[std::size_t(i)].d[std::size_t(first + i)] = 1;
  if (type == Type::pose2) place.angle.d[std::size_t(first + 2)] = 1;
  if (type == Type::rotation || type == Type::pose3) {
    Quaternion d{Jet::unknown(0, first + n), Jet::unknown(0, first + n + 1), Jet::unknown(0, first + n + 2),
                 1};
    for (Jet* c : {&d.x, &d.y, &d.z}) *c = 0.5L * *c;
    place.q = place.q * d;
  }
  return place;
}

struct Residual {
  std::vector<Jet> r;
  bool is_smooth = true;  ///< not at a turn by 180 degrees, or at a distance of 0

  void addLogarithm(const Quaternion& q) {
    const Jet square = q.x * q.x + q.y * q.y + q.z * q.z;
    Jet factor = 2.0L / q.w;
    if (square.v > 1e-36L * q.w.v * q.w.v) {
      const Jet n = sqrt(square), sign = q.w.v < 0 ? -1.0L : 1.0L;
      factor = sign * 2.0L * atan2(n, sign * q.w) / n;
    }
    for (const Jet& c : {q.x, q.y, q.z}) r.push_back(factor * c);
    if (!(std::abs(q.w.v) > 1e-9L)) is_smooth = false;
  }
  void addAngle(const Jet& angle) {
    constexpr long double pi = 3.14159265358979323846264338327950288L;
    Jet wrapped = angle;
    wrapped.v = std::remainder(angle.v, 2 * pi);
    if (!(std::abs(wrapped.v) < pi - 1e-9L)) is_smooth = false;
    r.push_back(wrapped);
  }
};

/// Returns the residual, not whitened, with derivatives. a's unknowns come first, then b's.
inline Residual residualOf(const Measurement& m, Type ta, const Value& va, Type tb, const Value& vb) {
  const Place a = placeOf(ta, va, 0), b = placeOf(tb, vb, dofOf(ta)), z = placeOf(ta, m.z);
  const std::size_t n = std::size_t(positionOf(ta));
  const auto backTurned = [](Type type, const Place& place, const Vector3& p) -> Vector3 {
    if (type == Type::pose3) return place.q.inverse().rotated(p);
    const Jet c = cos(place.angle), s = sin(place.angle);
    return {c * p[0] + s * p[1], c * p[1] - s * p[0], 0};
  };
  Residual result;
  const Vector3 way{b.position[0] - a.position[0], b.position[1] - a.position[1],
                    b.position[2] - a.position[2]};
  switch (m.kind) {
    case Kind::prior:
      for (std::size_t i = 0; i < n; ++i) result.r.push_back(a.position[i] - z.position[i]);
      if (ta == Type::pose2) result.addAngle(a.angle - z.angle);
      if (ta == Type::rotation || ta == Type::pose3) result.addLogarithm(z.q.inverse() * a.q);
      break;
    case Kind::scalar:
    case Kind::numeric: {
      std::vector<Jet> u;
      for (int i = 0; i < positionOf(ta); ++i) u.push_back(a.position[std::size_t(i)]);
      for (int i = 0; i < positionOf(tb); ++i) u.push_back(b.position[std::size_t(i)]);
      u.resize(3);
      result.r.push_back(model<Jet>(m.formula, m.c, u[0], u[1], u[2]) - m.z[0]);
      break;
    }
    case Kind::range: {
      const Jet distance = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
      const long double size =
          std::abs(a.position[0].v) + std::abs(a.position[1].v) + std::abs(a.position[2].v);
      if (!(distance.v > 1e-9L * size) || !(distance.v > 1e-150L)) result.is_smooth = false;
      result.r.push_back(distance - m.z[0]);
      break;
    }
    case Kind::relative: {
      if (n > 0) {
        Vector3 seen = backTurned(ta, a, way);
        for (std::size_t i = 0; i < n; ++i) seen[i] = seen[i] - z.position[i];
        seen = backTurned(ta, z, seen);
        result.r.assign(seen.begin(), seen.begin() + long(n));
      }
      if (ta == Type::pose2) {
        result.addAngle(b.angle - a.angle - z.angle);
      } else {
        result.addLogarithm(z.q.inverse() * a.q.inverse() * b.q);
      }
      break;
    }
    case Kind::landmark: {
      const Vector3 seen = backTurned(ta, a, way);
      for (std::size_t i = 0; i < n; ++i) result.r.push_back(seen[i] - m.z[i]);
    }
  }
  return result;
}

}  // namespace slom::fuzz::fit
