/// A real number as a variable. It converts to and from its scalar and streams as one number.
///   tangent  x [+] d = x + d; the only component has the name of the variable itself
#pragma once

#include "mtk/dual.hpp"
#include "mtk/types/vect.hpp"

namespace mtk {

template <class S = double>
class Scalar {
 public:
  using scalar = S;
  static constexpr int DOF = 1;
  static constexpr std::array<std::string_view, 1> component_names{""};

  Scalar() = default;
  /// Converts a number, implicitly.
  Scalar(const S& value) : value_(value) {}     // NOLINT(google-explicit-constructor): it is that number
  operator const S&() const { return value_; }  // NOLINT(google-explicit-constructor)
  /// Returns the number.
  const S& value() const { return value_; }

  Scalar& operator+=(const S& d) { return value_ += d, *this; }
  Scalar& operator-=(const S& d) { return value_ -= d, *this; }
  Scalar& operator*=(const S& f) { return value_ *= f, *this; }
  Scalar& operator/=(const S& f) { return value_ /= f, *this; }

  void boxplus(vectview<const S, 1> d, S scale = S(1)) { value_ += scale * d[0]; }
  void boxminus(vectview<S, 1> out, const Scalar& y) const { out[0] = value_ - y.value_; }
  /// Writes |value|; step tolerances are relative to it.
  void typicalSizes(vectview<S, 1> out) const { out[0] = value_ < S(0) ? -value_ : value_; }

  struct MtkState {
    static constexpr bool adds = true;
    static S& of(Scalar& x) { return x.value_; }
  };

 private:
  S value_ = S(0);
};

/// A Scalar over dual numbers. It is itself such a number, so that formulas find its operators.
template <class S, std::uint64_t C>
class Scalar<SparseDual<S, C>> : public SparseDual<S, C> {
 public:
  using scalar = SparseDual<S, C>;
  static constexpr int DOF = 1;

  Scalar() = default;
  /// Converts a dual number, implicitly.
  Scalar(const scalar& x) : scalar(x) {}  // NOLINT(google-explicit-constructor): it is that number
  /// Returns the dual number.
  const scalar& value() const { return *this; }

  struct MtkState {
    static constexpr bool adds = true;
    static scalar& of(Scalar& x) { return x; }
  };

  void boxplus(vectview<const scalar, 1> d, scalar scale = scalar(1)) {
    *this = Scalar(*this + scale * d[0]);
  }
  void boxminus(vectview<scalar, 1> out, const Scalar& y) const { out[0] = value() - y.value(); }
};

// Products of vectors with a Scalar. Vector templates look for no conversions, so they need their own operators.
template <int N, class S, class T>
auto operator*(const vect<N, S>& v, const Scalar<T>& factor) {
  return v * static_cast<const T&>(factor);
}
template <int N, class S, class T>
auto operator*(const Scalar<T>& factor, const vect<N, S>& v) {
  return v * static_cast<const T&>(factor);
}
template <int N, class S, class T>
auto operator/(const vect<N, S>& v, const Scalar<T>& divisor) {
  return v / static_cast<const T&>(divisor);
}

}  // namespace mtk
