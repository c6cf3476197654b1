#include <cmath>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "documentation.hpp"
#include "manifolds.hpp"
#include "value_type.hpp"

namespace slom::python {

namespace {

void appendArray(nb::handle array, std::vector<double>& numbers) {
  const auto flat = nb::cast<Eigen::VectorXd>(array.attr("ravel")());
  numbers.insert(numbers.end(), flat.begin(), flat.end());
}

}  // namespace

Rows rowsOf(nb::handle values, const std::string& subject) {
  if (nb::isinstance<Rows>(values)) return nb::cast<Rows>(values);
  Rows rows;
  const bool is_list = nb::isinstance<nb::list>(values) || nb::isinstance<nb::tuple>(values);
  if (is_list && nb::len(values) > 0) {
    const auto type = ValueType::of(values[0], subject + "[0]");
    if (!type->isArray()) {
      rows.type = type;
      std::size_t i = 0;
      for (const nb::handle value : values)
        type->append(value, rows.numbers, subject + "[" + std::to_string(i++) + "]");
      return rows;
    }
  }
  const nb::object array = realArray(values, subject);
  const std::vector<std::size_t> shape = shapeOf(array);
  if (shape.empty()) raiseValue(subject, "is a single number", "pass an array with one row for each value");
  rows.type = ValueType::array({shape.begin() + 1, shape.end()});
  appendArray(array, rows.numbers);
  for (std::size_t i = 0; i < rows.numbers.size(); ++i) {
    if (std::isfinite(rows.numbers[i])) continue;
    raiseValue(subject,
               "has a number that is not finite in row " +
                   std::to_string(i / static_cast<std::size_t>(rows.type->coordinates())),
               "remove such rows, or give them finite numbers");
  }
  return rows;
}

nb::object toPython(Rows rows) {
  if (!rows.type->isArray()) return nb::cast(std::move(rows));
  std::vector<std::size_t> shape{rows.size()};
  shape.insert(shape.end(), rows.type->shape().begin(), rows.type->shape().end());
  return toPython(rows.numbers.data(), shape);
}

std::vector<std::size_t> indicesOf(nb::handle index, std::size_t size) {
  const nb::object all = numpy().attr("arange")(size);
  const nb::object array =
      nb::isinstance<nb::slice>(index) ? nb::object(nb::borrow(index)) : numpy().attr("asarray")(index);
  if (nb::hasattr(array, "ndim") && nb::cast<int>(array.attr("ndim")) > 1)
    raiseValue("an index array", "has more than one dimension",
               "pass one of one dimension, such as i.ravel()");
  return nb::cast<std::vector<std::size_t>>(
      nb::object(numpy().attr("atleast_1d")(all[array]).attr("tolist")()));
}

std::optional<std::size_t> singleIndexOf(nb::handle index, std::size_t size) {
  const bool is_single = nb::isinstance<nb::int_>(index) ||
                         (nb::hasattr(index, "dtype") && nb::cast<int>(index.attr("ndim")) == 0);
  if (!is_single) return std::nullopt;
  return indicesOf(index, size).front();
}

namespace {

/// Returns f(row, other) for each row. Rows, and arrays with a row for each row, are taken row by row.
template <class F>
nb::object rowWise(const Rows& rows, nb::handle other, const F& f) {
  const bool is_rows = nb::isinstance<Rows>(other);
  const bool is_array = nb::hasattr(other, "ndim") && nb::cast<int>(other.attr("ndim")) > 1;
  if ((is_rows || is_array) && nb::len(other) != rows.size()) {
    raiseValue("an operand of Rows",
               "has " + std::to_string(nb::len(other)) + " rows for " + std::to_string(rows.size()),
               "pass the same number of rows, or one value for all");
  }
  nb::list results;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const nb::object own = rows.type->value(rows.row(i));
    results.append(f(own, is_rows || is_array ? nb::object(other[i]) : nb::borrow(other)));
  }
  if (rows.size() == 0) return nb::cast(rows);
  return toPython(rowsOf(results, "the result of an operation of Rows"));
}

/// Returns whether the values have a property of this name, such as `angle`.
bool hasProperty(const Rows& rows, const std::string& name) {
  if (rows.size() == 0 || name.front() == '_') return false;
  const nb::object first = rows.type->value(rows.row(0));
  return nb::hasattr(first, name.c_str()) && !PyCallable_Check(nb::object(first.attr(name.c_str())).ptr());
}

template <class Class>
void defineOperator(Class& c, const char* name, const char* reflected) {
  const auto apply = [](const char* function, nb::handle a, nb::handle b) {
    return nb::object(nb::module_::import_("operator").attr(function)(a, b));
  };
  c.def(name, [=](const Rows& rows, nb::handle other) {
    return rowWise(rows, other, [&](nb::handle own, nb::handle x) { return apply(name, own, x); });
  });
  if (reflected == nullptr) return;
  c.def(reflected, [=](const Rows& rows, nb::handle other) {
    return rowWise(rows, other, [&](nb::handle own, nb::handle x) { return apply(name, x, own); });
  });
}

}  // namespace

