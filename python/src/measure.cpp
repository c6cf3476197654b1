#include "measure.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/slom.hpp>
#include <slom/tape.hpp>

#include "alone.hpp"
#include "documentation.hpp"
#include "manifolds.hpp"
#include "plain_function.hpp"
#include "record.hpp"

namespace slom::python {

namespace {

using namespace nb::literals;

/// Noise in numbers, for all rows or one by one.
struct Noise {
  NoiseView view;  ///< of the first row
  std::vector<double> numbers;
  std::size_t stride = 0;  ///< numbers from row to row

  NoiseView of(std::size_t row) const {
    NoiseView own = view;
    own.entries = numbers.data() + row * stride;
    return own;
  }
};

/// Inserts a measurement that is recorded already, as slom::traced does; or one that calls Python.
struct Insertion {
  using Traced = TracedMeasurement;
  TracedMeasurement* measurement;
  const PlainFunction* plain;
  const std::vector<AnyVarID>* ids;
  NoiseView noise;
  Loss loss;

  static AnyMeasID insert(Problem& problem, const Insertion& own, const NoiseView&, std::string_view label,
                          const Loss&) {
    if (own.plain == nullptr) return insertTraced(problem, *own.measurement, own.noise, label, own.loss);
    if (own.plain->hasJacobian()) {
      return problem.insertMeasurement(DerivedMeasurement(*own.ids, *own.plain, own.measurement->data),
                                       own.noise, label, own.loss);
    }
    using Plain = ListMeasurement<PlainFunction, std::vector<double>>;
    return problem.insertMeasurement(Plain(*own.ids, *own.plain, own.measurement->data), own.noise, label,
                                     own.loss);
  }
};

std::string labelOf(nb::handle f, const std::string& name) {
  if (!name.empty()) return name;
  const auto own = nb::cast<std::string>(nb::str(nb::getattr(f, "__name__", nb::str("function"))));
  return own == "<lambda>" ? "function" : own;
}

Noise noiseOf(nb::handle sigma, nb::handle covariance, nb::handle information, std::size_t rows,
              std::size_t length) {
  if (int(!sigma.is_none()) + int(!covariance.is_none()) + int(!information.is_none()) > 1)
    throw mtk::Error("slom.bad-argument",
                     "measure was given more than one of sigma, covariance and information; pass one of them",
                     "measure");
  Noise noise;
  const bool is_sigma = !sigma.is_none();
  const nb::handle given = is_sigma ? sigma : covariance.is_none() ? information : covariance;
  if (given.is_none()) return noise;
  const std::string name = is_sigma ? "sigma" : covariance.is_none() ? "information" : "covariance";
  noise.view.form = is_sigma               ? NoiseForm::standard_deviation
                    : covariance.is_none() ? NoiseForm::inv_covariance
                                           : NoiseForm::covariance;
  noise.numbers = entriesOf<double>(given, -1, name);
  const std::vector<std::size_t> shape = shapeOf(given);
  const auto set = [&](NoiseView::Shape kind, std::size_t n, bool by_row) {
    noise.view.shape = kind;
    noise.view.rows = static_cast<int>(n);
    noise.view.cols = kind == NoiseView::Shape::matrix ? static_cast<int>(n) : 1;
    noise.stride = !by_row ? 0 : kind == NoiseView::Shape::matrix ? n * n : n;
    return noise;
  };
  using Shape = NoiseView::Shape;
  const std::vector<std::size_t> one_a_row{rows}, row_column{rows, 1}, components{length},
      table{rows, length}, matrix{length, length}, matrices{rows, length, length};
  if (shape.empty()) return set(Shape::scalar, 1, false);
  if (rows == length && rows > 1 && shape == one_a_row) {
    throw mtk::Error(
        "slom.wrong-shape",
        name + " has " + std::to_string(rows) +
            " entries for as many rows with as many components; pass x[None] for one entry for each "
            "component, or x[:, None] for one for each row",
        name);
  }
  if (shape == one_a_row || shape == row_column) return set(Shape::scalar, 1, true);
  if (shape == components || shape == std::vector<std::size_t>{1, length})
    return set(Shape::vector, length, false);
  if (is_sigma && shape == table) return set(Shape::vector, length, true);
  if (!is_sigma && shape == matrix) return set(Shape::matrix, length, false);
  if (!is_sigma && shape == matrices) return set(Shape::matrix, length, true);
  const std::string n = std::to_string(rows), m = std::to_string(length);
  const std::string accepted = length == 1 ? "a number, or one for each row (" + n + ",)"
                               : is_sigma
                                   ? "a number, one for each component (" + m + ",), one for each row (" + n +
                                         ",), or both (" + n + ", " + m + ")"
                                   : "a number, one for each component (" + m + ",), a matrix (" + m + ", " +
                                         m + "), or one for each row (" + n + ", " + m + ", " + m + ")";
  throw mtk::Error("slom.wrong-shape",
                   name + " has the shape " +
                       nb::cast<std::string>(nb::str(nb::object(numpy().attr("shape")(given)))) + " for " +
                       n + " rows with residuals of length " + m + "; pass " + accepted,
                   name);
}

/// Puts the measurements into groups: `keys` is one key, or one for each.
void setGroups(Estimator& est, const std::vector<AnyMeasID>& ids, const std::string& dimension,
               nb::handle keys) {
  const auto groupOf = [&](nb::handle key) {
    if (nb::isinstance<nb::str>(key)) return group(dimension, std::string_view(nb::cast<std::string>(key)));
    if (nb::hasattr(key, "isoformat"))  // dates
      return group(dimension, std::string_view(nb::cast<std::string>(nb::str(key))));
    if (PyFloat_Check(key.ptr()) && std::floor(nb::cast<double>(key)) == nb::cast<double>(key))
      return group(dimension, static_cast<std::int64_t>(nb::cast<double>(key)));
    if (!nb::hasattr(key, "__index__")) {
      throw mtk::Error("slom.bad-argument",
                       "a key of a group is a " + nb::cast<std::string>(key.type().attr("__name__")) +
                           "; pass integers or strings",
                       "group");
    }
    return group(dimension, nb::cast<std::int64_t>(nb::int_(nb::object(nb::borrow(key)))));
  };
  if (nb::isinstance<nb::str>(keys) || !nb::hasattr(keys, "__len__")) {
    for (const AnyMeasID& id : ids) est.setGroup(id, groupOf(keys));
    return;
  }
  if (nb::hasattr(keys, "ndim") && nb::cast<int>(keys.attr("ndim")) > 1) {
    throw mtk::Error(
        "slom.bad-argument",
        "the keys of groups have more than one dimension; pass one column, or a dict with a column for each "
        "kind of groups",
        "group");
  }
  if (nb::len(keys) != ids.size()) {
    throw mtk::Error("slom.bad-argument",
                     "there are " + std::to_string(nb::len(keys)) + " keys of groups for " +
                         std::to_string(ids.size()) +
                         " measurements; pass one key for each row, or one for all",
                     "group");
  }
  std::size_t i = 0;
  for (const nb::handle key : keys) est.setGroup(ids[i++], groupOf(key));
}

Loss lossFrom(nb::handle loss) {
  if (loss.is_none()) return {};
  if (!nb::isinstance<Loss>(loss)) {
    throw mtk::Error("slom.bad-argument",
                     "loss is a " + nb::cast<std::string>(loss.type().attr("__name__")) +
                         "; pass a loss such as slom.Huber(1.345), or None for least squares",
                     "loss");
  }
  return nb::cast<Loss>(loss);
}

Measurements measure(const Shared& est, nb::handle f, const nb::args& passed, nb::handle measured,
                     nb::handle sigma, nb::handle covariance, nb::handle information, nb::handle loss_or_none,
                     nb::handle group, const std::string& name, std::optional<bool> trace,
                     nb::handle jacobian) {
  if (!PyCallable_Check(f.ptr())) {
    throw mtk::Error("slom.bad-argument",
                     "the first argument of measure is a " +
                         nb::cast<std::string>(f.type().attr("__name__")) +
                         "; pass the measurement function first, then its variables and data",
                     "measure");
  }
  Measurements result{est, {}};
  Call call = callOf(f, passed, measured);
  if (call.rows == 0) return result;
  checkRows(call);
  const Loss loss = lossFrom(loss_or_none);
  const std::string label = labelOf(f, name);
  if (!jacobian.is_none() && trace == true) {
    throw mtk::Error(
        "slom.bad-argument",
        "measure was given jacobian and trace=True, but a recorded function has its own derivatives; drop "
        "one of them",
        "measure");
  }
  const std::optional<Recorded> recorded =
      recordedOrNot(call, label, jacobian.is_none() ? trace : std::optional<bool>(false));
  const Recorded none;
  std::optional<PlainFunction> plain;
  std::size_t length = 0;
  if (recorded) {
    length = static_cast<std::size_t>(recorded->kind->tape.rows());
  } else {
    length = plainResidual(call, 0, valuesOf(call, 0, false)).size();
    plain.emplace(call, jacobian);
  }
  result.length = length;
  const Noise noise = noiseOf(sigma, covariance, information, call.rows, length);

  TracedMeasurement measurement;
  if (recorded) measurement.kind = recorded->kind;
  std::vector<AnyVarID> ids;
  result.ids.reserve(call.rows);
  try {
    for (std::size_t row = 0; row < call.rows; ++row) {
      measurement.variables.clear();
      ids.clear();
      for (const Argument& argument : call.arguments) {
        if (argument.is_variable && plain) ids.push_back(argument.variable(row));
        if (argument.is_variable && recorded) measurement.variables.emplace_back(argument.variable(row));
      }
      setData(call, recorded ? *recorded : none, row, measurement.data);
      const Insertion insertion{&measurement, plain ? &*plain : nullptr, &ids, noise.of(row), loss};
      result.ids.push_back(est->insertMeasurement(insertion, named(label)));
    }
    if (nb::isinstance<nb::dict>(group)) {
      for (const auto [dimension, keys] : nb::cast<nb::dict>(group))
        setGroups(*est, result.ids, nb::cast<std::string>(dimension), keys);
    } else if (!group.is_none()) {
      setGroups(*est, result.ids, "", group);
    }
  } catch (...) {
    for (auto id = result.ids.rbegin(); id != result.ids.rend(); ++id) est->removeMeasurement(*id);
    throw;
  }
  return result;
}

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns whether a measurement is still in the estimator.
bool isPresent(const Estimator& est, const AnyMeasID& id) {
  try {
    est.table().locate(id);
    return true;
  } catch (const mtk::Error&) {
    return false;
  }
}

/// Returns the residuals, one row for each measurement; NaN for those that were removed.
RowMatrix residualsOf(const Measurements& all, bool is_whitened) {
  RowMatrix result =
      RowMatrix::Constant(static_cast<Eigen::Index>(all.ids.size()), static_cast<Eigen::Index>(all.length),
                          std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    if (!isPresent(*all.est, all.ids[i])) continue;
    const Eigen::VectorXd r =
        is_whitened ? all.est->whitenedResidual(all.ids[i]) : all.est->residual(all.ids[i]);
    result.row(static_cast<Eigen::Index>(i)) = r.transpose();
  }
  return result;
}

Eigen::VectorXd weightsOf(const Measurements& all) {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(all.ids.size()));
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    weights[static_cast<Eigen::Index>(i)] = isPresent(*all.est, all.ids[i])
                                                ? all.est->weight(all.ids[i])
                                                : std::numeric_limits<double>::quiet_NaN();
  }
  return weights;
}

