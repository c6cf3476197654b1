/// What a manifold is, and the operations that work on every one of them.
///
/// A manifold is a set whose points can be moved by small vectors (x [+] d) and whose differences are such
/// vectors (y [-] x); locally it looks like R^DOF (Hertzberg et al., "Integrating generic sensor fusion
/// algorithms with sound state representations through encapsulation of manifolds", 2013, section 3).
/// Manifolds are
///   * types with `scalar`, `DOF`, `x.boxplus(d, scale)` and `x.boxminus(out, y)`, by inheritance too,
///   * `float`, `double` and Eigen column vectors,
///   * std::array<M, N> of a manifold M,
///   * plain aggregates (structs without constructors) all of whose members are manifolds.
#pragma once

#include <array>
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "mtk/detail/aggregate.hpp"
#include "mtk/error.hpp"
#include "mtk/scalar.hpp"
#include "mtk/vectview.hpp"

namespace mtk {

/// How M is a manifold; the primary template is for types that are none.
template <class M>
struct ManifoldTraits {
  static constexpr bool is_manifold = false;
};

/// A type whose points move by `boxplus` and differ by `boxminus`.
template <class M>
concept Manifold = ManifoldTraits<std::remove_cv_t<M>>::is_manifold;

/// Degrees of freedom of M, mtk::Dynamic when they are known only at run time.
template <Manifold M>
inline constexpr int DOF_v = ManifoldTraits<std::remove_cv_t<M>>::DOF;

template <Manifold M>
using scalar_t = typename ManifoldTraits<std::remove_cv_t<M>>::scalar;

/// Tangent vector of M: DOF_v<M> entries.
template <Manifold M>
using tangent_t = PlainVector<scalar_t<M>, DOF_v<M>>;

/// Degrees of freedom of this value.
template <Manifold M>
int dof(const M& x) {
  return ManifoldTraits<M>::dof(x);
}

/// x := x [+] scale * d, d of dof(x) entries.
template <Manifold M>
void boxplus(M& x, vectview<const scalar_t<M>, DOF_v<M>> d, scalar_t<M> scale = scalar_t<M>(1)) {
  ManifoldTraits<M>::boxplus(x, d, scale);
}

/// out := x [-] y, the tangent vector at y that moves y to x.
template <Manifold M>
void boxminus(vectview<scalar_t<M>, DOF_v<M>> out, const M& x, const M& y) {
  ManifoldTraits<M>::boxminus(out, x, y);
}

/// x [+] scale * d as a new value.
template <Manifold M>
M moved(M x, vectview<const scalar_t<M>, DOF_v<M>> d, scalar_t<M> scale = scalar_t<M>(1)) {
  ManifoldTraits<M>::boxplus(x, d, scale);
  return x;
}

/// x [-] y as a new vector.
template <Manifold M>
tangent_t<M> difference(const M& x, const M& y) {
  tangent_t<M> out(dof(y));
  ManifoldTraits<M>::boxminus(out, x, y);
  return out;
}

/// Calls sink(path) for each of the dof(x) components of x in order: `left2right.pos.z`, `left.0`.
template <Manifold M, class Sink>
void visitComponentNames(const M& x, const std::string& path, Sink&& sink) {
  ManifoldTraits<M>::visitComponentNames(x, path, sink);
}

/// Names of the components of x; `path` is put before each of them.
template <Manifold M>
std::vector<std::string> componentNames(const M& x, const std::string& path = "") {
  std::vector<std::string> names;
  visitComponentNames(x, path, [&](std::string name) { names.push_back(std::move(name)); });
  return names;
}

/// Size of the coordinate that each component moves: |x_i| of vectors, 1 for angles. Numerical derivatives
/// take their step widths from it. `out` has dof(x) entries.
template <Manifold M>
void typicalSizes(vectview<scalar_t<M>, DOF_v<M>> out, const M& x) {
  ManifoldTraits<M>::typicalSizes(out, x);
}

namespace detail {

template <class T>
inline constexpr bool is_std_array = false;
template <class T, std::size_t N>
inline constexpr bool is_std_array<std::array<T, N>> = true;

inline std::string joinPath(const std::string& path, std::string_view name) {
  std::string joined(path);
  if (!path.empty() && !name.empty()) joined.push_back('.');
  return joined.append(name.data(), name.size());
}

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

/// x, y, z for vectors of two or three entries, numbers otherwise.
template <class Sink>
void visitIndexNames(int n, bool is_vector, const std::string& path, Sink&& sink) {
  const bool letters = is_vector && (n == 2 || n == 3);
  for (int i = 0; i < n; ++i) sink(joinPath(path, letters ? std::string(1, "xyz"[i]) : std::to_string(i)));
}

/// Nothing is compiled where both sizes are part of the types.
template <class X, class Y>
void requireSameSize(const X& x, const Y& y, const char* operation) {
  if constexpr (X::SizeAtCompileTime == Dynamic || Y::SizeAtCompileTime == Dynamic) {
    if (x.size() == y.size()) return;
    throw Error("mtk.size-mismatch", std::string("the operands of ") + operation + " have " +
                                         std::to_string(x.size()) + " and " + std::to_string(y.size()) +
                                         " entries; give both the same size");
  }
}

}  // namespace detail

/// The type brings the operations itself (or inherits them).
template <class M>
concept ManifoldByMembers =
    detail::HasBoxplus<M> && detail::HasBoxminus<M> && (int(M::DOF) != Dynamic || detail::HasRuntimeDof<M>);

/// Compound types name their members: `mtkMembers(x)` gives references, `mtkMemberNames()` their names.
template <class M>
concept NamedCompound = requires(M& x) {
  M::mtkMembers(x);
  M::mtkMemberNames();
};

namespace detail {

/// Applies `f(part_of_x, part_of_y, offset, dof)` to each member, offsets in the stacked tangent vector.
template <class TupleX, class TupleY, class F>
void forEachPart(TupleX&& x, TupleY&& y, F&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    int offset = 0;
    auto one = [&](auto& part_x, auto& part_y) {
      const int n = dof(part_x);
      f(part_x, part_y, offset);
      offset += n;
    };
    (one(std::get<I>(x), std::get<I>(y)), ...);
  }(std::make_index_sequence<std::tuple_size_v<std::remove_cvref_t<TupleX>>>{});
}

/// Scalar and degrees of freedom of a compound of the manifolds P.
template <class First, class... P>
struct MemberTypes {
  static_assert(
      (Manifold<First> && ... && Manifold<P>),
      "mtk: a member of this compound is not a manifold; its type needs `scalar`, `DOF`, `boxplus` and "
      "`boxminus`, or must be a struct without constructors whose members are all manifolds");
  using scalar = scalar_t<First>;
  static constexpr int DOF =
      ((DOF_v<First> == Dynamic) || ... || (DOF_v<P> == Dynamic)) ? Dynamic : (DOF_v<First> + ... + DOF_v<P>);
};

/// The operations of a compound from those of its members. `Parts::of(x)` ties the members.
template <class M, class Parts>
struct CompoundTraits {
  using Tuple = decltype(Parts::of(std::declval<M&>()));
  using scalar = scalar_t<std::remove_cvref_t<std::tuple_element_t<0, Tuple>>>;
  static constexpr bool is_manifold = true;
  static constexpr int DOF = []<class... P>(std::type_identity<std::tuple<P...>>) {
    return MemberTypes<std::remove_cvref_t<P>...>::DOF;
  }(std::type_identity<Tuple>{});

