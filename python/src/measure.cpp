#include "measure.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <typeindex>
#include <utility>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/slom.hpp>
#include <slom/tape.hpp>

#include "documentation.hpp"
#include "manifolds.hpp"
#include "recorded.hpp"

namespace slom::python {

namespace {

using namespace nb::literals;

/// An argument of a measurement function: a variable or a variable for each row; a datum or a datum for each row.
struct Argument {
  std::shared_ptr<const ValueType> type;
  std::vector<AnyVarID> variables;
  std::vector<double> data;
  bool is_variable = false;
  bool is_for_all = false;  ///< the same in each row

  std::size_t rows() const {
    return is_variable ? variables.size() : data.size() / static_cast<std::size_t>(type->coordinates());
  }
  const AnyVarID& variable(std::size_t row) const { return variables[is_for_all ? 0 : row]; }
  const double* datum(std::size_t row) const {
    return data.data() + (is_for_all ? 0 : row * static_cast<std::size_t>(type->coordinates()));
  }
};

std::string nameOfArgument(std::size_t i) {
  return "argument " + std::to_string(i + 1) + " of the measurement function";
}

[[noreturn]] void raiseArgument(const std::string& subject, const std::string& fault) {
  throw mtk::Error("slom.bad-argument", subject + " " + fault, "measure");
}

void appendVariable(Argument& argument, const Variable& x, const std::string& subject) {
  if (argument.type != nullptr && !(*argument.type == *x.type)) {
    raiseArgument(subject, "has variables of types " + argument.type->runtime()->name() + " and " +
                               x.type->runtime()->name() + "; pass variables of one type");
  }
  argument.type = x.type;
  argument.variables.push_back(x.id);
}

Argument argumentOf(nb::handle value, const std::string& subject) {
  Argument argument;
  argument.is_variable = true;
  if (nb::isinstance<Variable>(value)) {
    appendVariable(argument, nb::cast<Variable>(value), subject);
    argument.is_for_all = true;
    return argument;
  }
  if (nb::isinstance<VariableArray>(value)) {
    auto all = nb::cast<VariableArray>(value);
    argument.type = all.type;
    argument.variables = std::move(all.ids);
    return argument;
  }
  if ((nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) && nb::len(value) > 0 &&
      nb::isinstance<Variable>(value[0])) {
    for (const nb::handle one : value) {
      if (!nb::isinstance<Variable>(one))
        raiseArgument(subject, "is a list in which not all entries are variables; pass variables alone");
      appendVariable(argument, nb::cast<Variable>(one), subject);
    }
    return argument;
  }
  argument.is_variable = false;
  const bool is_rows = nb::isinstance<Rows>(value) || nb::isinstance<nb::list>(value) ||
                       nb::isinstance<nb::tuple>(value) ||
                       (!nb::hasattr(value.type(), "__slom_fields__") && nb::hasattr(value, "__len__") &&
                        nb::cast<int>(numpy().attr("ndim")(value)) > 0);
  if (is_rows) {
    Rows rows = rowsOf(value, subject);
    argument.type = rows.type;
    argument.data = std::move(rows.numbers);
  } else {
    argument.type = ValueType::of(value, subject);
    argument.type->append(value, argument.data, subject);
    argument.is_for_all = true;
  }
  return argument;
}

/// The function, arguments and number of rows of a call of measure.
struct Call {
  nb::object function;
  std::vector<Argument> arguments;  ///< with the datum last, if there is one
  bool predicts = false;            ///< the residual is f(...) [-] the last argument
  std::size_t rows = 1;
};

nb::object minus(nb::handle prediction, nb::handle datum) {
  return nb::module_::import_("slom._measured").attr("minus")(prediction, datum);
}

/// Calls the function with these arguments and returns the residual.
nb::object residualOf(const Call& call, const nb::list& arguments, bool is_recorded = false) {
  const auto apply = [&](const nb::list& passed) {
    return is_recorded ? callRecorded(call.function, nb::tuple(passed)) : call.function(*nb::tuple(passed));
  };
  if (!call.predicts) return apply(arguments);
  const std::size_t count = nb::len(arguments) - 1;
  nb::list passed;
  for (std::size_t i = 0; i < count; ++i) passed.append(arguments[i]);
  return minus(apply(passed), arguments[count]);
}

/// Appends the numbers of a residual.
void appendDoubles(nb::handle result, std::vector<double>& numbers) {
  if (nb::isinstance<nb::list>(result) || nb::isinstance<nb::tuple>(result)) {
    for (const nb::handle entry : result) appendDoubles(entry, numbers);
  } else {
    const std::vector<double> own = entriesOf<double>(result, -1, "the residual");
    numbers.insert(numbers.end(), own.begin(), own.end());
  }
}

/// A function that is called measurement by measurement. The library calls it from its threads.
struct PlainFunction {
  struct Shared {
    Call call;  // without rows
    ~Shared() {
      const nb::gil_scoped_acquire gil;
      call = Call();
    }
  };
  std::shared_ptr<const Shared> shared;

