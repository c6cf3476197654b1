/// How sure the estimated values are, as a user gets it: covariances of all variables at once, and of what is computed
/// from variables.
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/problem/problem.hpp"

namespace slom {

class LinearizedProblem;

/// What the stated uncertainties of the measurements mean for the covariances of the variables.
enum class Sigma {
  known,      ///< they are right: covariances follow from them alone
  estimated,  ///< only their ratios are: covariances are multiplied by RSS / redundancy
};

/// What covariances are when the measurements leave a rigid motion or a scale of everything free.
enum class FreeGauge {
  error,  ///< none: covariance throws [slom.free-gauge] with the motions that are free
  inner_constraints,  ///< those of the free network: the pseudo-inverse of J^T J, whose trace is the smallest of all choices
  ///< (Baarda, "S-transformations and criterion matrices", 1973), in the units of the unknowns. optimize() then ends, by whatever algorithm, at those
  ///< of the best values that are nearest to the start values: N^T (x [-] start) = 0, with the free directions N
};

/// A confidence interval of a coordinate.
struct ProfileInterval {
  double value, lower, upper;
};

/// `39.99 in [39.97, 40.01]`
std::ostream& operator<<(std::ostream& os, const ProfileInterval& interval);

namespace detail {
/// The roots of the diagonal of C. Loops instead of expressions here and below: they cost less time of every compilation.
inline Eigen::VectorXd deviations(const Eigen::MatrixXd& C) {
  Eigen::VectorXd result(C.rows());
  for (Eigen::Index i = 0; i < C.rows(); ++i) result[i] = std::sqrt(C(i, i));
  return result;
}
/// out := J C J^T for J m x n, all column-major.
void propagate(const double* J, const double* C, int m, int n, double* out);
/// Throws [slom.wrong-length] unless C is n x n.
void requireCovarianceSize(Eigen::Index rows, Eigen::Index columns, int n);
}  // namespace detail

/// Covariances of all variables, each by itself, at the values at which they were computed. It answers for the variables that
/// there were then, whatever has been inserted or removed since.
class Marginals {
 public:
  /// dof x dof, in the tangent space; 0 for a fixed variable. Throws [slom.stale-marginals] for a variable that was
  /// not there when they were computed.
  template <class T>
  Eigen::MatrixXd covariance(const VarID<T>& id) const {
    const Place& place = placeOf(id, &typeName<T>);
    Eigen::MatrixXd result(place.dof, place.dof);
    for (int i = 0; i < place.dof * place.dof; ++i) {
      result.data()[i] = place.start == kFixed ? 0 : numbers_[place.start + static_cast<std::size_t>(i)];
    }
    return result;
  }
  /// The standard deviation of each component.
  template <class T>
  Eigen::VectorXd standardDeviation(const VarID<T>& id) const {
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
  const Place& placeOf(const VariableHandle& id, std::string (*type)()) const;

  std::vector<std::shared_ptr<const VariableStoreBase>> stores_;
  std::vector<Place> places_;  // by store and slot
  std::vector<double> numbers_;
};

/// A quantity that was computed from variables, and its covariance (in its tangent space when it is a manifold).
template <class V>
struct Propagated {
  V value;
  Eigen::MatrixXd covariance;

  /// The standard deviation of each component.
  Eigen::VectorXd standardDeviation() const { return detail::deviations(covariance); }
};

}  // namespace slom
