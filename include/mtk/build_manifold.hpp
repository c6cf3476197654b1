/// MTK_BUILD_MANIFOLD(Name, ((Type, name)) ((Type, name)) ...): the published way to declare a compound.
///
///     MTK_BUILD_MANIFOLD(StereoCamera,
///       ((Camera, left))
///       ((Camera, right))
///       ((SE3, left2right))
///     )
///
/// declares a struct with these public members, a default constructor, a constructor from all members, boxplus and
/// boxminus, streaming, and names of the members for messages. A type with a comma needs an alias first. A plain struct
/// with the same members is a manifold too, without a macro. Its operations are templates, so a program compiles only
/// those that it uses.
#pragma once

#include <array>
#include <iosfwd>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "mtk/detail/sequence.hpp"
#include "mtk/manifold.hpp"
#include "mtk/stream.hpp"

namespace mtk::detail {

/// Scalar and degrees of freedom of a member. If the member's type states them, its operations are not examined before
/// they are used. Examining them would dominate the compile time of cameras that a program declares and does not use.
template <class M>
struct Stated : MemberTypes<M> {};
template <class M>
  requires(HasScalar<M> && HasDof<M>)
struct Stated<M> {
  using scalar = typename M::scalar;
  static constexpr int DOF = int(M::DOF);
};
template <class First, class... M>
struct StatedTypes {
  using scalar = typename Stated<First>::scalar;
  static constexpr int DOF = sumOfDof({Stated<First>::DOF, Stated<M>::DOF...});
};

}  // namespace mtk::detail

// clang-format off
#define MTK_MEMBER_A(pair) MTK_PAIR_TYPE pair MTK_PAIR_NAME pair{}; MTK_MEMBER_B
#define MTK_MEMBER_B(pair) MTK_PAIR_TYPE pair MTK_PAIR_NAME pair{}; MTK_MEMBER_A
#define MTK_MEMBER_A_END
#define MTK_MEMBER_B_END

#define MTK_REBOUND_(type, name) typename Map_::template member<type, __COUNTER__ - MtkFirst - 1> name{};
#define MTK_REBOUND_A(pair) MTK_REBOUND_ pair MTK_REBOUND_B
#define MTK_REBOUND_B(pair) MTK_REBOUND_ pair MTK_REBOUND_A
#define MTK_REBOUND_A_END
#define MTK_REBOUND_B_END

#define MTK_PARAMETER_(type, name) const type& name##_init
#define MTK_PARAMETER_A(pair) MTK_PARAMETER_ pair MTK_PARAMETER_MORE_A
#define MTK_PARAMETER_MORE_A(pair) , MTK_PARAMETER_ pair MTK_PARAMETER_MORE_B
#define MTK_PARAMETER_MORE_B(pair) , MTK_PARAMETER_ pair MTK_PARAMETER_MORE_A
#define MTK_PARAMETER_MORE_A_END
#define MTK_PARAMETER_MORE_B_END

#define MTK_INITIALIZER_(type, name) name(name##_init)
#define MTK_INITIALIZER_A(pair) MTK_INITIALIZER_ pair MTK_INITIALIZER_MORE_A
#define MTK_INITIALIZER_MORE_A(pair) , MTK_INITIALIZER_ pair MTK_INITIALIZER_MORE_B
#define MTK_INITIALIZER_MORE_B(pair) , MTK_INITIALIZER_ pair MTK_INITIALIZER_MORE_A
#define MTK_INITIALIZER_MORE_A_END
#define MTK_INITIALIZER_MORE_B_END

#define MTK_TIED_(type, name) x.name
#define MTK_TIED_A(pair) MTK_TIED_ pair MTK_TIED_MORE_A
#define MTK_TIED_MORE_A(pair) , MTK_TIED_ pair MTK_TIED_MORE_B
#define MTK_TIED_MORE_B(pair) , MTK_TIED_ pair MTK_TIED_MORE_A
#define MTK_TIED_MORE_A_END
#define MTK_TIED_MORE_B_END

