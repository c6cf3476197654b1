#include "variables.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>

#include <slom/slom.hpp>

#include "recorded.hpp"

namespace slom::python {
namespace {

constexpr std::size_t longest_vector = 12;

[[noreturn]] void raiseValue(const std::string& what) {
  throw mtk::Error("slom.bad-value",
                   what + "; pass a finite number, or an array of 1 to " + std::to_string(longest_vector) +
                       " finite numbers",
                   "variable");
}

Eigen::VectorXd vectorOf(nb::handle value) {
  const nb::object numpy = nb::module_::import_("numpy");
  const nb::object array = numpy.attr("asarray")(value, "float64").attr("ravel")();
  Eigen::VectorXd x = nb::cast<Eigen::VectorXd>(array);
  if (!x.allFinite()) raiseValue("the start value of a variable has a number that is not finite");
  return x;
}

template <class T>
class KindOf : public VariableKind {
 public:
  AnyVarID insert(Estimator& est, nb::handle value, const std::string& name, bool optimize) const override {
    return est.insertRV(from(value), optimize, name);
  }
  nb::object value(const AnyVarID& id) const override { return to(id.as<T>()); }
  void set(Estimator& est, const AnyVarID& id, nb::handle value) const override {
    est.reinitRV(id.id<T>(), from(value));
  }
  void fix(Estimator& est, const AnyVarID& id, bool fixed) const override {
    est.optimizeRV(id.id<T>(), !fixed);
  }
  std::string name(const Estimator& est, const AnyVarID& id) const override { return est.nameOf(id.id<T>()); }
  Eigen::MatrixXd covariance(const Estimator& est, const AnyVarID& id) const override {
    return est.covariance(id.id<T>());
  }
  Eigen::VectorXd deviation(const Estimator& est, const AnyVarID& id) const override {
    return est.standardDeviation(id.id<T>());
  }
  nb::object recorded(tape::Recording& recording, const AnyVarID& id) const override {
    const auto x = tape::detail::variableOf(recording, id.as<T>());
    if constexpr (std::is_same_v<T, double>) {
      return nb::cast(tape::Number(x));
    } else {
      return arrayOf({x.data(), x.data() + x.size()}, {std::size_t(x.size())});
    }
  }
  std::type_index type() const override { return typeid(T); }
  tape::Layout layout(const AnyVarID& id) const override { return tape::detail::layoutOf(id.as<T>()); }

 private:
  static T from(nb::handle value) {
    const Eigen::VectorXd x = vectorOf(value);
    if constexpr (std::is_same_v<T, double>) {
      return x[0];
    } else {
      if (x.size() != T::SizeAtCompileTime) {
        raiseValue("a variable of " + std::to_string(T::SizeAtCompileTime) + " numbers got a value of " +
                   std::to_string(x.size()));
      }
      return T(x);
    }
  }
  static nb::object to(const T& x) {
    if constexpr (std::is_same_v<T, double>) {
      return nb::float_(x);
    } else {
      return nb::cast(Eigen::VectorXd(x));
    }
  }
};

template <std::size_t... N>
const VariableKind& vectorKind(std::size_t n, std::index_sequence<N...>) {
  static const std::array<std::unique_ptr<VariableKind>, sizeof...(N)> kinds{
      std::make_unique<KindOf<mtk::vect<int(N) + 1>>>()...};
  return *kinds[n - 1];
}

}  // namespace

const VariableKind& kindOf(nb::handle value) {
  static const KindOf<double> scalar;
  const nb::object numpy = nb::module_::import_("numpy");
  if (nb::cast<int>(numpy.attr("ndim")(value)) == 0) return scalar;
  const auto size = nb::cast<std::size_t>(numpy.attr("size")(value));
  if (size < 1 || size > longest_vector)
    raiseValue("the start value of a variable has " + std::to_string(size) + " numbers");
  return vectorKind(size, std::make_index_sequence<longest_vector>());
}

}  // namespace slom::python
