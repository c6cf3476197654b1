/// Unknowns: vectors and rotations whose derivatives are the identity. Their types say so, so products with the
/// identity cost nothing. Other code sees them as vectors and rotations of dual numbers.
///   source   Sola, Deray, Atchuthan, "A micro Lie theory for state estimation in robotics", 2018, appendix B
#pragma once

#include <cstddef>
#include <type_traits>

#include "mtk/types/so3_dual.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

namespace detail {

/// The entries of a vector of unknowns: entry i is values[i], the unknown of column Offset + i.
template <int N, class S, int Offset>
struct SeedEntries {
  using Entry = SparseDual<S, lowColumns(N) << Offset>;
  vect<N, S> values;

  Entry operator()(Eigen::Index i) const {
    Entry entry;
    entry.seed(values[i], Offset + static_cast<int>(i));
    return entry;
  }
};

/// A constant vector of N unknowns. A structured binding gives entries that each depend on one unknown only.
template <int N, class S, int Offset>
class SeedVector : public Eigen::CwiseNullaryOp<SeedEntries<N, S, Offset>,
                                                PlainVector<typename SeedEntries<N, S, Offset>::Entry, N>> {
  using Entries = SeedEntries<N, S, Offset>;
  using Base = Eigen::CwiseNullaryOp<Entries, PlainVector<typename Entries::Entry, N>>;

 public:
  using scalar = typename Entries::Entry;
  static constexpr int DOF = N;
  static constexpr std::uint64_t columns = scalar::columns;

  SeedVector() : SeedVector(vect<N, S>()) {}
  explicit SeedVector(const vect<N, S>& values) : Base(N, 1, Entries{values}) {}

  const vect<N, S>& values() const { return this->functor().values; }
  scalar operator[](Eigen::Index i) const { return this->functor()(i); }
  template <std::size_t I>
  auto get() const {
    SparseDual<S, lowColumns(1) << (Offset + static_cast<int>(I))> entry;
    entry.seed(values()[static_cast<Eigen::Index>(I)], Offset + static_cast<int>(I));
    return entry;
  }
  /// Returns a view of the entries, which are written to memory when the view is requested.
  operator vectview<const scalar, N>() const {  // NOLINT(google-explicit-constructor): as other vectors
    for (int i = 0; i < N; ++i) memory_.entries[i] = (*this)[i];
    return vectview<const scalar, N>(memory_.entries.data());
  }

 private:
  /// Memory of the entries. Each copy of the vector has its own.
  struct Memory {
    vect<N, scalar> entries{Uninitialized()};
    Memory() = default;
    Memory(const Memory&) : Memory() {}
    Memory& operator=(const Memory&) { return *this; }
  };
  mutable Memory memory_;
};
/// A stand-in for the number type of a vector of unknowns. With it, class templates over their number type that derive
/// from vect<N, S> become such vectors.
template <class S, int Offset>
struct SeparateUnknowns {};

template <int N, class S, int Offset, class V>
inline constexpr bool is_seed_vector<Eigen::CwiseNullaryOp<SeedEntries<N, S, Offset>, V>> = true;

/// Returns the rows of M as derivatives with respect to three unknowns.
template <std::uint64_t C, class S>
RowPartials<S, C> rowsOf(const Matrix3<S>& M) {
  static_assert(countColumns(C) == 3);
  RowPartials<S, C> rows;
  unrolled<3>([&](int i) {
    rows[static_cast<std::size_t>(i)] = Partials<S, C>::generate([&](int k) { return M(i, k); });
  });
  return rows;
}
/// Returns [v]x.
template <class S>
Matrix3<S> crossMatrix(const vect<3, S>& v) {
  const S zero(0.0);
  Matrix3<S> M;
  M << zero, -v[2], v[1],  //
      v[2], zero, -v[0],   //
      -v[1], v[0], zero;
  return M;
}
/// Returns -M [p]x.
template <class S>
Matrix3<S> minusTimesCross(const Matrix3<S>& M, const vect<3, S>& p) {
  Matrix3<S> result;
  unrolled<3>([&](int i) {
    result(i, 0) = M(i, 2) * p[1] - M(i, 1) * p[2];
    result(i, 1) = M(i, 0) * p[2] - M(i, 2) * p[0];
    result(i, 2) = M(i, 1) * p[0] - M(i, 0) * p[1];
  });
  return result;
}

template <class S, std::uint64_t C>
class InverseSeedRotation;

/// An unknown rotation: R exp(e) for the unknowns e of the three columns C.
template <class S, std::uint64_t C>
class SeedRotation : public SO3<SparseDual<S, C>> {
 public:
  using Base = SO3<SparseDual<S, C>>;
  SeedRotation() : SeedRotation(SO3<S>()) {}
  explicit SeedRotation(const SO3<S>& R) : Base(R, rowsOf<C>(Matrix3<S>(Matrix3<S>::Identity()))) {}
  InverseSeedRotation<S, C> inverse() const { return InverseSeedRotation<S, C>(this->value().inverse()); }
  /// Returns d (R p) / d e, for M = R and v = R p.
  static Matrix3<S> derivative(const Matrix3<S>& M, const vect<3, S>& p, const vect<3, S>&) {
    return minusTimesCross<S>(M, p);
  }
  /// Returns D in R exp(e) B = R B exp(D e). product: R B.
  static Matrix3<S> passedOn(const Matrix3<S>& B, const SO3<S>&) { return B.transpose(); }

