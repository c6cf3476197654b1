/// Derivatives given by a callable: `f.jacobian(arguments..., blocks...)`.
#pragma once

#include <tuple>
#include <utility>

#include <Eigen/Core>

#include "slom/model/argument.hpp"

namespace slom {

namespace detail {

/// One block of a hand-written Jacobian: rows x dof, filled with NaN before the call.
template <int Rows, int Dof>
using JacobianBlock = Eigen::Matrix<double, Rows, Dof,
                                    Eigen::DontAlign |
                                        // Eigen demands row-major storage for row vectors.
                                        (Rows == 1 && Dof != 1 ? Eigen::RowMajor : Eigen::ColMajor)>;
template <int Rows, class A>
struct BlockFor {
  using type = std::tuple<>;
};
template <int Rows, class T>
struct BlockFor<Rows, VarArg<T>> {
  using type = std::tuple<JacobianBlock<Rows, mtk::DOF_v<T>>>;
};
template <int Rows, class... Stored>
using BlockTuple = typename Join<typename BlockFor<Rows, Stored>::type...>::type;

template <class F, class Passed, class Blocks>
inline constexpr bool has_jacobian = false;
template <class F, class... P, class... B>
inline constexpr bool has_jacobian<F, std::tuple<P...>, std::tuple<B...>> =
    requires(const F& f, B&... block) { f.jacobian(std::declval<P>()..., block...); };

}  // namespace detail

}  // namespace slom
