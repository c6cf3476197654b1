/// Measurements declared as in the paper: named variables and data, and a body that writes `ret`.
///
///     SLOM_BUILD_MEASUREMENT(Observation, 2, ((Pose, pose)) ((vec2, landmark)), ((vec2, coords)))
///     SLOM_IMPLEMENT_MEASUREMENT(Observation, ret) { ret = pose->inverse() * *landmark - coords; }
///
/// The second parameter is the length of the residual. If the length is known only at run time, it is mtk::Dynamic, and
/// the body resizes `ret`. The data list may be empty: `SLOM_BUILD_MEASUREMENT(Prior, 1, ((Scalar, x)), )`. Write the
/// body once, in a source file. In a header, put `inline` before SLOM_IMPLEMENT_MEASUREMENT. `ret` starts as NaN, so a
/// forgotten entry is found.
#pragma once

#include <array>
#include <concepts>
#include <limits>
#include <tuple>
#include <type_traits>

#include <Eigen/Core>

#include "mtk/detail/sequence.hpp"
#include "slom/model/var_id.hpp"

namespace slom {

inline constexpr int Dynamic = mtk::Dynamic;

/// The type of `ret`: a column vector of fixed or run-time size (then Eigen::VectorXd).
template <int Rows>
using Residual =
    Eigen::Matrix<double, Rows, 1,
                  Rows == Dynamic ? int(Eigen::ColMajor) : int(Eigen::ColMajor | Eigen::DontAlign)>;

namespace detail {
/// The variables of a measurement, of types T.
template <class... T>
struct VariableList {
  std::array<VariableArgument*, sizeof...(T)> all;
};
template <class... T>
VariableList<T...> listVariables(VarArg<T>&... variables) {
  return {{&variables...}};
}
template <class T>
inline constexpr bool is_variable_list = false;
template <class... T>
inline constexpr bool is_variable_list<VariableList<T...>> = true;
}  // namespace detail

/// A type whose objects are measurements: they list their variables and write their residual.
template <class M>
concept Measurement = requires(M& m, const M& c, Residual<M::residual_dim>& ret) {
  { m.variableArgs() };
  { c.evaluate(ret) };
} && detail::is_variable_list<decltype(std::declval<M&>().variableArgs())>;

namespace detail {
/// Returns references to all arguments except the first. So a list may be empty.
template <class... T>
std::tuple<const T&...> tieBehind(int, const T&... x) {
  return {x...};
}

/// Writes the residual, `rows` entries, to r. Entries that the measurement does not write are NaN. Returns the
/// residual's length; if that is not `rows`, writes nothing.
template <Measurement M>
int evaluatePoisoned(const M& measurement, int rows, double* r) {
  Residual<M::residual_dim> ret;
  if constexpr (M::residual_dim == Dynamic) ret.resize(rows);
  for (int i = 0; i < rows; ++i) ret.data()[i] = std::numeric_limits<double>::quiet_NaN();
  measurement.evaluate(ret);
  if constexpr (M::residual_dim == Dynamic) {
    if (ret.size() != rows) return static_cast<int>(ret.size());
  }
  for (int i = 0; i < rows; ++i) r[i] = ret.data()[i];
  return rows;
}
}  // namespace detail

}  // namespace slom

namespace SLOM = slom;

// clang-format off
#define SLOM_VARIABLE_(type, name) ::slom::VarArg<type> name;
#define SLOM_VARIABLE_A(pair) SLOM_VARIABLE_ pair SLOM_VARIABLE_B
#define SLOM_VARIABLE_B(pair) SLOM_VARIABLE_ pair SLOM_VARIABLE_A
#define SLOM_VARIABLE_A_END
#define SLOM_VARIABLE_B_END

#define SLOM_DATUM_(type, name) type name;
#define SLOM_DATUM_A(pair) SLOM_DATUM_ pair SLOM_DATUM_B
#define SLOM_DATUM_B(pair) SLOM_DATUM_ pair SLOM_DATUM_A
#define SLOM_DATUM_A_END
#define SLOM_DATUM_B_END

