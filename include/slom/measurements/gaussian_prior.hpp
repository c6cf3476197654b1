/// GaussianPrior: a Gaussian over any set of variables, in square-root information form.
///
///     est.insertMeasurement(slom::GaussianPrior({pose, scale, landmark}, R));
///
///   variables  x_k   n of them, of any types; the list may contain a variable twice
///   matrix     R     rows x (sum of the degrees of freedom), any number of rows, of any rank; R^T R is the information
///   point      x0_k  linearisation point: the current values at construction, or linearizedAt(x_k, value)
///   offset     b     one number for each row; 0 if not given
///   residual   R (x_1 [-] x0_1, ..., x_n [-] x0_n) + b, in units of its standard deviation
/// Derivatives are exact: R times the derivatives of x [-] x0, which are the identity for vectors and inverse right
/// Jacobians for rotations. The library uses differences only for parts of user-defined types whose [-] it cannot
/// differentiate.
#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "slom/model/pimpl.hpp"
#include "slom/model/runtime_measurement.hpp"

namespace slom {

class StoredPrior;

/// The measurement; its residual is above.
class GaussianPrior final : public RuntimeMeasurement {
 public:
  /// Creates the prior. Throws [slom.no-variables], [slom.stale-handle], [slom.prior-size] or [slom.prior-not-finite].
  GaussianPrior(std::vector<AnyVarID> variables, const Eigen::MatrixXd& R)
      : GaussianPrior(std::move(variables), R.data(), {R.rows(), R.cols()}, nullptr, R.rows()) {}
  GaussianPrior(std::vector<AnyVarID> variables, const Eigen::MatrixXd& R, const Eigen::VectorXd& b)
      : GaussianPrior(std::move(variables), R.data(), {R.rows(), R.cols()}, b.data(), b.size()) {}
  GaussianPrior(const GaussianPrior&);
  GaussianPrior(GaussianPrior&&) noexcept;
  GaussianPrior& operator=(const GaussianPrior&);
  GaussianPrior& operator=(GaussianPrior&&) noexcept;
  ~GaussianPrior() override;

  /// Sets the linearisation point of a variable to `value`. Throws [slom.not-in-list] if the prior does not have the
  /// variable, [slom.size-change] if the value and the variable differ in degrees of freedom, and
  /// [slom.prior-not-finite] if the value is not finite.
  template <class T>
  GaussianPrior& linearizedAt(const VarID<T>& id, const std::type_identity_t<T>& value) {
    setPoint(id, &value);
    return *this;
  }

  /// Sets whether the linearisation points are first estimates of the variables. If so, while the prior is inserted,
  /// the Jacobians of all measurements of these variables are taken at these points. Residuals are still taken at the
  /// current values (docs/windows.md).
  GaussianPrior& withFirstEstimates(bool with = true);
  /// Returns the value set by withFirstEstimates.
  bool hasFirstEstimates() const;
  /// Returns this prior, with the same linearisation points, over other variables of the same types, for example of
  /// another estimator. Throws [slom.prior-size] or [slom.wrong-type].
  GaussianPrior over(std::vector<AnyVarID> variables) const;

  /// Returns the square root of the information: rows x (sum of the degrees of freedom).
  Eigen::Map<const Eigen::MatrixXd> R() const;
  /// Returns the offset: one entry for each row of R.
  Eigen::Map<const Eigen::VectorXd> b() const;

  const RuntimeKind& kind() const override;
  int evaluate(int rows, double* r) const override;
  int linearize(int rows, double* r, double* J) const override;
  const void* firstEstimate(int k) const override;
  std::unique_ptr<RuntimeMeasurement> copyOver(std::vector<AnyVarID> variables) const override;

 private:
  friend class MarginalPrior;
  friend class StoredPrior;
  struct Size {
    Eigen::Index rows, columns;
  };
  GaussianPrior(std::vector<AnyVarID> variables, const double* R, Size size, const double* b,
                Eigen::Index length);
  void setPoint(const AnyVarID& id, const void* value);
  /// Sets the linearisation point of variable k, as a value of its type.
  void setPoint(int k, const void* value);
  const void* point(int k) const;

  struct State;
  detail::Pimpl<State> state_;
};

}  // namespace slom