void bindRows(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<Rows> c(module, "Rows", doc::kRows);
  c.def(
       "__init__",
       [](Rows* self, nb::handle values, nb::handle like) {
         Rows rows = rowsOf(values, "Rows");
         if (!like.is_none()) {
           const auto type = ValueType::of(like.is_type() ? nb::object(like()) : nb::borrow(like), "like");
           const auto width = static_cast<std::size_t>(rows.type->coordinates());
           std::vector<double> numbers;
           for (std::size_t i = 0; i < rows.size(); ++i) {
             const std::vector<double> row = type->runtime()->normalized({rows.row(i), rows.row(i) + width});
             numbers.insert(numbers.end(), row.begin(), row.end());
           }
           rows = Rows{type, std::move(numbers)};
         }
         new (self) Rows(std::move(rows));
       },
       "values"_a, "like"_a = nb::none(),
       "Rows of a list of values. With like=slom.SE3, rows of an array of the numbers that store them.")
      .def("__len__", &Rows::size)
      .def("__getitem__",
           [](const Rows& rows, nb::handle index) -> nb::object {
             if (const auto i = singleIndexOf(index, rows.size())) return rows.type->value(rows.row(*i));
             Rows some{rows.type, {}};
             for (const std::size_t i : indicesOf(index, rows.size()))
               some.numbers.insert(some.numbers.end(), rows.row(i), rows.row(i) + rows.type->coordinates());
             return nb::cast(std::move(some));
           })
      .def("__getattr__",
           [](const Rows& rows, const std::string& name) {
             const auto [type, first] = rows.type->member(name);
             if (type == nullptr && hasProperty(rows, name))
               return rowWise(rows, nb::none(),
                              [&](nb::handle own, nb::handle) { return nb::object(own.attr(name.c_str())); });
             if (type == nullptr)
               throw nb::attribute_error(
                   ("Rows of " + rows.type->runtime()->name() + " have no member " + name).c_str());
             Rows some{type, {}};
             for (std::size_t i = 0; i < rows.size(); ++i)
               some.numbers.insert(some.numbers.end(), rows.row(i) + first,
                                   rows.row(i) + first + type->coordinates());
             return toPython(std::move(some));
           })
      .def(
          "__setattr__",
          [](const Rows&, const std::string& name, nb::handle) {
            throw nb::attribute_error(
                ("Rows are copies, so " + name + " cannot be set; make new Rows, or assign to x.value")
                    .c_str());
          },
          "name"_a, "value"_a.none())
      .def("__reduce__",
           [](nb::handle rows) {
             const Rows& own = nb::cast<const Rows&>(rows);
             if (own.size() == 0) return nb::make_tuple(rows.type(), nb::make_tuple(nb::list()));
             return nb::make_tuple(rows.type(),
                                   nb::make_tuple(rows.attr("numbers"), own.type->value(own.row(0))));
           })
      .def_prop_ro(
          "numbers",
          [](const Rows& rows) {
            return toPython(rows.numbers.data(),
                            {rows.size(), static_cast<std::size_t>(rows.type->coordinates())});
          },
          "The numbers that store the values, one row for each: of SE3 the position and the quaternion (x, y, z, w).")
      .def("__repr__", [](const Rows& rows) {
        return "<" + std::to_string(rows.size()) + " rows of " + rows.type->runtime()->name() + ">";
      });
  c.def(
      "inverse",
      [](const Rows& rows) {
        return rowWise(rows, nb::none(),
                       [](nb::handle own, nb::handle) { return nb::object(own.attr("inverse")()); });
      },
      "Returns the inverse of each row.");
  defineOperator(c, "__mul__", "__rmul__");
  defineOperator(c, "__matmul__", "__rmatmul__");
  defineOperator(c, "__sub__", nullptr);
  defineOperator(c, "__add__", nullptr);
  c.attr("__array_ufunc__") = nb::none();  // so that NumPy's arrays leave operators to this class
}

}  // namespace slom::python
