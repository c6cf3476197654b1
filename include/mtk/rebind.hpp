/// rebind_t: the type of a variable over another number type, which carries derivatives or is a pack.
///   rebind_t<trafo<SO3<double>>, S> is trafo<SO3<S>>
/// These types can be rebound: numbers, vect, Scalar, SO2, SO3, S2, trafo, Eigen's matrices, std::array, compounds made
/// by MTK_BUILD_MANIFOLD, and class templates all of whose arguments can be rebound (`template <class S> struct
/// Camera`). A struct that is not a template cannot be rebound. Write `template <class S> struct CameraOf {...}; using
/// Camera = CameraOf<double>;` instead.
#pragma once

#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include "mtk/detail/seeding.hpp"
#include "mtk/dual.hpp"
#include "mtk/manifold.hpp"
#include "mtk/pack.hpp"
#include "mtk/types/s2.hpp"
#include "mtk/types/scalar.hpp"
#include "mtk/types/seed.hpp"
#include "mtk/types/so2.hpp"
#include "mtk/types/so3.hpp"
#include "mtk/types/trafo.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

namespace detail {

/// `type` is void if T cannot be rebound.
template <class T, class S>
struct Rebind {
  using type = void;
};
template <class T, class S>
  requires std::is_floating_point_v<T>
struct Rebind<T, S> {
  using type = S;
};
template <int W, class S>
struct Rebind<Pack<W>, S> {
  using type = S;
};
template <class T, class S>
using rebound_t = typename Rebind<T, S>::type;

template <int N, class A, class S>
struct Rebind<vect<N, A>, S> {
  using type = vect<N, S>;
};
template <class A, int R, int C, int O, int MR, int MC, class S>
struct Rebind<Eigen::Matrix<A, R, C, O, MR, MC>, S> {
  // Columns become mtk::vect, which does not convert to vectors of doubles.
  using type =
      std::conditional_t<C == 1, vect<R, S>,
                         Eigen::Matrix<S, R, C, detail::plainStorage<S, R, C>() | (O & Eigen::RowMajor)>>;
};
template <class T, std::size_t N, class S>
  requires(!std::is_void_v<rebound_t<T, S>>)
struct Rebind<std::array<T, N>, S> {
  using type = std::array<rebound_t<T, S>, N>;
};

/// Compounds of MTK_BUILD_MANIFOLD, without types derived from them.
template <class T>
concept MacroCompound = requires { typename T::MtkSelf; } && std::is_same_v<typename T::MtkSelf, T>;
template <class S>
struct UniformMap {
  template <class Member, int Index>
  using member = rebound_t<Member, S>;
};
template <class T>
using MemberTypesOf = decltype(T::mtkMembers(std::declval<T&>()));
template <class T, class S, class Tuple = MemberTypesOf<T>>
inline constexpr bool members_rebindable = false;
template <class T, class S, class... M>
inline constexpr bool members_rebindable<T, S, std::tuple<M&...>> = (!std::is_void_v<rebound_t<M, S>> && ...);

template <MacroCompound T, class S>
  requires members_rebindable<T, S>
struct Rebind<T, S> {
  using type = typename T::template MtkRebound<UniformMap<S>>;
};

/// Class templates over scalars and manifolds.
template <template <class...> class T, class... A, class S>
  requires(Manifold<T<A...>> && (!std::is_void_v<rebound_t<A, S>> && ...))
struct Rebind<T<A...>, S> {
  using type = T<rebound_t<A, S>...>;
};

}  // namespace detail

/// T over the scalar S; void if T cannot be rebound.
template <class T, class S>
using rebind_t = detail::rebound_t<T, S>;

/// True if T exists over other scalars.
template <class T>
inline constexpr bool is_rebindable_v = !std::is_void_v<rebind_t<T, Dual<double, 1>>>;

namespace detail {

/// T over S with derivatives with respect to the unknowns Offset, Offset + 1, ... Each part has only its own columns.
template <class T, class S, int Offset>
struct SparseRebind {
  using type = rebound_t<T, SparseDual<S, lowColumns(DOF_v<T>) << Offset>>;
};
template <class R, class S, int Offset>
struct SparseRebind<trafo<R>, S, Offset> {
  using type = SparseTrafo<typename SparseRebind<R, S, Offset + R::DIM>::type, SeedVector<R::DIM, S, Offset>>;
};
/// Class templates over their number type that promise to read their entries only by get<I>().
template <class T, class S, int Offset>
  requires(T::has_separate_entries)
struct SparseRebind<T, S, Offset> {
  using type = rebound_t<T, SeparateUnknowns<S, Offset>>;
};
template <class S, int Offset>
struct SparseRebind<SO3<>, S, Offset> {
  using type = SeedRotation<S, lowColumns(3) << Offset>;
};
template <int N, class S, int Offset>
  requires(N > 0)
struct SparseRebind<vect<N>, S, Offset> {
  using type = SeedVector<N, S, Offset>;
};
/// Returns the degrees of freedom of the first `count` of the members M.
template <class... M>
constexpr int dofOfFirst(int count, std::type_identity<std::tuple<M&...>>) {
  const int dofs[] = {DOF_v<M>...};
  int sum = 0;
  for (int i = 0; i < count; ++i) sum += dofs[i];
  return sum;
}
template <class T, class S, int Offset>
struct SparseMap {
  template <class Member, int Index>
  using member =
      typename SparseRebind<Member, S,
                            Offset + dofOfFirst(Index, std::type_identity<MemberTypesOf<T>>{})>::type;
};
template <MacroCompound T, class S, int Offset>
struct SparseRebind<T, S, Offset> {
  using type = typename T::template MtkRebound<SparseMap<T, S, Offset>>;
};
template <class T, class S, int Offset>
using sparse_rebind_t = typename SparseRebind<T, S, Offset>::type;

}  // namespace detail

/// Returns x over another number type without loss, such as a constant as a dual number.
template <class S, class X>
rebind_t<X, S> lifted(const X& x) {
  rebind_t<X, S> y{};
  detail::forEachBasicPart(y, x, 0,
                           [](auto& part_y, const auto& part_x, int) { detail::liftPart(part_y, part_x); });
  return y;
}

}  // namespace mtk
