/// Definition of a manifold. Operations of every manifold are in mtk/operations.hpp, compounds in mtk/compounds.hpp.
///
/// A manifold is a set whose points can be moved by small vectors (x [+] d) and whose differences are such vectors (y
/// [-] x). Locally it looks like R^DOF (Hertzberg et al., "Integrating generic sensor fusion algorithms with sound
/// state representations through encapsulation of manifolds", 2013, section 3). These types are manifolds:
///   * types with `scalar`, `DOF`, `x.boxplus(d, scale)` and `x.boxminus(out, y)`, also by inheritance,
///   * `float`, `double` and Eigen column vectors,
///   * std::array<M, N> of a manifold M,
///   * plain aggregates (structs without constructors) all of whose members are manifolds.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <string>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/compounds.hpp"
#include "mtk/detail/lanes.hpp"
#include "mtk/error.hpp"
#include "mtk/operations.hpp"
#include "mtk/scalar.hpp"
#include "mtk/vectview.hpp"

namespace mtk {

namespace detail {

template <class T>
inline constexpr bool is_std_array = false;
template <class T, std::size_t N>
inline constexpr bool is_std_array<std::array<T, N>> = true;

template <class M>
concept HasScalar = requires { typename M::scalar; } && is_scalar_v<typename M::scalar>;

template <class M>
concept HasDof = requires {
  { M::DOF } -> std::convertible_to<int>;
};

template <class M>
concept HasBoxplus =
    HasScalar<M> && HasDof<M> && requires(M& x, vectview<const typename M::scalar, int(M::DOF)> d) {
      x.boxplus(d, typename M::scalar(1));
    };

template <class M>
concept HasBoxminus =
    HasScalar<M> && HasDof<M> &&
    requires(const M& x, const M& y, vectview<typename M::scalar, int(M::DOF)> out) { x.boxminus(out, y); };

template <class M>
concept HasRuntimeDof = requires(const M& x) {
  { x.dof() } -> std::convertible_to<int>;
};

template <class M>
concept IsEigenColumn = std::is_base_of_v<Eigen::PlainObjectBase<M>, M> && int(M::ColsAtCompileTime) == 1;

template <class M>
concept DerivesFromEigen = requires(const M& x) { []<class D>(const Eigen::MatrixBase<D>&) {}(x); };

// Loops instead of Eigen's expressions. Each expression is its own type, which every program would compile for every
// type of variable.

/// Computes x += scale * d.
template <class X, class S, int N>
void addScaled(X& x, const S& scale, const vectview<const S, N>& d) {
  forEachEntry<N>(d.size(), [&](int i) { x.coeffRef(i) += scale * d.coeff(i); });
}
/// Computes out = x - y.
template <class S, int N, class X>
void setDifference(vectview<S, N>& out, const X& x, const X& y) {
  forEachEntry<N>(x.size(), [&](int i) { out.coeffRef(i) = x.coeff(i) - y.coeff(i); });
}
/// Computes out = |x|, entry by entry.
template <class S, int N, class X>
void setMagnitudes(vectview<S, N>& out, const X& x) {
  using std::abs;
  forEachEntry<N>(x.size(), [&](int i) { out.coeffRef(i) = abs(x.coeff(i)); });
}

/// Calls sink with x, y, z for vectors of 2 or 3 entries, and with numbers otherwise.
template <class Sink>
void visitIndexNames(int n, bool is_vector, const std::string& path, Sink&& sink) {
  const bool letters = is_vector && (n == 2 || n == 3);
  for (int i = 0; i < n; ++i) sink(joinPath(path, letters ? std::string(1, "xyz"[i]) : std::to_string(i)));
}

/// Throws if the sizes differ. If both sizes are part of the types, nothing is compiled.
template <class X, class Y>
void requireSameSize(const X& x, const Y& y, const char* operation) {
  if constexpr (X::SizeAtCompileTime == Dynamic || Y::SizeAtCompileTime == Dynamic) {
    if (x.size() == y.size()) return;
    detail::raise(Error("mtk.size-mismatch",
                        std::string("the operands of ") + operation + " have " + std::to_string(x.size()) +
                            " and " + std::to_string(y.size()) + " entries; give both the same size"));
  }
}

}  // namespace detail

namespace detail {
/// Fails to compile for a compound with a member that is not a manifold. MTK_BUILD_MANIFOLD accepts such a member if it
/// states a DOF.
template <class M>
constexpr bool membersAreManifolds() {
  if constexpr (NamedCompound<M>) {
    return NamedTraits<M>::DOF >= Dynamic;
  } else {
    return true;
  }
}
}  // namespace detail

/// A type that has the operations as members, its own or inherited.
template <class M>
concept ManifoldByMembers =
    detail::HasBoxplus<M> && detail::HasBoxminus<M> && (int(M::DOF) != Dynamic || detail::HasRuntimeDof<M>);

/// A struct without constructors whose members are all manifolds. Arrays in it must be std::array, not `T[N]`.
template <class M>
concept AggregateOfManifolds =
    std::is_class_v<M> && std::is_aggregate_v<M> && !ManifoldByMembers<M> && !detail::HasDof<M> &&
    !detail::is_std_array<M> && detail::allMembersAreManifolds<M>();

template <ManifoldByMembers M>
struct ManifoldTraits<M> {
  static_assert(detail::membersAreManifolds<M>());
  using scalar = typename M::scalar;
  static constexpr bool is_manifold = true;
  static constexpr int DOF = int(M::DOF);

