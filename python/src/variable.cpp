#include "variable.hpp"

#include <limits>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/slom.hpp>

#include "alone.hpp"
#include "documentation.hpp"
#include "manifolds.hpp"

namespace slom::python {

namespace {

/// Returns a number for a variable that is one, and the vector for others.
nb::object perComponent(const ValueType& type, const Eigen::VectorXd& x) {
  if (type.isArray()) return toPython(x.data(), type.shape());
  return nb::cast(x);
}

Rows valuesOf(const VariableArray& all) {
  Rows rows{all.type, {}};
  for (const AnyVarID& id : all.ids) {
    const auto* const numbers = static_cast<const double*>(id.current());
    rows.numbers.insert(rows.numbers.end(), numbers, numbers + all.type->coordinates());
  }
  return rows;
}

void setValues(const VariableArray& all, nb::handle values) {
  const Rows rows = rowsOf(values, "the values");
  if (!(*rows.type == *all.type) || rows.size() != all.ids.size()) {
    throw mtk::Error("slom.bad-value",
                     "the values are " + std::to_string(rows.size()) + " of type " +
                         rows.type->runtime()->name() + ", the variables are " +
                         std::to_string(all.ids.size()) + " of type " + all.type->runtime()->name() +
                         "; pass one value of that type for each variable",
                     "values");
  }
  for (std::size_t i = 0; i < rows.size(); ++i)
    all.est->reinitRV(all.ids[i],
                      {all.type->runtime(), {rows.row(i), rows.row(i) + rows.type->coordinates()}});
}

Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> deviationsOf(
    const VariableArray& all) {
  const Marginals marginals = all.est->marginals();
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result(
      static_cast<Eigen::Index>(all.ids.size()), all.type->runtime()->dof());
  for (std::size_t i = 0; i < all.ids.size(); ++i)
    result.row(static_cast<Eigen::Index>(i)) = marginals.standardDeviation(all.ids[i]).transpose();
  return result;
}

nb::object covariancesOf(const VariableArray& all) {
  const Marginals marginals = all.est->marginals();
  const auto dof = static_cast<std::size_t>(all.type->runtime()->dof());
  std::vector<double> numbers;
  for (const AnyVarID& id : all.ids) {
    const Eigen::MatrixXd own = marginals.covariance(id);
    numbers.insert(numbers.end(), own.data(), own.data() + own.size());  // symmetric
  }
  return toPython(numbers.data(), {all.ids.size(), dof, dof});
}

/// Returns a value of a variable, which is a copy, so that `x.value[0] = 1` raises and does not seem to work.
nb::object unwritable(nb::object value) {
  if (nb::hasattr(value, "flags")) value.attr("flags").attr("writeable") = false;
  if (nb::hasattr(value.type(), "__slom_fields__")) {
    for (const nb::handle name : nb::object(value.type().attr("__slom_fields__")))
      unwritable(nb::getattr(value, name));
  }
  return value;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

std::vector<AnyVarID> handlesOf(nb::handle variables) {
  if (nb::isinstance<Variable>(variables)) return {nb::cast<Variable>(variables).id};
  if (nb::isinstance<VariableArray>(variables)) return nb::cast<VariableArray>(variables).ids;
  std::vector<AnyVarID> ids;
  if (nb::isinstance<nb::list>(variables) || nb::isinstance<nb::tuple>(variables)) {
    for (const nb::handle one : variables) {
      const std::vector<AnyVarID> own = handlesOf(one);
      ids.insert(ids.end(), own.begin(), own.end());
    }
    return ids;
  }
  throw mtk::Error("slom.bad-argument",
                   "a value of type " + nb::cast<std::string>(variables.type().attr("__name__")) +
                       " stands in place of a variable; pass what est.variable or est.variables returned",
                   "variables");
}

void bindVariables(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Variable>(module, "Variable", "A variable of an estimator.")
      .def_prop_rw(
          "value", [](const Variable& x) { return unwritable(x.type->value(x.numbers())); },
          alone(+[](const Variable& x, nb::handle value) {
            std::vector<double> numbers;
            x.type->append(value, numbers, "the value of " + x.est->nameOf(x.id));
            x.est->reinitRV(x.id, {x.type->runtime(), std::move(numbers)});
          }),
          "A copy of the current value. Assign a new value to change it.")
      .def_prop_ro("name", [](const Variable& x) { return x.est->nameOf(x.id); })
      .def_prop_ro("std", alone(+[](const Variable& x) {
                     return perComponent(*x.type, x.est->standardDeviation(x.id));
                   }),
                   "Standard deviations of the components, in the tangent space.")
      .def_prop_ro("covariance",
                   alone(+[](const Variable& x) { return Eigen::MatrixXd(x.est->covariance(x.id)); }),
                   "Covariance of the components, in the tangent space; dof x dof.")
      .def_prop_ro(
          "components", [](const Variable& x) { return x.est->componentNames(x.id); },
          "Names of the components, in the order of `std` and `covariance`.")
      .def("fix", alone(+[](const Variable& x, const std::string& path) {
             path.empty() ? x.est->fix(x.id) : x.est->fix(x.id, path);
           }),
           "path"_a = "", doc::kFix)
      .def("free", alone(+[](const Variable& x, const std::string& path) {
             path.empty() ? x.est->free(x.id) : x.est->free(x.id, path);
           }),
           "path"_a = "", "Releases the variable, or the components at a path.")
      .def("bound", alone(+[](const Variable& x, double lower, double upper, const std::string& path) {
             x.est->bound(x.id, path, lower, upper);
           }),
           "lower"_a = -kInfinity, "upper"_a = kInfinity, "path"_a = "", doc::kBound)
      .def("remove", alone(+[](const Variable& x) { x.est->removeRV(x.id); }),
           "Removes the variable. No measurement may depend on it.")
      .def("__eq__",
           [](const Variable& x, nb::handle y) -> nb::object {
             if (!nb::isinstance<Variable>(y)) return nb::borrow(nb::handle(Py_NotImplemented));
             const auto other = nb::cast<Variable>(y);
             return nb::cast(x.est == other.est && x.id == other.id);
           })
      .def("__hash__", [](const Variable& x) { return std::hash<const void*>()(x.id.current()); })
      .def("__repr__", [](const Variable& x) {
        return x.est->nameOf(x.id) + " = " + nb::cast<std::string>(nb::repr(x.type->value(x.numbers())));
      });

  nb::class_<VariableArray>(module, "VariableArray",
                            "Variables of one type. Index arrays, slices and masks select some of them.")
      .def("__len__", [](const VariableArray& all) { return all.ids.size(); })
      .def("__getitem__",
           [](const VariableArray& all, nb::handle index) -> nb::object {
             if (const auto i = singleIndexOf(index, all.ids.size()))
               return nb::cast(Variable{all.est, all.ids[*i], all.type});
             VariableArray some{all.est, {}, all.type};
             for (const std::size_t i : indicesOf(index, all.ids.size())) some.ids.push_back(all.ids[i]);
             return nb::cast(std::move(some));
           })
      .def_prop_rw(
          "value", [](const VariableArray& all) { return unwritable(toPython(valuesOf(all))); },
          alone(&setValues),
          "A copy of the current values: an array with one row for each variable, or Rows. Assign new values to change "
          "them.")
      .def_prop_ro("std", alone(&deviationsOf),
                   "Standard deviations of the components in the tangent space, one row for each variable.")
      .def_prop_ro(
          "covariance", alone(&covariancesOf),
          "Covariance of the components of each variable, in the tangent space: (variables, dof, dof).")
      .def_prop_ro(
          "name",
          [](const VariableArray& all) {
            std::vector<std::string> names;
            for (const AnyVarID& id : all.ids) names.push_back(all.est->nameOf(id));
            return names;
          },
          "The names of the variables.")
      .def("fix", alone(+[](const VariableArray& all, const std::string& path) {
             for (const AnyVarID& id : all.ids) path.empty() ? all.est->fix(id) : all.est->fix(id, path);
           }),
           "path"_a = "", "Keeps all of them, or their components at a path, at their current values.")
      .def("free", alone(+[](const VariableArray& all, const std::string& path) {
             for (const AnyVarID& id : all.ids) path.empty() ? all.est->free(id) : all.est->free(id, path);
           }),
           "path"_a = "", "Releases all of them, or their components at a path.")
      .def("bound", alone(+[](const VariableArray& all, double lower, double upper, const std::string& path) {
             for (const AnyVarID& id : all.ids) all.est->bound(id, path, lower, upper);
           }),
           "lower"_a = -kInfinity, "upper"_a = kInfinity, "path"_a = "",
           "Keeps the components at a path, or all of them, of each variable between two limits.")
      .def("remove", alone(+[](const VariableArray& all) {
             for (const AnyVarID& id : all.ids) all.est->removeRV(id);
           }),
           "Removes all of them. No measurement may depend on them.")
      .def("__repr__", [](const VariableArray& all) {
        return "<" + std::to_string(all.ids.size()) + " variables of " + all.type->runtime()->name() + ">";
      });
}

}  // namespace slom::python