  static int dof(const M& x) {
    if constexpr (DOF != Dynamic) {
      return DOF;
    } else {
      return std::apply([](const auto&... part) { return (mtk::dof(part) + ...); }, Parts::of(x));
    }
  }
  static void boxplus(M& x, vectview<const scalar, DOF> d, scalar scale) {
    forEachPart(Parts::of(x), Parts::of(x), [&](auto& part, auto&, int offset) {
      using P = std::remove_cvref_t<decltype(part)>;
      mtk::boxplus(part, vectview<const scalar, DOF_v<P>>(d.data() + offset, mtk::dof(part)), scale);
    });
  }
  static void boxminus(vectview<scalar, DOF> out, const M& x, const M& y) {
    forEachPart(Parts::of(x), Parts::of(y), [&](const auto& part_x, const auto& part_y, int offset) {
      using P = std::remove_cvref_t<decltype(part_x)>;
      mtk::boxminus(vectview<scalar, DOF_v<P>>(out.data() + offset, mtk::dof(part_x)), part_x, part_y);
    });
  }
  template <class Sink>
  static void visitComponentNames(const M& x, const std::string& path, Sink&& sink) {
    const auto names = Parts::names();
    std::size_t i = 0;
    std::apply(
        [&](const auto&... part) { (mtk::visitComponentNames(part, joinPath(path, names[i++]), sink), ...); },
        Parts::of(x));
  }
  static void typicalSizes(vectview<scalar, DOF> out, const M& x) {
    forEachPart(Parts::of(x), Parts::of(x), [&](const auto& part, const auto&, int offset) {
      using P = std::remove_cvref_t<decltype(part)>;
      mtk::typicalSizes(vectview<scalar, DOF_v<P>>(out.data() + offset, mtk::dof(part)), part);
    });
  }
};

template <class M>
struct NamedParts {
  template <class T>
  static auto of(T& x) {
    return M::mtkMembers(x);
  }
  static auto names() { return M::mtkMemberNames(); }
};

template <class M>
using NamedTraits = CompoundTraits<M, NamedParts<M>>;

template <class M>
struct AggregateParts {
  template <class T>
  static auto of(T& x) {
    return tieMembers(x);
  }
  static auto names() { return memberNames<M>(); }
};

template <class M>
constexpr bool allMembersAreManifolds() {
  if constexpr (memberCount<M>() == 0) {
    return false;
  } else {
    return []<class... P>(std::type_identity<std::tuple<P...>>) {
      return (Manifold<std::remove_cvref_t<P>> && ...);
    }(std::type_identity<MemberTuple<M>>{});
  }
}

}  // namespace detail