std::string textOf(const Measurements& all) {
  std::vector<std::string> names;
  for (const AnyMeasID& id : all.ids) {
    if (isPresent(*all.est, id)) names.push_back(all.est->nameOf(id));
  }
  if (names.empty()) return "<no measurements>";
  if (names.size() == 1) return "<" + names[0] + ">";
  return "<" + std::to_string(names.size()) + " measurements, " + names.front() + " to " + names.back() + ">";
}

}  // namespace

void bindMeasure(nb::module_& module, nb::class_<Estimator>& estimator) {
  nb::class_<Measurements>(module, "Measurements",
                           "The measurements that a call of measure added, one a row.")
      .def("__len__", [](const Measurements& all) { return all.ids.size(); })
      .def("__getitem__",
           [](const Measurements& all, nb::handle index) {
             Measurements some{all.est, {}, all.length};
             for (const std::size_t i : indicesOf(index, all.ids.size())) some.ids.push_back(all.ids[i]);
             return some;
           })
      .def_prop_ro("residuals", alone(+[](const Measurements& all) { return residualsOf(all, false); }),
                   "The residuals in their own units, one row for each measurement; NaN for removed ones.")
      .def_prop_ro("whitened_residuals",
                   alone(+[](const Measurements& all) { return residualsOf(all, true); }),
                   "The residuals in units of their standard deviations; NaN for removed measurements.")
      .def_prop_ro("weights", alone(&weightsOf),
                   "The weights that the loss gives, between 0 and 1; NaN for removed measurements.")
      .def_prop_ro(
          "names",
          [](const Measurements& all) {
            std::vector<std::string> names;
            for (const AnyMeasID& id : all.ids)
              names.push_back(isPresent(*all.est, id) ? all.est->nameOf(id) : "");
            return names;
          },
          "The names in messages and reports, which count from 1; empty for removed measurements.")
      .def("remove", alone(+[](const Measurements& all) {
             for (const AnyMeasID& id : all.ids) {
               if (isPresent(*all.est, id)) all.est->removeMeasurement(id);
             }
           }),
           "Removes the measurements.")
      .def("__repr__", &textOf);

  nb::class_<Loss>(module, "Loss", "A robust loss. None in its place: least squares.")
      .def("__repr__", [](const Loss& loss) { return loss.text(); });
#define SLOM_BIND_SCALED(Name) \
  module.def(                  \
      #Name, [](double scale) { return Loss(Name(scale)); }, "scale"_a, doc::Name);
#define SLOM_BIND_SHAPED(Name)                                                                          \
  module.def(                                                                                           \
      #Name, [](double shape, double scale) { return Loss(Name(shape, scale)); }, "shape"_a, "scale"_a, \
      doc::Name);
  SLOM_LOSSES(SLOM_BIND_SCALED, SLOM_BIND_SHAPED)
#undef SLOM_BIND_SCALED
#undef SLOM_BIND_SHAPED

  estimator.def("measure", alone(&measure), "function"_a, "arguments"_a, nb::kw_only(),
                "measured"_a = nb::none(), "sigma"_a = nb::none(), "covariance"_a = nb::none(),
                "information"_a = nb::none(), "loss"_a = nb::none(), "group"_a = nb::none(), "name"_a = "",
                "trace"_a = nb::none(), "jacobian"_a = nb::none(), doc::kMeasure);
}

}  // namespace slom::python
