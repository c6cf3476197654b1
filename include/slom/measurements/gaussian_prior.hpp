/// A Gaussian over any set of variables, in square-root information form.
///
///     est.insertMeasurement(slom::GaussianPrior({pose, scale, landmark}, R));
///
///   variables  x_k   n of them, of any types; in the list a variable may be twice
///   matrix     R     rows x (sum of the degrees of freedom), any number of rows, of any rank; R^T R is the information
///   point      x0_k  linearisation point: the current values at construction, or linearizedAt(x_k, value)
///   offset     b     one number for each row; 0 without one
///   residual   R (x_1 [-] x0_1, ..., x_n [-] x0_n) + b, in units of its standard deviation
/// Derivatives are exact: R times those of x [-] x0, which are the identity for vectors and inverse right Jacobians for rotations.
/// Only parts of a user's own type, whose [-] the library cannot differentiate, take differences.
#pragma once

#include <memory>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "slom/model/pimpl.hpp"
#include "slom/model/runtime_measurement.hpp"

namespace slom {

class StoredPrior;

/// The measurement; see above for its residual.
class GaussianPrior final : public RuntimeMeasurement {
 public:
  /// Throws [slom.no-variables], [slom.stale-handle], [slom.prior-size] or [slom.prior-not-finite].
  GaussianPrior(std::vector<AnyVarID> variables, const Eigen::MatrixXd& R)
      : GaussianPrior(std::move(variables), R.data(), {R.rows(), R.cols()}, nullptr, R.rows()) {}
  GaussianPrior(std::vector<AnyVarID> variables, const Eigen::MatrixXd& R, const Eigen::VectorXd& b)
      : GaussianPrior(std::move(variables), R.data(), {R.rows(), R.cols()}, b.data(), b.size()) {}
  GaussianPrior(const GaussianPrior&);
  GaussianPrior(GaussianPrior&&) noexcept;
  GaussianPrior& operator=(const GaussianPrior&);
  GaussianPrior& operator=(GaussianPrior&&) noexcept;
  ~GaussianPrior() override;

  /// Takes `value` for the linearisation point of this variable. Throws [slom.not-in-list] for a variable that the prior does not
  /// have, [slom.size-change] for a value with other degrees of freedom than the variable, [slom.prior-not-finite] for one that is
  /// not finite.
  template <class T>
  GaussianPrior& linearizedAt(const VarID<T>& id, const std::type_identity_t<T>& value) {
    setPoint(id, &value);
    return *this;
  }

  /// Whether the linearisation points are first estimates of the variables: while the prior is inserted, the Jacobians of all measurements
  /// of these variables are taken there, and residuals at the current values (docs/online.md, windows).
  GaussianPrior& withFirstEstimates(bool with = true);
  /// What withFirstEstimates has set.
  bool hasFirstEstimates() const;
  /// The same prior, linearised at the same points, over other variables of the same types, as of another estimator. Throws
  /// [slom.prior-size] or [slom.wrong-type].
  GaussianPrior over(std::vector<AnyVarID> variables) const;

  /// The square root of the information: rows x (sum of the degrees of freedom).
  Eigen::Map<const Eigen::MatrixXd> R() const;
  /// The offset: an entry for each row of R.
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
  /// The point of linearisation of variable k, as a value of its type.
  void setPoint(int k, const void* value);
  const void* point(int k) const;

  struct State;
  detail::Pimpl<State> state_;
};

}  // namespace slom
