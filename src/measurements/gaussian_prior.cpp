#include "slom/measurements/gaussian_prior.hpp"

#include <algorithm>
#include <cmath>

#include "base/index.hpp"
#include "base/words.hpp"
#include "model/stored_value.hpp"

namespace slom {

namespace {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::string priorOver(int variables, int dof) {
  return "the GaussianPrior over " + counted(variables, "variable") + " with " + std::to_string(dof) +
         (dof == 1 ? " degree" : " degrees") + " of freedom";
}

}  // namespace

struct GaussianPrior::State {
  std::vector<detail::StoredValue> points;
  std::vector<double> R, b;  // R column by column
  int columns = 0;
  bool has_first_estimates = false;

  int rows() const { return static_cast<int>(b.size()); }
  Map<const MatrixXd> matrix() const { return {R.data(), rows(), columns}; }
};

GaussianPrior::GaussianPrior(std::vector<AnyVarID> variables, const double* R, Size size, const double* b,
                             Eigen::Index length)
    : RuntimeMeasurement("the GaussianPrior", std::move(variables)), state_(new State) {
  State& state = *state_;
  state.points.reserve(this->variables().size());
  for (const AnyVarID& id : this->variables()) {
    state.points.emplace_back(id, id.current());
    state.columns += state.points.back().dof();
  }
  const auto subject = [&] { return priorOver(arity(), state.columns); };
  if (size.columns != state.columns) {
    throw Error("slom.prior-size",
                subject() + " has a matrix R with " + counted(static_cast<int>(size.columns), "column") +
                    "; pass one with a column for each degree of freedom",
                "R");
  }
  if (length != size.rows) {
    throw Error("slom.prior-size",
                subject() + " has an offset b of length " + std::to_string(length) + " for " +
                    counted(static_cast<int>(size.rows), "row") +
                    " of R; pass one number for each row, or no offset",
                "b");
  }
  state.R.assign(R, R + size.rows * size.columns);
  state.b.assign(at(static_cast<int>(size.rows)), 0.0);
  if (b != nullptr) std::copy_n(b, length, state.b.begin());
  for (Eigen::Index i = 0; i < size.rows; ++i) {
    for (Eigen::Index j = 0; j < size.columns; ++j) {
      if (std::isfinite(state.matrix()(i, j))) continue;
      throw Error("slom.prior-not-finite",
                  subject() + " has R(" + std::to_string(i) + ", " + std::to_string(j) +
                      ") = " + number(state.matrix()(i, j), 6) + "; pass finite numbers",
                  "R");
    }
    if (!std::isfinite(state.b[at(static_cast<int>(i))])) {
      throw Error("slom.prior-not-finite",
                  subject() + " has b(" + std::to_string(i) +
                      ") = " + number(state.b[at(static_cast<int>(i))], 6) + "; pass finite numbers",
                  "b");
    }
  }
}

GaussianPrior::GaussianPrior(const GaussianPrior& other)
    : RuntimeMeasurement(other), state_(new State(*other.state_)) {}
GaussianPrior::GaussianPrior(GaussianPrior&&) noexcept = default;
GaussianPrior& GaussianPrior::operator=(const GaussianPrior& other) { return *this = GaussianPrior(other); }
GaussianPrior& GaussianPrior::operator=(GaussianPrior&&) noexcept = default;
GaussianPrior::~GaussianPrior() = default;

void GaussianPrior::setPoint(const AnyVarID& id, const void* value) {
  bool is_found = false;
  for (int k = 0; k < arity(); ++k) {
    if (!(variables()[at(k)] == id)) continue;
    setPoint(k, value);
    is_found = true;
  }
  if (is_found) return;
  id.current();  // throws for a stale handle
  throw Error("slom.not-in-list",
              "the VarID<" + id.store()->typeName() + "> is none of the variables of " +
                  priorOver(arity(), state_->columns) + "; give linearisation points to its own variables",
              "VarID<" + id.store()->typeName() + ">");
}

void GaussianPrior::setPoint(int k, const void* value) {
  detail::StoredValue& point = state_->points[at(k)];
  detail::StoredValue replacement(variables()[at(k)], value);
  if (replacement.dof() != point.dof()) {
    throw Error("slom.size-change",
                "the variable of " + priorOver(arity(), state_->columns) + " has " +
                    std::to_string(point.dof()) + " degrees of freedom, the linearisation point has " +
                    std::to_string(replacement.dof()) + "; give a value of the variable's size");
  }
  std::vector<double> difference(at(replacement.dof()));  // NaN if a number is not finite
  replacement.store().boxminus(difference.data(), replacement.get(), replacement.get());
  if (!std::all_of(difference.begin(), difference.end(), [](double d) { return std::isfinite(d); })) {
    throw Error("slom.prior-not-finite",
                "the linearisation point of variable " + std::to_string(k) + " of " +
                    priorOver(arity(), state_->columns) + " is not finite; pass finite numbers",
                "linearizedAt");
  }
  replacement.swap(point);
}

GaussianPrior& GaussianPrior::withFirstEstimates(bool with) {
  state_->has_first_estimates = with;
  return *this;
}
bool GaussianPrior::hasFirstEstimates() const { return state_->has_first_estimates; }
const void* GaussianPrior::firstEstimate(int k) const { return hasFirstEstimates() ? point(k) : nullptr; }

GaussianPrior GaussianPrior::over(std::vector<AnyVarID> variables) const {
  if (variables.size() != at(arity())) {
    throw Error("slom.prior-size",
                priorOver(arity(), state_->columns) + " was given " +
                    counted(static_cast<int>(variables.size()), "other variable") +
                    "; pass one for each of its variables, in their order",
                "over");
  }
  for (int k = 0; k < arity(); ++k) {
    const VariableStoreBase &own = state_->points[at(k)].store(), *const other = variables[at(k)].store();
    if (other != nullptr && !own.hasTypeOf(*other)) {
      throw Error("slom.wrong-type",
                  "variable " + std::to_string(k) + " of " + priorOver(arity(), state_->columns) + " is a " +
                      own.typeName() + ", it was given a " + other->typeName() +
                      "; pass variables of the same types, in their order",
                  other->typeName());
    }
  }
  GaussianPrior prior(std::move(variables), R(), b());
  for (int k = 0; k < arity(); ++k) prior.setPoint(k, point(k));
  return prior.withFirstEstimates(hasFirstEstimates());
}

std::unique_ptr<RuntimeMeasurement> GaussianPrior::copyOver(std::vector<AnyVarID> variables) const {
  return std::make_unique<GaussianPrior>(over(std::move(variables)));
}

const void* GaussianPrior::point(int k) const { return state_->points[at(k)].get(); }
Map<const MatrixXd> GaussianPrior::R() const { return state_->matrix(); }
Map<const VectorXd> GaussianPrior::b() const { return {state_->b.data(), state_->rows()}; }

const RuntimeKind& GaussianPrior::kind() const {
  static constexpr RuntimeKind kind{&typeid(GaussianPrior), DerivativeSource::exact,
                                    [] { return std::string("GaussianPrior"); }, true};
  return kind;
}

int GaussianPrior::evaluate(int rows, double* r) const {
  const State& state = *state_;
  if (r == nullptr || rows != state.rows()) return state.rows();
  std::vector<double> difference(at(state.columns));
  double* next = difference.data();
  for (int k = 0; k < arity(); ++k) {
    const detail::StoredValue& point = state.points[at(k)];
    point.store().boxminus(next, views()[at(k)].pointer(), point.get());
    next += point.dof();
  }
  Map<VectorXd>(r, rows) = state.matrix() * Map<const VectorXd>(difference.data(), state.columns) + b();
  return rows;
}

int GaussianPrior::linearize(int rows, double* r, double* J) const {
  const State& state = *state_;
  if (evaluate(rows, r) != rows) return state.rows();
  std::vector<double> derivative;
  int column = 0;
  for (int k = 0; k < arity(); ++k) {
    const detail::StoredValue& point = state.points[at(k)];
    const int dof = point.dof();
    derivative.resize(at(dof) * at(dof));
    point.store().boxminusDerivative(views()[at(k)].pointer(), point.get(), derivative.data());
    Map<MatrixXd>(J + static_cast<std::ptrdiff_t>(rows) * column, rows, dof) =
        state.matrix().middleCols(column, dof) * Map<const MatrixXd>(derivative.data(), dof, dof);
    column += dof;
  }
  return rows;
}

}  // namespace slom
