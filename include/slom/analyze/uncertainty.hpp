/// How sure the estimated values are, as a user gets it: covariances of all variables at once, and of what is computed
/// from variables.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "slom/problem/problem.hpp"

namespace slom {

/// What the stated uncertainties of the measurements mean for the covariances of the variables.
enum class Sigma {
  known,      ///< they are right: covariances follow from them alone
  estimated,  ///< only their ratios are: covariances are multiplied by RSS / redundancy
};

/// What covariances are when the measurements leave a rigid motion or a scale of everything free.
enum class FreeGauge {
  error,              ///< none: covariance throws [slom.free-gauge] with the motions that are free
  inner_constraints,  ///< those of the free network: the pseudo-inverse of J^T J, whose trace is the smallest of all choices
                      ///< (Baarda, "S-transformations and criterion matrices", 1973), in the units of the unknowns
};

/// A confidence interval of a coordinate.
struct ProfileInterval {
  double value, lower, upper;
};

/// Covariances of all variables, each by itself, at the values at which they were computed.
class Marginals {
 public:
  /// dof x dof, in the tangent space; 0 for a fixed variable.
  template <class T>
  Eigen::MatrixXd covariance(const VarID<T>& id) const {
    const Place& place = places_[static_cast<std::size_t>(problem_->indexOf(id))];
    if (place.start == kFixed) return Eigen::MatrixXd::Zero(place.dof, place.dof);
    return Eigen::Map<const Eigen::MatrixXd>(numbers_.data() + place.start, place.dof, place.dof);
  }
  /// Of each component.
  template <class T>
  Eigen::VectorXd standardDeviation(const VarID<T>& id) const {
    return covariance(id).diagonal().cwiseSqrt();
  }

 private:
  friend class Estimator;
  static constexpr std::size_t kFixed = ~std::size_t{0};
  struct Place {
    std::size_t start = kFixed;
    int dof = 0;
  };
  const Problem* problem_ = nullptr;
  std::vector<Place> places_;  // by table index
  std::vector<double> numbers_;
};

/// A quantity that was computed from variables, and its covariance (in its tangent space when it is a manifold).
template <class V>
struct Propagated {
  V value;
  Eigen::MatrixXd covariance;

  /// Of each component.
  Eigen::VectorXd standardDeviation() const { return covariance.diagonal().cwiseSqrt(); }
};

}  // namespace slom
