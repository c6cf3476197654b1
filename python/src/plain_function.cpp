#include "plain_function.hpp"

#include <atomic>
#include <string>
#include <utility>

#include <nanobind/eigen/dense.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace slom::python {

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

struct PlainFunction::Shared {
  Call call;  // without rows
  nb::object jacobian;

  ~Shared() {
    const nb::gil_scoped_acquire gil;
    call = Call();
    jacobian.reset();
  }
};

PlainFunction::PlainFunction(const Call& call, nb::handle jacobian) {
  const auto shared = std::make_shared<Shared>();
  shared->call = {call.function, call.arguments, call.predicts, 0};
  for (Argument& argument : shared->call.arguments) {
    argument.variables.clear();
    argument.data.clear();
  }
  shared->jacobian = nb::borrow(jacobian);
  shared_ = shared;
}

namespace {
/// Throws an error of the package as one of the library, which passes the fit as it is.
[[noreturn]] void throwAsOwn(const nb::python_error& error) {
  const auto part = [&](const char* name) {
    return nb::cast<std::string>(nb::str(nb::object(nb::handle(error.value()).attr(name))));
  };
  throw mtk::Error(part("id"), part("sentence"), part("subject"));
}

/// Returns f(), which calls Python, from a thread without the interpreter's lock.
template <class F>
auto calling(const F& f) {
  const nb::gil_scoped_acquire gil;
  try {
    return f();
  } catch (nb::python_error& error) {
    if (error.matches(nb::module_::import_("slom._error").attr("Error"))) throwAsOwn(error);
    if (!error.matches(PyExc_KeyboardInterrupt) || !Interrupt::request()) throw FunctionThrew(error);
  }
  return f();  // the fit asks before its next step whether it shall end
}
}  // namespace

Eigen::VectorXd PlainFunction::operator()(std::span<const VariableView> x,
                                          const std::vector<double>& data) const {
  return calling([&] { return residual(x, data); });
}

bool PlainFunction::hasJacobian() const { return !shared_->jacobian.is_none(); }

Eigen::MatrixXd PlainFunction::jacobian(std::span<const VariableView> x, const std::vector<double>& data,
                                        int rows, int columns) const {
  return calling([&] {
    nb::list arguments = argumentsOf(x, data);
    if (shared_->call.predicts) arguments.attr("pop")();
    const nb::object matrix = nb::module_::import_("slom._jacobian")
                                  .attr("matrix")(shared_->jacobian(*nb::tuple(arguments)), rows, columns);
    return nb::cast<Eigen::MatrixXd>(matrix);
  });
}

nb::list PlainFunction::argumentsOf(std::span<const VariableView> x, const std::vector<double>& data) const {
  const double* datum = data.data();
  std::size_t next = 0;
  nb::list arguments;
  for (const Argument& argument : shared_->call.arguments) {
    if (argument.is_variable) {
      arguments.append(argument.type->value(static_cast<const double*>(x[next++].pointer())));
    } else {
      arguments.append(argument.type->value(datum));
      datum += argument.type->coordinates();
    }
  }
  return arguments;
}

Eigen::VectorXd PlainFunction::residual(std::span<const VariableView> x,
                                        const std::vector<double>& data) const {
  std::vector<double> numbers;
  appendDoubles(residualOf(shared_->call, argumentsOf(x, data)), numbers);
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

DerivedMeasurement::DerivedMeasurement(std::vector<AnyVarID> variables, PlainFunction f,
                                       std::vector<double> data)
    : RuntimeMeasurement("the measurement", std::move(variables)), f_(std::move(f)), data_(std::move(data)) {
  for (const AnyVarID& id : this->variables()) columns_ += RuntimeType::of(id)->dof();
}

const RuntimeKind& DerivedMeasurement::kind() const {
  static constexpr RuntimeKind kind{&typeid(DerivedMeasurement), DerivativeSource::given,
                                    +[] { return std::string("function"); }, false};
  return kind;
}

int DerivedMeasurement::evaluate(int rows, double* r) const {
  const Eigen::VectorXd residual = f_(views(), data_);
  if (r != nullptr && residual.size() == rows) Eigen::Map<Eigen::VectorXd>(r, rows) = residual;
  return static_cast<int>(residual.size());
}

int DerivedMeasurement::linearize(int rows, double* r, double* J) const {
  const int length = evaluate(rows, r);
  if (J != nullptr && length == rows)
    Eigen::Map<Eigen::MatrixXd>(J, rows, columns_) = f_.jacobian(views(), data_, rows, columns_);
  return length;
}

std::unique_ptr<RuntimeMeasurement> DerivedMeasurement::copyOver(std::vector<AnyVarID> variables) const {
  return std::make_unique<DerivedMeasurement>(std::move(variables), f_, data_);
}

}  // namespace slom::python
