/// A view of N contiguous scalars as an Eigen column vector. [+] reads from such views, [-] writes to them.
#pragma once

#include <cstddef>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/detail/cpp20.hpp"

namespace mtk {

inline constexpr int Dynamic = Eigen::Dynamic;

namespace detail {
/// Returns Eigen's option for a matrix whose layout does not depend on compiler flags. A matrix whose size is known
/// only at run time is allocated. Eigen's allocator does that if the scalars (packs, dual numbers) need more alignment
/// than malloc gives.
template <class S, int Rows, int Cols>
constexpr int plainStorage() {
  if constexpr (Rows == Dynamic || Cols == Dynamic) {
    return alignof(S) > alignof(std::max_align_t) ? Eigen::AutoAlign : Eigen::DontAlign;
  } else {
    return Eigen::DontAlign;
  }
}
}  // namespace detail

/// A column vector of N scalars without alignment requirements of its own: its layout does not depend on compiler
/// flags.
template <class S, int N>
using PlainVector = Eigen::Matrix<S, N, 1, Eigen::ColMajor | detail::plainStorage<S, N, 1>()>;

namespace detail {
template <class S, int N>
using MappedVector = std::conditional_t<std::is_const_v<S>, const PlainVector<std::remove_const_t<S>, N>,
                                        PlainVector<std::remove_const_t<S>, N>>;

template <class D>
concept ContiguousVector = bool(D::IsVectorAtCompileTime) && (D::InnerStrideAtCompileTime == 1) &&
                           bool(D::Flags & Eigen::DirectAccessBit);
}  // namespace detail

/// A view that owns nothing: `vectview<const double, 3>` reads, `vectview<double, 3>` writes. It is made from a
/// pointer, or implicitly from any Eigen vector with contiguous entries. N may be Dynamic.
template <class S, int N>
class vectview : public Eigen::Map<detail::MappedVector<S, N>> {
  using Value = std::remove_const_t<S>;

 public:
  using Base = Eigen::Map<detail::MappedVector<S, N>>;

  /// Creates a view of N numbers, N fixed. The owner must keep them alive.
  explicit vectview(S* data)
    requires(N != Dynamic)
      : Base(data) {}
  vectview(S* data, Eigen::Index size) : Base(data, size) {}

  template <class D>
    requires(detail::ContiguousVector<D> && std::is_same_v<typename D::Scalar, Value> && std::is_const_v<S>)
  vectview(const Eigen::DenseBase<D>& v)
      : Base(v.derived().data(), v.size()) {}  // NOLINT(google-explicit-constructor)

  template <class D>
    requires(detail::ContiguousVector<D> && std::is_same_v<typename D::Scalar, Value> && !std::is_const_v<S>)
  vectview(Eigen::DenseBase<D>& v)
      : Base(v.derived().data(), v.size()) {}  // NOLINT(google-explicit-constructor)

  template <class D>
    requires(detail::ContiguousVector<D> && std::is_same_v<typename D::Scalar, Value> && !std::is_const_v<S>)
  vectview(Eigen::DenseBase<D>&& v)
      : Base(v.derived().data(), v.size()) {}  // NOLINT(google-explicit-constructor)

  vectview(const vectview&) = default;
  using Base::operator=;
  vectview& operator=(const vectview& other) {
    Base::operator=(other);
    return *this;
  }
};

}  // namespace mtk