  Eigen::VectorXd operator()(std::span<const VariableView> x, const std::vector<double>& data) const {
    const nb::gil_scoped_acquire gil;
    try {
      return residual(x, data);
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_KeyboardInterrupt) || !Interrupt::request()) throw FunctionThrew(error);
    }
    return residual(x, data);  // the fit asks before its next step whether it shall end
  }

 private:
  Eigen::VectorXd residual(std::span<const VariableView> x, const std::vector<double>& data) const {
    const double* datum = data.data();
    std::size_t next = 0;
    nb::list arguments;
    for (const Argument& argument : shared->call.arguments) {
      if (argument.is_variable) {
        arguments.append(argument.type->value(static_cast<const double*>(x[next++].pointer())));
      } else {
        arguments.append(argument.type->value(datum));
        datum += argument.type->coordinates();
      }
    }
    std::vector<double> numbers;
    appendDoubles(residualOf(shared->call, arguments), numbers);
    return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
  }
};

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
    using Plain = ListMeasurement<PlainFunction, std::vector<double>>;
    return problem.insertMeasurement(Plain(*own.ids, *own.plain, own.measurement->data), own.noise, label,
                                     own.loss);
  }
};

/// Returns a number that differs for different types.
std::uint64_t hashOf(const RuntimeType& type) {
  std::uint64_t h = std::hash<std::string>()(type.name());
  for (const RuntimeType::Field& field : type.fields())
    h = std::rotl(h, 9) ^ (static_cast<std::uint64_t>(field.kind) << 32) ^
        static_cast<std::uint64_t>(field.size);
  return h;
}

/// A function as a tape.
struct Recorded {
  std::shared_ptr<const TracedKind> kind;
  std::vector<double> captured;  ///< data that the function brought along
  bool is_new = false;
};

Recorded record(const Call& call) {
  tape::Recording recording;
  nb::list proxies;
  std::vector<std::type_index> types;
  std::vector<tape::Layout> layouts;
  std::uint64_t fingerprint = 0;
  std::size_t columns = 0;
  for (const Argument& argument : call.arguments) {
    const RuntimeType& type = *argument.type->runtime();
    if (argument.is_variable) {
      proxies.append(argument.type->recorded(recording.variable(tape::typeOf(type))));
      types.emplace_back(typeid(RuntimeType));
      layouts.push_back(tape::layoutOf(type));
      fingerprint = std::rotl(fingerprint, 7) ^ hashOf(type);
    } else {
      tape::Recording::Input datum;
      for (int i = 0; i < type.coordinates(); ++i)
        datum.coordinates.push_back(recording.data(argument.datum(0)[i]));
      proxies.append(argument.type->recorded(datum));
      columns += static_cast<std::size_t>(type.coordinates());
    }
  }
  std::vector<tape::Number> residual;
  {
    const Captures captures(call.rows == 1);
    appendNumbers(residualOf(call, proxies, true), residual);
  }
  if (residual.empty()) {
    throw mtk::Error("slom.traced-result",
                     "a measurement function returned no numbers; return the residual, a number or an array",
                     "measure");
  }
  Recorded result;
  result.captured.assign(recording.values().begin() + static_cast<std::ptrdiff_t>(columns),
                         recording.values().end());
  fingerprint ^= recording.fingerprint(residual);
  result.kind = TracedKind::remembered(fingerprint);
  if (result.kind == nullptr) {
    result.is_new = true;
    result.kind = TracedKind::shared(recording.finish(residual), std::move(types), std::move(layouts));
    TracedKind::remember(fingerprint, result.kind);
  }
  return result;
}

