/// Uncertainty of the estimated values: covariances of all variables at once, and of functions of variables.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/problem/problem.hpp"

namespace slom {

class LinearizedProblem;

/// Meaning of the stated uncertainties of the measurements for the covariances of the variables.
enum class Sigma {
  known,      ///< the stated uncertainties are right: covariances follow from them alone
  estimated,  ///< only their ratios are right: covariances are multiplied by RSS / redundancy
};

/// Covariances if the measurements leave a rigid motion or the scale of all variables free.
enum class FreeGauge {
  error,  ///< none: covariance throws [slom.free-gauge], which names the free motions
  /// Covariances of the free network: the pseudo-inverse of J^T J, which has the smallest trace of all choices
  /// (Baarda, "S-transformations and criterion matrices", 1973), in the units of the unknowns. With every algorithm,
  /// optimize() then ends at the best values nearest to the start values: N^T (x [-] start) = 0, with the free
  /// directions as columns of N.
  inner_constraints,
};

namespace detail {
/// Returns the square roots of the diagonal of C. Loops, here and below, compile faster than expressions.
inline Eigen::VectorXd deviations(const Eigen::MatrixXd& C) {
  Eigen::VectorXd result(C.rows());
  for (Eigen::Index i = 0; i < C.rows(); ++i) result[i] = std::sqrt(C(i, i));
  return result;
}
/// Computes out := J C J^T for J m x n, all column-major.
void propagate(const double* J, const double* C, int m, int n, double* out);
/// Throws [slom.wrong-length] unless C is n x n.
void requireCovarianceSize(Eigen::Index rows, Eigen::Index columns, int n);
}  // namespace detail

/// Marginal covariances of all variables, at the values at which they were computed. Later insertions and removals do
/// not affect them.
class Marginals {
 public:
  /// Returns the covariance in the tangent space, dof x dof; 0 for a fixed variable. Throws [slom.stale-marginals] for
  /// a variable that did not exist when the covariances were computed.
  Eigen::MatrixXd covariance(const VariableHandle& id) const {
    const Place& place = placeOf(id);
    Eigen::MatrixXd result(place.dof, place.dof);
    for (int i = 0; i < place.dof * place.dof; ++i) {
      result.data()[i] = place.start == kFixed ? 0 : numbers_[place.start + static_cast<std::size_t>(i)];
    }
    return result;
  }
  /// Returns the standard deviation of each component.
  Eigen::VectorXd standardDeviation(const VariableHandle& id) const {
    return detail::deviations(covariance(id));
  }

 private:
  friend Marginals makeMarginals(const Problem& problem,
                                 const std::function<bool(int variable, double* block)>& write,
                                 double variance_factor);
  static constexpr std::size_t kFixed = ~std::size_t{0};
  struct Place {
    std::size_t store = 0;  // in stores_
    SlotRef ref;
    std::size_t start = kFixed;
    int dof = 0;
  };
  const Place& placeOf(const VariableHandle& id) const;

  std::vector<std::shared_ptr<const VariableStoreBase>> stores_;
  std::vector<Place> places_;  // by store and slot
  std::vector<double> numbers_;
};

/// A quantity computed from variables, and its covariance (for a manifold, in its tangent space).
template <class V>
struct Propagated {
  V value;
  Eigen::MatrixXd covariance;

  /// Returns the standard deviation of each component.
  Eigen::VectorXd standardDeviation() const { return detail::deviations(covariance); }
};

}  // namespace slom