  void boxplus(vectview<const SparseDual<S, C>, 3> d,
               const SparseDual<S, C>& scale = SparseDual<S, C>(1)) = delete;
};
/// The inverse of a SeedRotation: exp(-e) R.
template <class S, std::uint64_t C>
class InverseSeedRotation : public SO3<SparseDual<S, C>> {
 public:
  using Base = SO3<SparseDual<S, C>>;
  explicit InverseSeedRotation(const SO3<S>& R)
      : Base(R, rowsOf<C>(Matrix3<S>(-R.inverse().toRotationMatrix()))) {}
  SeedRotation<S, C> inverse() const { return SeedRotation<S, C>(this->value().inverse()); }
  static Matrix3<S> derivative(const Matrix3<S>&, const vect<3, S>&, const vect<3, S>& v) {
    return crossMatrix<S>(v);
  }
  static Matrix3<S> passedOn(const Matrix3<S>&, const SO3<S>& product) {
    return -product.inverse().toRotationMatrix();
  }

  void boxplus(vectview<const SparseDual<S, C>, 3> d,
               const SparseDual<S, C>& scale = SparseDual<S, C>(1)) = delete;
};
template <class R>
inline constexpr bool is_seed_rotation = false;
template <class S, std::uint64_t C>
inline constexpr bool is_seed_rotation<SeedRotation<S, C>> = true;
template <class S, std::uint64_t C>
inline constexpr bool is_seed_rotation<InverseSeedRotation<S, C>> = true;

/// Returns the value of a vector of numbers or dual numbers.
template <class S, class E>
vect<3, S> pointValue(const Eigen::MatrixBase<E>& p) {
  if constexpr (is_seed_vector<E>) {
    return p.derived().functor().values;
  } else if constexpr (is_dual<typename E::Scalar>) {
    return valueOf<S, E::Scalar::columns>(p);
  } else {
    return vect<3, S>(p);
  }
}
/// Returns M dp.
template <class S, class E>
auto turnedPartials(const Matrix3<S>& M, const Eigen::MatrixBase<E>& p) {
  constexpr std::uint64_t columns = E::Scalar::columns;
  if constexpr (is_seed_vector<E>) {
    return rowsOf<columns>(M);
  } else {
    return multiply<S>(M, partialsOf<S, columns>(p));
  }
}
template <class S, std::uint64_t C>
vect<3, SparseDual<S, C>> dualVector(const vect<3, S>& value, const RowPartials<S, C>& d) {
  vect<3, SparseDual<S, C>> result{Uninitialized()};
  unrolled<3>([&](int i) { result[i] = SparseDual<S, C>(value[i], d[static_cast<std::size_t>(i)]); });
  return result;
}

}  // namespace detail