/// Sets `data` to the numbers of a row, with those that the function brought along.
void setData(const Call& call, const Recorded& recorded, std::size_t row, std::vector<double>& data) {
  data.clear();
  for (const Argument& argument : call.arguments) {
    if (argument.is_variable) continue;
    const double* const datum = argument.datum(row);
    data.insert(data.end(), datum, datum + argument.type->coordinates());
  }
  data.insert(data.end(), recorded.captured.begin(), recorded.captured.end());
}

/// Writes the residual at these values of the variables, and unless J is null the Jacobian, from the tape.
void evaluate(const Recorded& recorded, const std::vector<std::vector<double>>& values,
              const std::vector<double>& data, double* r, double* J) {
  std::vector<const double*> pointers;
  for (const std::vector<double>& value : values) pointers.push_back(value.data());
  recorded.kind->tape.evaluate(1, {pointers.data(), data.data()}, r, J);
}

/// Pseudo-random numbers in [-1, 1], always the same ones.
struct Moves {
  std::uint32_t state = 12345;
  double next() {
    state = state * 1664525u + 1013904223u;
    return static_cast<double>(state) / 2147483648.0 - 1;
  }
};

/// Returns the values of a row's variables: the current ones, or others near them.
std::vector<std::vector<double>> valuesOf(const Call& call, std::size_t row, bool is_moved) {
  std::vector<std::vector<double>> values;
  Moves moves;
  for (const Argument& argument : call.arguments) {
    if (!argument.is_variable) continue;
    const AnyVarID& id = argument.variable(row);
    const auto* const numbers = static_cast<const double*>(id.current());
    values.emplace_back(numbers, numbers + argument.type->coordinates());
    if (!is_moved) continue;
    std::vector<double> d(static_cast<std::size_t>(argument.type->runtime()->dof()));
    id.store()->typicalSizesOf(numbers, d.data());
    for (double& size : d) size = moves.next() * (0.05 * size + 1e-3);
    id.store()->boxplus(values.back().data(), d.data());
  }
  return values;
}

nb::list argumentsOf(const Call& call, std::size_t row, const std::vector<std::vector<double>>& values) {
  nb::list arguments;
  std::size_t next = 0;
  for (const Argument& argument : call.arguments)
    arguments.append(
        argument.type->value(argument.is_variable ? values[next++].data() : argument.datum(row)));
  return arguments;
}

/// Keeps NumPy from warning of logarithms of negative numbers and the like.
class QuietNumpy {
 public:
  QuietNumpy() : before_(numpy().attr("seterr")("all"_a = "ignore")) {}
  ~QuietNumpy() { numpy().attr("seterr")(**nb::cast<nb::dict>(before_)); }
  QuietNumpy(const QuietNumpy&) = delete;
  QuietNumpy& operator=(const QuietNumpy&) = delete;

 private:
  nb::object before_;
};

/// Returns the residual of a row at these values of its variables, by calling the function as it is.
std::vector<double> plainResidual(const Call& call, std::size_t row,
                                  const std::vector<std::vector<double>>& values) {
  std::vector<double> residual;
  appendDoubles(residualOf(call, argumentsOf(call, row, values)), residual);
  return residual;
}

std::string textOf(double x) { return nb::cast<std::string>(nb::str(nb::float_(x))); }

