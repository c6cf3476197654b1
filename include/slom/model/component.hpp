/// Components of a variable: those that a member consists of, and their coordinates.
#pragma once

#include <limits>
#include <type_traits>
#include <typeinfo>
#include <utility>

#include <Eigen/Core>

#include "mtk/rebind.hpp"
#include "mtk/types/trafo.hpp"

namespace slom {

namespace detail {

/// Returns the components [first, first + count) of `member`, a part of x at any depth; first < 0 if it is not a part.
/// `at`: the first component of x.
template <class X>
std::pair<int, int> componentsOf(const X& x, const void* member, const std::type_info& type, int at) {
  if (static_cast<const void*>(&x) == member && typeid(X) == type) return {at, mtk::dof(x)};
  std::pair<int, int> found{-1, 0};
  const auto look = [&](const auto& part) {
    if (found.first < 0) found = componentsOf(part, member, type, at);
    at += mtk::dof(part);
  };
  if constexpr (mtk::detail::Compound<X>) {
    auto members = mtk::detail::membersOf(x);
    std::apply([&](const auto&... part) { (look(part), ...); }, members);
  } else if constexpr (mtk::detail::StdArray<X>) {
    for (const auto& part : x) look(part);
  }
  return found;
}

}  // namespace detail

/// Writes the coordinate that each component moves: the number itself for numbers and vectors, NaN for rotations and
/// other types that are not vector spaces.
template <class X>
void coordinates(const X& x, double* out) {
  mtk::detail::forEachBasicPart(x, x, 0, [out](const auto& part, const auto&, int at) {
    using P = std::remove_cvref_t<decltype(part)>;
    if constexpr (std::is_arithmetic_v<P>) {
      out[at] = part;
    } else if constexpr (requires { []<class D>(const Eigen::MatrixBase<D>&) {}(part); }) {
      for (Eigen::Index i = 0; i < part.size(); ++i) out[at + i] = part[i];
    } else if constexpr (std::is_convertible_v<P, double> && mtk::DOF_v<P> == 1 &&
                         !mtk::detail::is_rotation<P>) {
      out[at] = static_cast<double>(part);
    } else {
      for (int i = 0; i < mtk::dof(part); ++i) out[at + i] = std::numeric_limits<double>::quiet_NaN();
    }
  });
}

/// A receiver of the values of components without coordinates, for tables.
struct OrientationSink {
  enum class Kind {
    angle,            ///< angle of a rotation in the plane, 1 number [rad]
    rotation_vector,  ///< rotation vector of a rotation in space, 3 numbers [rad]
    direction         ///< a unit vector, 3 numbers
  };
  virtual ~OrientationSink();
  /// Takes one value. `component`: the first component of this part.
  virtual void take(Kind kind, int component, const double* numbers) = 0;
};

/// Passes each rotation and direction among the parts of x to `sink`.
template <class X>
void visitOrientations(const X& x, OrientationSink& sink) {
  mtk::detail::forEachBasicPart(x, x, 0, [&sink](const auto& part, const auto&, int at) {
    using P = std::remove_cvref_t<decltype(part)>;
    if constexpr (mtk::detail::is_rotation<P> && mtk::DOF_v<P> == 1) {
      const double angle = part.angle();
      sink.take(OrientationSink::Kind::angle, at, &angle);
    } else if constexpr (mtk::detail::is_rotation<P>) {
      const auto vector = P::log(part);
      sink.take(OrientationSink::Kind::rotation_vector, at, vector.data());
    } else if constexpr (mtk::DOF_v<P> == 2 && requires { part.vector().data(); }) {
      sink.take(OrientationSink::Kind::direction, at, part.vector().data());
    }
  });
}

}  // namespace slom