  static int dof(const M& x) {
    if constexpr (DOF == Dynamic) {
      return static_cast<int>(x.dof());
    } else {
      return DOF;
    }
  }
  static void boxplus(M& x, vectview<const scalar, DOF> d, scalar scale) { x.boxplus(d, scale); }
  static void boxminus(vectview<scalar, DOF> out, const M& x, const M& y) { x.boxminus(out, y); }

  template <class Sink>
  static void visitComponentNames(const M& x, const std::string& path, Sink&& sink) {
    if constexpr (NamedCompound<M>) {
      detail::NamedTraits<M>::visitComponentNames(x, path, sink);
    } else if constexpr (requires { M::component_names; }) {
      static_assert(DOF == Dynamic || std::size(M::component_names) == std::size_t(DOF),
                    "mtk: `component_names` must have one name for each degree of freedom (`DOF`)");
      for (const auto& name : M::component_names) sink(detail::joinPath(path, name));
    } else if constexpr (DOF == Dynamic && requires { x.componentNames(); }) {
      for (const auto& name : x.componentNames()) sink(detail::joinPath(path, name));
    } else {
      detail::visitIndexNames(dof(x), detail::DerivesFromEigen<M>, path, sink);
    }
  }
  static void typicalSizes(vectview<scalar, DOF> out, const M& x) {
    if constexpr (NamedCompound<M>) {
      detail::NamedTraits<M>::typicalSizes(out, x);
    } else if constexpr (requires { x.typicalSizes(out); }) {
      x.typicalSizes(out);
    } else {
      out.setOnes();
    }
  }
};

template <class S>
  requires is_scalar_v<S>
struct ManifoldTraits<S> {
  using scalar = S;
  static constexpr bool is_manifold = true;
  static constexpr int DOF = 1;
  static int dof(const S&) { return 1; }
  static void boxplus(S& x, vectview<const S, 1> d, S scale) { x += scale * d[0]; }
  static void boxminus(vectview<S, 1> out, const S& x, const S& y) { out[0] = x - y; }
  template <class Sink>
  static void visitComponentNames(const S&, const std::string& path, Sink&& sink) {
    sink(path);
  }
  static void typicalSizes(vectview<S, 1> out, const S& x) { out[0] = x < S(0) ? -x : x; }
};

template <class V>
  requires(detail::IsEigenColumn<V> && !ManifoldByMembers<V> && is_scalar_v<typename V::Scalar>)
struct ManifoldTraits<V> {
  using scalar = typename V::Scalar;
  static constexpr bool is_manifold = true;
  static constexpr int DOF = V::RowsAtCompileTime;
  static int dof(const V& x) { return static_cast<int>(x.size()); }
  static void boxplus(V& x, vectview<const scalar, DOF> d, scalar scale) {
    detail::requireSameSize(x, d, "x [+] d");
    detail::addScaled(x, scale, d);
  }
  static void boxminus(vectview<scalar, DOF> out, const V& x, const V& y) {
    detail::requireSameSize(x, y, "x [-] y");
    detail::setDifference(out, x, y);
  }
  template <class Sink>
  static void visitComponentNames(const V& x, const std::string& path, Sink&& sink) {
    detail::visitIndexNames(dof(x), true, path, sink);
  }
  static void typicalSizes(vectview<scalar, DOF> out, const V& x) { detail::setMagnitudes(out, x); }
};

template <Manifold M, std::size_t N>
  requires(N > 0)
struct ManifoldTraits<std::array<M, N>> {
  using Array = std::array<M, N>;
  using scalar = scalar_t<M>;
  static constexpr bool is_manifold = true;
  static constexpr int DOF = DOF_v<M> == Dynamic ? Dynamic : DOF_v<M> * static_cast<int>(N);
  static int dof(const Array& x) {
    int sum = 0;
    for (const M& part : x) sum += mtk::dof(part);
    return sum;
  }
  static void boxplus(Array& x, vectview<const scalar, DOF> d, scalar scale) {
    const scalar* at = d.data();
    for (M& part : x) {
      const int n = mtk::dof(part);
      mtk::boxplus(part, vectview<const scalar, DOF_v<M>>(at, n), scale);
      at += n;
    }
  }
  static void boxminus(vectview<scalar, DOF> out, const Array& x, const Array& y) {
    scalar* at = out.data();
    for (std::size_t i = 0; i < N; ++i) {
      const int n = mtk::dof(y[i]);
      mtk::boxminus(vectview<scalar, DOF_v<M>>(at, n), x[i], y[i]);
      at += n;
    }
  }
  template <class Sink>
  static void visitComponentNames(const Array& x, const std::string& path, Sink&& sink) {
    for (std::size_t i = 0; i < N; ++i) {
      mtk::visitComponentNames(x[i], detail::joinPath(path, std::to_string(i)), sink);
    }
  }
  static void typicalSizes(vectview<scalar, DOF> out, const Array& x) {
    scalar* at = out.data();
    for (const M& part : x) {
      const int n = mtk::dof(part);
      mtk::typicalSizes(vectview<scalar, DOF_v<M>>(at, n), part);
      at += n;
    }
  }
};

template <AggregateOfManifolds M>
struct ManifoldTraits<M> : detail::CompoundTraits<M, detail::AggregateParts<M>> {};

namespace detail {
// Eigen/Core declares the names of these types.
template <class M>
inline constexpr bool is_eigens_rotation = false;
template <class S, int Options>
inline constexpr bool is_eigens_rotation<Eigen::Quaternion<S, Options>> = true;
template <class S>
inline constexpr bool is_eigens_rotation<Eigen::AngleAxis<S>> = true;
template <class S>
inline constexpr bool is_eigens_rotation<Eigen::Rotation2D<S>> = true;
template <class M>
inline constexpr bool is_eigens_transform = false;
template <class S, int Dim, int Mode, int Options>
inline constexpr bool is_eigens_transform<Eigen::Transform<S, Dim, Mode, Options>> = true;
template <class M>
constexpr bool hasArrayMemberOf() {
  if constexpr (std::is_class_v<M> && std::is_aggregate_v<M> && !Manifold<M>) {
    return hasArrayMember<M>();
  } else {
    return false;
  }
}
}  // namespace detail

/// Fails to compile with one sentence on what M lacks. Functions that take a manifold call it first.
template <class M>
constexpr void requireManifold() {
  constexpr bool ok = Manifold<M>;
  constexpr bool has_array = detail::hasArrayMemberOf<M>();
  constexpr bool partly = has_array || detail::HasScalar<M> || detail::HasDof<M> ||
                          detail::is_eigens_rotation<M> || detail::is_eigens_transform<M> ||
                          std::is_array_v<M> || std::is_pointer_v<M>;
  static_assert(!detail::is_eigens_rotation<M>,
                "mtk: Eigen's rotations are not manifolds: use mtk::SO3<>(q) for an Eigen::Quaterniond or "
                "Eigen::AngleAxisd, mtk::SO2<>(r.angle()) for an Eigen::Rotation2Dd");
  static_assert(
      !detail::is_eigens_transform<M>,
      "mtk: Eigen's transforms are not manifolds: use mtk::trafo<mtk::SO3<>>(mtk::SO3<>(T.linear()), "
      "T.translation()) for an Eigen::Isometry3d, and mtk::SO2<> in the plane");
  static_assert(!std::is_array_v<M> && !std::is_pointer_v<M>,
                "mtk: arrays T[N] and pointers are not manifolds: use std::array<T, N> or, for numbers, "
                "mtk::vect<N>");
  static_assert(!has_array,
                "mtk: this struct has a member T[N], which is not a manifold: use std::array<T, N> or, for "
                "numbers, mtk::vect<N>");
  static_assert(
      ok || !detail::HasDof<M> || detail::HasScalar<M>,
      "mtk: this type has DOF but is not a manifold: it lacks the member type `scalar` (float or double)");
  static_assert(ok || !detail::HasScalar<M> || detail::HasDof<M>,
                "mtk: this type has `scalar` but is not a manifold: it lacks the constant `DOF`");
  static_assert(ok || !(detail::HasScalar<M> && detail::HasDof<M>) || detail::HasBoxplus<M>,
                "mtk: this type is not a manifold: it lacks "
                "`void boxplus(mtk::vectview<const scalar, DOF> delta, scalar scale = 1)`");
  static_assert(ok || !detail::HasBoxplus<M> || detail::HasBoxminus<M>,
                "mtk: this type is not a manifold: it lacks "
                "`void boxminus(mtk::vectview<scalar, DOF> delta_out, const M& y) const`");
  static_assert(ok || !(detail::HasBoxplus<M> && detail::HasBoxminus<M>),
                "mtk: this type has DOF = Dynamic but is not a manifold: it lacks `int dof() const`");
  static_assert(
      ok || partly,
      "mtk: this type is not a manifold: give it `scalar`, `DOF`, `boxplus` and `boxminus`, "
      "or make it a struct without constructors whose members are all manifolds (mtk::SO3<> in place of "
      "Eigen::Quaterniond)");
}

}  // namespace mtk