template <int N, class S, int Offset>
class vect<N, detail::SeparateUnknowns<S, Offset>> : public detail::SeedVector<N, S, Offset> {
 public:
  using detail::SeedVector<N, S, Offset>::SeedVector;
};

/// Rotates a point or a direction.
template <class R, class E>
  requires(detail::is_seed_rotation<R> && bool(E::IsVectorAtCompileTime))
auto operator*(const R& rotation, const Eigen::MatrixBase<E>& point) {
  static_assert(E::SizeAtCompileTime == 3, "mtk: SO3 rotates 3-vectors");
  using A = typename R::scalar;
  using B = typename E::Scalar;
  using S = detail::ValueType<A>;
  const detail::Matrix3<S> M = rotation.value().toRotationMatrix();
  const vect<3, S> p = detail::pointValue<S>(point), v(M * p);
  const auto by_rotation = detail::rowsOf<A::columns>(R::derivative(M, p, v));
  if constexpr (detail::is_dual<B>) {
    return detail::dualVector<S, A::columns | B::columns>(
        v, detail::add<A::columns, B::columns, S>(by_rotation, detail::turnedPartials<S>(M, point)));
  } else {
    return detail::dualVector<S, A::columns>(v, by_rotation);
  }
}
template <class A, class E>
  requires(detail::is_seed_vector<E> && E::SizeAtCompileTime == 3)
auto operator*(const SO3<A>& R, const Eigen::MatrixBase<E>& point) {
  using B = typename E::Scalar;
  using S = detail::ValueType<B>;
  const detail::Matrix3<S> M = detail::rotationValue<S>(R).toRotationMatrix();
  const vect<3, S> p = detail::pointValue<S>(point), v(M * p);
  if constexpr (detail::is_dual<A>) {
    return detail::dualVector<S, A::columns | B::columns>(
        v, detail::add<A::columns, B::columns, S>(detail::multiply<S>(M, detail::cross<S>(R.partials(), p)),
                                                  detail::rowsOf<B::columns>(M)));
  } else {
    return detail::dualVector<S, B::columns>(v, detail::rowsOf<B::columns>(M));
  }
}

template <class R, class B>
  requires(detail::is_seed_rotation<R>)
auto operator*(const R& a, const SO3<B>& b) {
  using A = typename R::scalar;
  using S = detail::ValueType<A>;
  using D = promote_t<A, B>;
  const SO3<S> right = detail::rotationValue<S>(b), product = a.value() * right;
  const auto passed = detail::rowsOf<A::columns>(R::passedOn(right.toRotationMatrix(), product));
  if constexpr (detail::is_dual<B>) {
    return SO3<D>(product, detail::add<A::columns, B::columns, S>(passed, b.partials()));
  } else {
    return SO3<D>(product, passed);
  }
}

}  // namespace mtk

template <int N, class S, int Offset>
struct Eigen::internal::functor_traits<mtk::detail::SeedEntries<N, S, Offset>> {
  enum { Cost = 1, PacketAccess = false, IsRepeatable = true };
};

template <int N, class S, int Offset>
struct std::tuple_size<mtk::detail::SeedVector<N, S, Offset>>
    : std::integral_constant<std::size_t, std::size_t{N}> {};
template <std::size_t I, int N, class S, int Offset>
struct std::tuple_element<I, mtk::detail::SeedVector<N, S, Offset>> {
  using type = mtk::SparseDual<S, mtk::detail::lowColumns(1) << (Offset + static_cast<int>(I))>;
};