/// Returns how the recorded formula differs from the function; empty if it does not. Compares some rows, at the present
/// values of the variables and at others.
std::string differenceFrom(const Call& call, const Recorded& recorded) {
  const tape::Tape& tape = recorded.kind->tape;
  std::vector<double> data;
  const QuietNumpy quiet;
  for (const std::size_t row : std::set<std::size_t>{0, call.rows / 2, call.rows - 1}) {
    for (const bool is_moved : {false, true}) {
      const std::vector<std::vector<double>> values = valuesOf(call, row, is_moved);
      std::vector<double> plain;
      try {
        plain = plainResidual(call, row, values);
      } catch (nb::python_error&) {
        continue;  // such as the logarithm of a negative number
      }
      if (plain.size() != static_cast<std::size_t>(tape.rows())) {
        throw mtk::Error(
            "slom.wrong-length",
            "the measurement function returns " + std::to_string(plain.size()) + " numbers for row " +
                std::to_string(row) + " and " + std::to_string(tape.rows()) +
                " for row 0; return the same number for each row, or measure the rows in several calls",
            "measure");
      }
      std::vector<double> r(plain.size());
      setData(call, recorded, row, data);
      evaluate(recorded, values, data, r.data(), nullptr);
      double scale = 1e-3;
      for (const double x : plain) scale = std::max(scale, std::isfinite(x) ? std::abs(x) : 0);
      for (const double x : data) scale = std::max(scale, std::abs(x));
      for (std::size_t i = 0; i < r.size(); ++i) {
        const bool is_equal = std::isfinite(r[i]) && std::isfinite(plain[i])
                                  ? std::abs(r[i] - plain[i]) <= 1e-8 * scale
                                  : !std::isfinite(r[i]) && !std::isfinite(plain[i]);
        if (!is_equal)
          return "gives " + textOf(plain[i]) + " where its recorded formula gives " + textOf(r[i]) +
                 ", so it depends on more than its arguments, or branches";
      }
    }
  }
  return "";
}

std::string labelOf(nb::handle f, const std::string& name) {
  if (!name.empty()) return name;
  const auto own = nb::cast<std::string>(nb::str(nb::getattr(f, "__name__", nb::str("function"))));
  return own == "<lambda>" ? "function" : own;
}

void warn(const std::string& text) {
  const nb::object package = nb::module_::import_("slom");
  nb::module_::import_("warnings")
      .attr("warn")(text, package.attr("SlowFunctionWarning"), "stacklevel"_a = 3);
}

