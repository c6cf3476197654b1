/// Eigen's output operators for values that fits often print, compiled once and not in every file that prints one.
#pragma once

#include <iosfwd>
#include <string_view>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/detail/cpp20.hpp"

#define SLOM_TEXT_(x) #x
#define SLOM_TEXT(x) SLOM_TEXT_(x)

namespace slom::detail {
/// True if EIGEN_DEFAULT_IO_FORMAT is Eigen's. If a program defines another format, its files compile the operators
/// themselves, and Printed is a type that nothing prints.
inline constexpr bool has_eigens_format =
    std::string_view(SLOM_TEXT(EIGEN_DEFAULT_IO_FORMAT)) == "Eigen::IOFormat()";
template <class X>
using Printed = std::conditional_t<has_eigens_format, X, Eigen::Array<bool, 1, 1>>;
}  // namespace slom::detail

#define SLOM_PRINT_(keyword, X)                                         \
  keyword template std::ostream& operator<< <slom::detail::Printed<X>>( \
      std::ostream&, const DenseBase<slom::detail::Printed<X>>&);
#define SLOM_PRINT_VECTOR_(keyword, X) \
  SLOM_PRINT_(keyword, X)              \
  SLOM_PRINT_(keyword, Transpose<X>)   \
  SLOM_PRINT_(keyword, Transpose<const X>)
#define SLOM_PRINT_ALL(keyword)         \
  SLOM_PRINT_VECTOR_(keyword, Vector2d) \
  SLOM_PRINT_VECTOR_(keyword, Vector3d) \
  SLOM_PRINT_VECTOR_(keyword, VectorXd) \
  SLOM_PRINT_(keyword, MatrixXd)

namespace Eigen {
SLOM_PRINT_ALL(extern)
}  // namespace Eigen
