/// R^N: a column vector that knows how to be a variable.
///   state    N scalars; mtk::Dynamic for a size known only at run time
///   tangent  the same N numbers; x [+] d = x + d, y [-] x = y - x
///   names    x, y, z for N = 2 and 3, otherwise 0, 1, ...
/// Derive from it to give the numbers a meaning: `struct Camera : mtk::vect<9> { ... };`. A derived type can
/// name its components: `static constexpr std::array<std::string_view, 9> component_names{"fx", ...};`
#pragma once

#include <initializer_list>

#include "mtk/manifold.hpp"

namespace mtk {

template <int N, class S = double>
class vect : public PlainVector<S, N> {
 public:
  using Base = PlainVector<S, N>;
  using scalar = S;
  static constexpr int DOF = N;

  /// All zero; of size 0 when N is Dynamic.
  vect() {
    if constexpr (N != Dynamic) this->setZero();
  }
  template <class D>
  vect(const Eigen::MatrixBase<D>& v) : Base(v) {}  // NOLINT(google-explicit-constructor): as Eigen's vectors
  /// The N coordinates.
  template <class... T>
    requires(N != Dynamic && sizeof...(T) == std::size_t(N) && (std::is_convertible_v<T, S> && ...))
  explicit(N == 1) vect(const T&... coordinates) : Base() {
    int i = 0;
    ((this->coeffRef(i++) = S(coordinates)), ...);
  }
  /// `n` zeros.
  explicit vect(Eigen::Index n)
    requires(N == Dynamic)
      : Base(Base::Zero(n)) {}
  /// The given coordinates, as in `vect<Dynamic>{1, 2, 3}`.
  vect(std::initializer_list<S> coordinates)
    requires(N == Dynamic)
      : Base(Eigen::Index(coordinates.size())) {
    Eigen::Index i = 0;
    for (const S& value : coordinates) this->coeffRef(i++) = value;
  }

  using Base::operator=;

  int dof() const { return static_cast<int>(this->size()); }
  void boxplus(vectview<const S, N> d, S scale = S(1)) {
    detail::requireSameSize(this->size(), d.size(), "x [+] d");
    Base::operator+=(scale * d);
  }
  void boxminus(vectview<S, N> out, const vect& y) const {
    detail::requireSameSize(this->size(), y.size(), "x [-] y");
    out = *this - y;
  }
  void magnitudes(vectview<S, N> out) const { out = this->cwiseAbs(); }
};

// Arithmetic that gives values. Eigen's operators give expressions that refer to their operands, so that a function
// `auto f(...) { return T * p - z; }` would return a reference to the temporary T * p.

template <int N, class S>
vect<N, S> operator+(const vect<N, S>& a, const vect<N, S>& b) {
  vect<N, S> result = a;
  result += b;
  return result;
}
template <int N, class S>
vect<N, S> operator-(const vect<N, S>& a, const vect<N, S>& b) {
  vect<N, S> result = a;
  result -= b;
  return result;
}
template <int N, class S, class D>
  requires(std::is_same_v<typename D::Scalar, S>)
vect<N, S> operator+(const vect<N, S>& a, const Eigen::MatrixBase<D>& b) {
  vect<N, S> result = a;
  result += b;
  return result;
}
template <int N, class S, class D>
  requires(std::is_same_v<typename D::Scalar, S>)
vect<N, S> operator-(const vect<N, S>& a, const Eigen::MatrixBase<D>& b) {
  vect<N, S> result = a;
  result -= b;
  return result;
}
template <int N, class S, class D>
  requires(std::is_same_v<typename D::Scalar, S>)
vect<N, S> operator+(const Eigen::MatrixBase<D>& a, const vect<N, S>& b) {
  vect<N, S> result = a;
  result += b;
  return result;
}
template <int N, class S, class D>
  requires(std::is_same_v<typename D::Scalar, S>)
vect<N, S> operator-(const Eigen::MatrixBase<D>& a, const vect<N, S>& b) {
  vect<N, S> result = a;
  result -= b;
  return result;
}
template <int N, class S>
vect<N, S> operator-(const vect<N, S>& a) {
  vect<N, S> result = a;
  result *= S(-1);
  return result;
}
template <int N, class S>
vect<N, S> operator*(const vect<N, S>& a, const std::type_identity_t<S>& factor) {
  vect<N, S> result = a;
  result *= factor;
  return result;
}
template <int N, class S>
vect<N, S> operator*(const std::type_identity_t<S>& factor, const vect<N, S>& a) {
  return a * factor;
}
template <int N, class S>
vect<N, S> operator/(const vect<N, S>& a, const std::type_identity_t<S>& divisor) {
  vect<N, S> result = a;
  result /= divisor;
  return result;
}

namespace detail {
inline constexpr std::array<std::string_view, 2> xy_names{"x", "y"};
inline constexpr std::array<std::string_view, 3> xyz_names{"x", "y", "z"};
}  // namespace detail

}  // namespace mtk