#define SLOM_ID_PARAMETER_(type, name) const ::slom::VarID<type>& name##_id
#define SLOM_ID_PARAMETER_A(pair) SLOM_ID_PARAMETER_ pair SLOM_ID_PARAMETER_MORE_A
#define SLOM_ID_PARAMETER_MORE_A(pair) , SLOM_ID_PARAMETER_ pair SLOM_ID_PARAMETER_MORE_B
#define SLOM_ID_PARAMETER_MORE_B(pair) , SLOM_ID_PARAMETER_ pair SLOM_ID_PARAMETER_MORE_A
#define SLOM_ID_PARAMETER_MORE_A_END
#define SLOM_ID_PARAMETER_MORE_B_END

#define SLOM_ID_INIT_(type, name) name(name##_id)
#define SLOM_ID_INIT_A(pair) SLOM_ID_INIT_ pair SLOM_ID_INIT_MORE_A
#define SLOM_ID_INIT_MORE_A(pair) , SLOM_ID_INIT_ pair SLOM_ID_INIT_MORE_B
#define SLOM_ID_INIT_MORE_B(pair) , SLOM_ID_INIT_ pair SLOM_ID_INIT_MORE_A
#define SLOM_ID_INIT_MORE_A_END
#define SLOM_ID_INIT_MORE_B_END

#define SLOM_DATUM_PARAMETER_(type, name) , const type& name##_init
#define SLOM_DATUM_PARAMETER_A(pair) SLOM_DATUM_PARAMETER_ pair SLOM_DATUM_PARAMETER_B
#define SLOM_DATUM_PARAMETER_B(pair) SLOM_DATUM_PARAMETER_ pair SLOM_DATUM_PARAMETER_A
#define SLOM_DATUM_PARAMETER_A_END
#define SLOM_DATUM_PARAMETER_B_END

#define SLOM_DATUM_INIT_(type, name) , name(name##_init)
#define SLOM_DATUM_INIT_A(pair) SLOM_DATUM_INIT_ pair SLOM_DATUM_INIT_B
#define SLOM_DATUM_INIT_B(pair) SLOM_DATUM_INIT_ pair SLOM_DATUM_INIT_A
#define SLOM_DATUM_INIT_A_END
#define SLOM_DATUM_INIT_B_END

#define SLOM_DATUM_TIED_(type, name) , name
#define SLOM_DATUM_TIED_A(pair) SLOM_DATUM_TIED_ pair SLOM_DATUM_TIED_B
#define SLOM_DATUM_TIED_B(pair) SLOM_DATUM_TIED_ pair SLOM_DATUM_TIED_A
#define SLOM_DATUM_TIED_A_END
#define SLOM_DATUM_TIED_B_END

#define SLOM_TIED_(type, name) name
#define SLOM_TIED_A(pair) SLOM_TIED_ pair SLOM_TIED_MORE_A
#define SLOM_TIED_MORE_A(pair) , SLOM_TIED_ pair SLOM_TIED_MORE_B
#define SLOM_TIED_MORE_B(pair) , SLOM_TIED_ pair SLOM_TIED_MORE_A
#define SLOM_TIED_MORE_A_END
#define SLOM_TIED_MORE_B_END

#define SLOM_BUILD_MEASUREMENT(Name, dimension, variables, data)                                     \
  struct Name {                                                                                      \
    static constexpr int residual_dim = dimension;                                                   \
    using ResidualVector = ::slom::Residual<residual_dim>;                                           \
                                                                                                     \
    MTK_SEQUENCE(SLOM_VARIABLE, variables)                                                           \
    MTK_SEQUENCE(SLOM_DATUM, data)                                                                   \
                                                                                                     \
    explicit Name(MTK_SEQUENCE(SLOM_ID_PARAMETER, variables)                                         \
                  MTK_SEQUENCE(SLOM_DATUM_PARAMETER, data))                                          \
        : MTK_SEQUENCE(SLOM_ID_INIT, variables) MTK_SEQUENCE(SLOM_DATUM_INIT, data) {}               \
                                                                                                     \
    auto variableArgs() { return ::slom::detail::listVariables(MTK_SEQUENCE(SLOM_TIED, variables)); } \
    auto dataArgs() const { return ::slom::detail::tieBehind(0 MTK_SEQUENCE(SLOM_DATUM_TIED, data)); } \
    void evaluate(ResidualVector& slom_ret) const;                                                   \
  };

#define SLOM_IMPLEMENT_MEASUREMENT(Name, ret) void Name::evaluate(Name::ResidualVector& ret) const
// clang-format on