/// Returns the function as a tape, or nothing if it must be called as it is. `trace`: true raises in place of the
/// latter, false records nothing.
std::optional<Recorded> recordedOrNot(const Call& call, const std::string& label, std::optional<bool> trace) {
  if (trace == false) return std::nullopt;
  std::string refusal;
  try {
    Recorded recorded = record(call);
    if (recorded.is_new) refusal = differenceFrom(call, recorded);
    if (refusal.empty()) return recorded;
    if (trace == true)
      throw mtk::Error("slom.traced-differs",
                       "the measurement function " + label + " " + refusal +
                           "; pass all it depends on as arguments, and write slom.where in place of `if`",
                       label);
  } catch (const mtk::Error& error) {
    if (trace == true || error.id().rfind("slom.traced", 0) != 0) throw;
    refusal = "cannot be recorded: " + std::string(error.sentence());
  } catch (nb::python_error& error) {
    if (trace == true) throw;
    plainResidual(call, 0, valuesOf(call, 0, false));  // raises the user's own mistakes
    const nb::object sentence = nb::getattr(error.value(), "sentence", nb::str(error.value()));
    refusal = "cannot be recorded: " + nb::cast<std::string>(sentence);
  }
  warn("the measurement function " + label + " " + refusal +
       ". It is called for each measurement, with numeric derivatives, which is slow");
  return std::nullopt;
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
  if ((length == 1 && shape == one_a_row) || shape == row_column) return set(Shape::scalar, 1, true);
  if (shape == components) return set(Shape::vector, length, false);
  if (is_sigma && shape == table) return set(Shape::vector, length, true);
  if (!is_sigma && shape == matrix) return set(Shape::matrix, length, false);
  if (!is_sigma && shape == matrices) return set(Shape::matrix, length, true);
  const std::string n = std::to_string(rows), m = std::to_string(length);
  const std::string accepted = length == 1 ? "a number, or one for each row (" + n + ",)"
                               : is_sigma
                                   ? "a number, one for each component (" + m + ",), one for each row (" + n +
                                         ", 1), or both (" + n + ", " + m + ")"
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
    return group(dimension, nb::cast<std::int64_t>(nb::int_(nb::object(nb::borrow(key)))));
  };
  if (nb::isinstance<nb::str>(keys) || !nb::hasattr(keys, "__len__")) {
    for (const AnyMeasID& id : ids) est.setGroup(id, groupOf(keys));
    return;
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

Call callOf(nb::handle f, const nb::args& passed, nb::handle measured) {
  Call call;
  call.function = nb::borrow(f);
  bool has_rows = false, has_variable = false;
  const auto add = [&](nb::handle value, const std::string& subject) {
    call.arguments.push_back(argumentOf(value, subject));
    const Argument& argument = call.arguments.back();
    has_variable = has_variable || argument.is_variable;
    if (argument.is_for_all) return;
    const std::size_t own = argument.rows();
    if (has_rows && own != call.rows) {
      raiseArgument(subject, "has " + std::to_string(own) + " rows where earlier ones have " +
                                 std::to_string(call.rows) + "; pass the same number of rows");
    }
    call.rows = own;
    has_rows = true;
  };
  for (std::size_t i = 0; i < passed.size(); ++i) add(passed[i], nameOfArgument(i));
  if (!measured.is_none()) {
    add(measured, "measured");
    call.predicts = true;
  }
  if (!has_variable)
    raiseArgument("measure", "was given no variable; pass what est.variable returned, after the function");
  return call;
}

Measurements measure(const Shared& est, const nb::callable& f, const nb::args& passed, nb::handle measured,
                     nb::handle sigma, nb::handle covariance, nb::handle information, const Loss& loss,
                     nb::handle group, const std::string& name, std::optional<bool> trace) {
  Measurements result{est, {}};
  Call call = callOf(f, passed, measured);
  if (call.rows == 0) return result;
  const std::string label = labelOf(f, name);
  const std::optional<Recorded> recorded = recordedOrNot(call, label, trace);
  const Recorded none;
  std::optional<PlainFunction> plain;
  std::size_t length = 0;
  if (recorded) {
    length = static_cast<std::size_t>(recorded->kind->tape.rows());
  } else {
    length = plainResidual(call, 0, valuesOf(call, 0, false)).size();
    const auto shared = std::make_shared<PlainFunction::Shared>();
    shared->call = {call.function, call.arguments, call.predicts, 0};
    for (Argument& argument : shared->call.arguments) {
      argument.variables.clear();
      argument.data.clear();
    }
    plain = PlainFunction{shared};
  }
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

Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> residualsOf(const Measurements& all,
                                                                                   bool is_whitened) {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result;
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    const Eigen::VectorXd r =
        is_whitened ? all.est->whitenedResidual(all.ids[i]) : all.est->residual(all.ids[i]);
    if (i == 0) result.resize(static_cast<Eigen::Index>(all.ids.size()), r.size());
    result.row(static_cast<Eigen::Index>(i)) = r.transpose();
  }
  return result;
}

}  // namespace

namespace {
std::atomic<int> fits = 0;
std::atomic<bool> is_requested = false;
}  // namespace

Interrupt::Interrupt() { ++fits; }
Interrupt::~Interrupt() {
  if (--fits == 0) is_requested = false;
}
bool Interrupt::request() {
  if (fits == 0) return false;
  return is_requested = true;
}
bool Interrupt::operator()() {
  const nb::gil_scoped_acquire gil;
  if (!error_) {
    if (is_requested) PyErr_SetNone(PyExc_KeyboardInterrupt);
    if (is_requested || PyErr_CheckSignals() != 0) error_.emplace();
  }
  return error_.has_value();
}
void Interrupt::raise() {
  if ((*this)()) throw nb::python_error(std::move(*error_));
}

