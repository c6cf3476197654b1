/// Text format of the data of measurements. Manifolds are written and read by mtk/stream.hpp, other types so:
///   numbers, bool, enumerations   the number
///   strings                       in quotes
///   Eigen's matrices              the entries row by row; sizes known at run time only: rows and columns first
///   std::vector                   the size, then the elements
///   other types                   by their operators << and >>
/// A space follows each value.
#pragma once

#include <iomanip>
#include <istream>
#include <ostream>
#include <string>
#include <type_traits>
#include <vector>

#include "mtk/stream.hpp"

namespace slom::detail {

template <class D>
inline constexpr bool is_std_vector = false;
template <class D, class A>
inline constexpr bool is_std_vector<std::vector<D, A>> = true;
template <class D>
concept PlainMatrix = requires {
  typename D::PlainObject;
  requires std::is_same_v<typename D::PlainObject, D>;
};

/// Limit for sizes; a larger one in a file is an error.
inline constexpr long kLargestSize = 100'000'000;

template <class D>
void writeDatum(std::ostream& os, const D& x) {
  if constexpr (std::is_enum_v<D>) {
    os << static_cast<long>(x) << ' ';
  } else if constexpr (std::is_arithmetic_v<D>) {
    os << +x << ' ';
  } else if constexpr (std::is_same_v<D, std::string>) {
    os << std::quoted(x) << ' ';
  } else if constexpr (mtk::Manifold<D>) {
    static_assert(mtk::isWritable<D>(),
                  "slom: to be saved, this type of data or one of its parts needs an operator<<");
    mtk::write(os, x) << ' ';
  } else if constexpr (PlainMatrix<D>) {
    if (D::SizeAtCompileTime == Eigen::Dynamic) os << x.rows() << ' ' << x.cols() << ' ';
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
      for (Eigen::Index j = 0; j < x.cols(); ++j) writeDatum(os, x(i, j));
    }
  } else if constexpr (is_std_vector<D>) {
    os << x.size() << ' ';
    for (const auto& element : x) writeDatum(os, element);
  } else {
    static_assert(
        requires { os << x; }, "slom: to be saved, this type of data needs an operator<<");
    os << x << ' ';
  }
}

/// Reads a value. Returns false if the text is not such a value.
template <class D>
bool readDatum(std::istream& is, D& x) {
  if constexpr (std::is_enum_v<D>) {
    long number = 0;
    if (is >> number) x = static_cast<D>(number);
  } else if constexpr (std::is_same_v<D, std::string>) {
    is >> std::quoted(x);
  } else if constexpr (std::is_arithmetic_v<D>) {
    decltype(+x) number{};
    if (is >> number) x = static_cast<D>(number);
  } else if constexpr (mtk::Manifold<D>) {
    mtk::read(is, x);
  } else if constexpr (PlainMatrix<D>) {
    long rows = D::RowsAtCompileTime, cols = D::ColsAtCompileTime;
    if constexpr (D::SizeAtCompileTime == Eigen::Dynamic) {
      if (!(is >> rows >> cols) || rows < 0 || cols < 0 || (cols > 0 && rows > kLargestSize / cols))
        return false;
      if (D::RowsAtCompileTime != Eigen::Dynamic && rows != D::RowsAtCompileTime) return false;
      if (D::ColsAtCompileTime != Eigen::Dynamic && cols != D::ColsAtCompileTime) return false;
    }
    std::vector<typename D::Scalar> numbers;  // grows with the numbers present, whatever the announced sizes
    for (long i = 0; i < rows * cols; ++i) {
      numbers.emplace_back();
      if (!readDatum(is, numbers.back())) return false;
    }
    x.resize(rows, cols);
    for (long i = 0; i < rows * cols; ++i) x(i / cols, i % cols) = numbers[static_cast<std::size_t>(i)];
  } else if constexpr (is_std_vector<D>) {
    long size = 0;
    if (!(is >> size) || size < 0 || size > kLargestSize) return false;
    x.clear();
    for (long i = 0; i < size; ++i) {
      x.emplace_back();
      if (!readDatum(is, x.back())) return false;
    }
  } else {
    static_assert(
        requires { is >> x; }, "slom: to be loaded, this type of data needs an operator>>");
    is >> x;
  }
  return static_cast<bool>(is);
}

}  // namespace slom::detail