/// A struct without constructors whose members are all manifolds. Arrays inside it are std::array, not `T[N]`.
template <class M>
concept AggregateOfManifolds =
    std::is_class_v<M> && std::is_aggregate_v<M> && !ManifoldByMembers<M> && !detail::HasDof<M> &&
    !detail::is_std_array<M> && detail::allMembersAreManifolds<M>();

template <ManifoldByMembers M>
struct ManifoldTraits<M> {
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
      for (const auto& name : M::component_names) sink(detail::joinPath(path, name));
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
    x += scale * d;
  }
  static void boxminus(vectview<scalar, DOF> out, const V& x, const V& y) {
    detail::requireSameSize(x, y, "x [-] y");
    out = x - y;
  }
  template <class Sink>
  static void visitComponentNames(const V& x, const std::string& path, Sink&& sink) {
    detail::visitIndexNames(dof(x), true, path, sink);
  }
  static void typicalSizes(vectview<scalar, DOF> out, const V& x) { out = x.cwiseAbs(); }
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

/// Fails to compile with one sentence that says what M lacks. Functions that take a manifold call it first.
template <class M>
constexpr void requireManifold() {
  constexpr bool ok = Manifold<M>;
  constexpr bool partly = detail::HasScalar<M> || detail::HasDof<M>;
  static_assert(
      ok || !partly || detail::HasScalar<M>,
      "mtk: this type has DOF but is not a manifold: it lacks the member type `scalar` (float or double)");
  static_assert(ok || !partly || detail::HasDof<M>,
                "mtk: this type has `scalar` but is not a manifold: it lacks the constant `DOF`");
  static_assert(ok || !(detail::HasScalar<M> && detail::HasDof<M>) || detail::HasBoxplus<M>,
                "mtk: this type is not a manifold: it lacks "
                "`void boxplus(mtk::vectview<const scalar, DOF> delta, scalar scale = 1)`");
  static_assert(ok || !detail::HasBoxplus<M> || detail::HasBoxminus<M>,
                "mtk: this type is not a manifold: it lacks "
                "`void boxminus(mtk::vectview<scalar, DOF> delta_out, const M& y) const`");
  static_assert(ok || !(detail::HasBoxplus<M> && detail::HasBoxminus<M>),
                "mtk: this type has DOF = Dynamic but is not a manifold: it lacks `int dof() const`");
  static_assert(ok || partly,
                "mtk: this type is not a manifold: give it `scalar`, `DOF`, `boxplus` and `boxminus`, "
                "or make it a struct without constructors whose members are all manifolds");
}

}  // namespace mtk