FunctionThrew::FunctionThrew(const nb::python_error& error)
    : std::runtime_error(nb::cast<std::string>(nb::object(error.type().attr("__name__"))) + ": " +
                         nb::cast<std::string>(nb::str(error.value()))),
      error_(std::make_shared<nb::python_error>(error)) {}

nb::object FunctionThrew::exception() const { return nb::borrow(error_->value()); }

Derived derivedFrom(nb::handle f, const std::vector<Variable>& variables) {
  Call call;
  call.function = nb::borrow(f);
  int columns = 0;
  for (const Variable& x : variables) {
    Argument argument;
    argument.is_variable = argument.is_for_all = true;
    argument.type = x.type;
    argument.variables = {x.id};
    columns += x.type->runtime()->dof();
    call.arguments.push_back(std::move(argument));
  }
  const std::vector<std::vector<double>> values = valuesOf(call, 0, false);
  const nb::object value = residualOf(call, argumentsOf(call, 0, values));
  Derived result{ValueType::of(value, "the value of the function"), {}, {}};
  result.type->append(value, result.numbers, "the value of the function");
  Argument datum;
  datum.type = result.type;
  datum.data = result.numbers;
  datum.is_for_all = true;
  call.arguments.push_back(std::move(datum));
  call.predicts = true;

  const Recorded recorded = record(call);
  std::vector<double> data;
  setData(call, recorded, 0, data);
  Eigen::VectorXd r(recorded.kind->tape.rows());
  result.jacobian.resize(r.size(), columns);
  evaluate(recorded, values, data, r.data(), result.jacobian.data());
  return result;
}

void bindMeasure(nb::module_& module, nb::class_<Estimator>& estimator) {
  nb::class_<Measurements>(module, "Measurements",
                           "The measurements that a call of measure added, one a row.")
      .def("__len__", [](const Measurements& all) { return all.ids.size(); })
      .def("__getitem__",
           [](const Measurements& all, nb::handle index) {
             Measurements some{all.est, {}};
             for (const std::size_t i : indicesOf(index, all.ids.size())) some.ids.push_back(all.ids[i]);
             return some;
           })
      .def_prop_ro(
          "residuals", [](const Measurements& all) { return residualsOf(all, false); },
          "The residuals in their own units, one row for each measurement.")
      .def_prop_ro(
          "whitened_residuals", [](const Measurements& all) { return residualsOf(all, true); },
          "The residuals in units of their standard deviations.")
      .def_prop_ro(
          "weights",
          [](const Measurements& all) {
            Eigen::VectorXd weights(static_cast<Eigen::Index>(all.ids.size()));
            for (std::size_t i = 0; i < all.ids.size(); ++i)
              weights[static_cast<Eigen::Index>(i)] = all.est->weight(all.ids[i]);
            return weights;
          },
          "The weights that the loss gives, between 0 and 1.")
      .def_prop_ro(
          "names",
          [](const Measurements& all) {
            std::vector<std::string> names;
            for (const AnyMeasID& id : all.ids) names.push_back(all.est->nameOf(id));
            return names;
          },
          "The names in messages and reports.")
      .def(
          "remove",
          [](const Measurements& all) {
            for (const AnyMeasID& id : all.ids) all.est->removeMeasurement(id);
          },
          "Removes the measurements.")
      .def("__repr__", [](const Measurements& all) {
        return all.ids.size() == 1 ? "<" + all.est->nameOf(all.ids[0]) + ">"
               : all.ids.empty()
                   ? std::string("<no measurements>")
                   : "<" + std::to_string(all.ids.size()) + " measurements, " +
                         all.est->nameOf(all.ids.front()) + " to " + all.est->nameOf(all.ids.back()) + ">";
      });

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

  estimator.def("measure", &measure, "function"_a, "arguments"_a, nb::kw_only(), "measured"_a = nb::none(),
                "sigma"_a = nb::none(), "covariance"_a = nb::none(), "information"_a = nb::none(),
                "loss"_a = Loss(), "group"_a = nb::none(), "name"_a = "", "trace"_a = nb::none(),
                doc::kMeasure);
}

}  // namespace slom::python