#define MTK_QUOTED_(type, name) ::std::string_view(#name)
#define MTK_QUOTED_A(pair) MTK_QUOTED_ pair MTK_QUOTED_MORE_A
#define MTK_QUOTED_MORE_A(pair) , MTK_QUOTED_ pair MTK_QUOTED_MORE_B
#define MTK_QUOTED_MORE_B(pair) , MTK_QUOTED_ pair MTK_QUOTED_MORE_A
#define MTK_QUOTED_MORE_A_END
#define MTK_QUOTED_MORE_B_END

#define MTK_TYPE_(type, name) type
#define MTK_TYPE_A(pair) MTK_TYPE_ pair MTK_TYPE_MORE_A
#define MTK_TYPE_MORE_A(pair) , MTK_TYPE_ pair MTK_TYPE_MORE_B
#define MTK_TYPE_MORE_B(pair) , MTK_TYPE_ pair MTK_TYPE_MORE_A
#define MTK_TYPE_MORE_A_END
#define MTK_TYPE_MORE_B_END

#define MTK_BUILD_MANIFOLD(Name, members)                                                                    \
  struct Name {                                                                                              \
    MTK_SEQUENCE(MTK_MEMBER, members)                                                                        \
                                                                                                             \
    Name() = default;                                                                                        \
    explicit Name(MTK_SEQUENCE(MTK_PARAMETER, members)) : MTK_SEQUENCE(MTK_INITIALIZER, members) {}          \
                                                                                                             \
    using MtkTypes = ::mtk::detail::StatedTypes<MTK_SEQUENCE(MTK_TYPE, members)>;                            \
    using scalar = MtkTypes::scalar;                                                                         \
    static constexpr int DOF = MtkTypes::DOF;                                                                \
    template <class T_> static auto mtkMembers(T_& x) { return ::std::tie(MTK_SEQUENCE(MTK_TIED, members)); } \
    static auto mtkMemberNames() { return ::std::array{MTK_SEQUENCE(MTK_QUOTED, members)}; }                 \
                                                                                                             \
    using MtkSelf = Name;                                                                                    \
    template <class Map_> struct MtkRebound {                                                                \
      static constexpr int MtkFirst = __COUNTER__;                                                           \
      MTK_SEQUENCE(MTK_REBOUND, members)                                                                     \
      template <class T_> static auto mtkMembers(T_& x) {                                                    \
        return ::std::tie(MTK_SEQUENCE(MTK_TIED, members));                                                  \
      }                                                                                                      \
      static auto mtkMemberNames() { return Name::mtkMemberNames(); }                                        \
    };                                                                                                       \
                                                                                                             \
    template <class Self_ = Name> int dof() const { return ::mtk::detail::NamedTraits<Self_>::dof(*this); }  \
    template <class Self_ = Name>                                                                            \
    void boxplus(::mtk::vectview<const typename Self_::scalar, Self_::DOF> d, typename Self_::scalar scale = 1) {\
      ::mtk::detail::NamedTraits<Self_>::boxplus(*this, d, scale);                                           \
    }                                                                                                        \
    template <class Self_ = Name>                                                                            \
    void boxminus(::mtk::vectview<typename Self_::scalar, Self_::DOF> out, const Name& y) const {            \
      ::mtk::detail::NamedTraits<Self_>::boxminus(out, *this, y);                                            \
    }                                                                                                        \
    template <class Self_> requires ::std::is_base_of_v<Name, Self_>                                         \
    [[maybe_unused]] friend ::std::ostream& operator<<(::std::ostream& os, const Self_& x) {                 \
      return ::mtk::write(os, x);                                                                            \
    }                                                                                                        \
    template <class Self_> requires ::std::is_base_of_v<Name, Self_>                                         \
    [[maybe_unused]] friend ::std::istream& operator>>(::std::istream& is, Self_& x) {                       \
      return ::mtk::read(is, x);                                                                             \
    }                                                                                                        \
  };
// clang-format on
