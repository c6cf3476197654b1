/// Compounds: manifolds that consist of members. Their operations are those of the members, one after another in the
/// stacked tangent vector. mtk/manifold.hpp includes this header.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/detail/aggregate.hpp"
#include "mtk/operations.hpp"

namespace mtk {

/// A compound type that names its members: `mtkMembers(x)` gives references, `mtkMemberNames()` their names.
template <class M>
concept NamedCompound = requires(M& x) {
  M::mtkMembers(x);
  M::mtkMemberNames();
};

namespace detail {

/// Returns `left2right.pos` for path and name; without a dot if one of the two is empty.
inline std::string joinPath(const std::string& path, std::string_view name) {
  std::string joined(path);
  if (!path.empty() && !name.empty()) joined.push_back('.');
  return joined.append(name.data(), name.size());
}

/// Calls `f(part_of_x, part_of_y, offset, dof)` for each member, with offsets in the stacked tangent vector.
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

/// Returns the sum; Dynamic if any of them is Dynamic.
constexpr int sumOfDof(std::initializer_list<int> dofs) {
  int sum = 0;
  for (const int dof : dofs) {
    if (dof == Dynamic) return Dynamic;
    sum += dof;
  }
  return sum;
}

/// Scalar and degrees of freedom of a compound of the manifolds P.
template <class First, class... P>
struct MemberTypes {
  static_assert(
      (Manifold<First> && ... && Manifold<P>),
      "mtk: a member of this compound is not a manifold; its type needs `scalar`, `DOF`, `boxplus` and "
      "`boxminus`, or must be a struct without constructors whose members are all manifolds");
  using scalar = scalar_t<First>;
  static constexpr int DOF = sumOfDof({DOF_v<First>, DOF_v<P>...});
};

template <class Tuple>
struct MemberTypesIn;
template <class... P>
struct MemberTypesIn<std::tuple<P...>> : MemberTypes<std::remove_cvref_t<P>...> {};

/// The operations of a compound, made from those of its members. `Parts::of(x)` ties the members.
template <class M, class Parts>
struct CompoundTraits {
  using Tuple = decltype(Parts::of(std::declval<M&>()));
  using scalar = typename MemberTypesIn<Tuple>::scalar;
  static constexpr bool is_manifold = true;
  static constexpr int DOF = MemberTypesIn<Tuple>::DOF;

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
  } else if constexpr (hasArrayMember<M>()) {
    return false;
  } else {
    return []<class... P>(std::type_identity<std::tuple<P...>>) {
      return (Manifold<std::remove_cvref_t<P>> && ...);
    }(std::type_identity<MemberTuple<M>>{});
  }
}

}  // namespace detail

}  // namespace mtk
