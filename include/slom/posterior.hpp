/// The posterior of some variables without the measurements that it comes from. It shows what measurements would bring
/// before they are made.
///
///     auto [what_if, ids] = slom::posterior(est, tower, oak);
///     const auto [t, o] = ids;
///     what_if.insertMeasurement(slom::Range(), t, o, slom::measured((*t - *o).norm()), slom::StandardDeviation(0.01));
///     std::cout << est.standardDeviation(tower).transpose() << " would become " << what_if.standardDeviation(t).transpose();
///
/// Only functions, values and noise of such measurements matter, not their data; as data, pass what the function
/// predicts. The measurements may bring variables of their own, such as the pose of a further photograph. These count
/// as unknown unless they have a prior.
#pragma once

#include <tuple>
#include <vector>

#include <Eigen/Core>

#include "slom/estimator.hpp"
#include "slom/measurements/gaussian_prior.hpp"

namespace slom {

/// An estimator with copies of variables. A GaussianPrior with their joint covariance stands for all that is known of
/// them.
template <class... T>
struct Posterior {
  Estimator estimator;
  std::tuple<VarID<T>...> ids;
};

namespace detail {
/// Writes R (n x n, column-major) with R^T R = C^-1; rows and columns of components with variance 0 are 0.
void writeSquareRootInformation(const double* C, int n, double* R);
double halfLogOfDeterminants(const double* before, const double* after, int n);
[[noreturn]] void raiseOtherSizes(Eigen::Index before, Eigen::Index after);
}  // namespace detail

/// Returns the posterior of the variables. Components that are fixed in `est` are fixed. Throws as
/// Estimator::covariance does, and [slom.singular-covariance] if a combination of the variables has variance 0.
template <class... T>
Posterior<T...> posterior(const Estimator& est, const VarID<T>&... ids) {
  static_assert(sizeof...(T) > 0, "slom: pass the variables of the posterior after the estimator");
  const Eigen::MatrixXd C = est.jointCovariance(ids...);
  Eigen::MatrixXd R(C.rows(), C.cols());
  detail::writeSquareRootInformation(C.data(), static_cast<int>(C.rows()), R.data());

  Posterior<T...> result;
  Estimator& copy = result.estimator;
  int start = 0;
  const auto insert = [&](const auto& id) {
    const auto own = copy.insertRV(*est.own(id), est.nameOf(id));
    const std::vector<std::string> names = mtk::componentNames(*own);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const bool is_certain = !(C(start, start) > 0);
      if (is_certain && names[c].empty()) copy.fix(own);
      if (is_certain && !names[c].empty()) copy.fix(own, names[c]);
      ++start;
    }
    return own;
  };
  result.ids = std::tuple{insert(ids)...};
  std::apply([&](const auto&... own) { copy.insertMeasurement(GaussianPrior({own...}, R)); }, result.ids);
  return result;
}

/// Returns the information that measurements bring about variables whose covariance changes from `before` to `after`:
/// half the logarithm of the ratio of the determinants [nats]. Components with variance 0 in both matrices do not
/// count. If all directions matter alike, the measurements with the largest gain are the best ones (D-optimality).
/// Throws [slom.singular-covariance], and [slom.other-sizes] if the matrices differ in size.
///   source   Lindley, "On a measure of the information provided by an experiment", 1956
inline double informationGain(const Eigen::MatrixXd& before, const Eigen::MatrixXd& after) {
  if (before.rows() != after.rows() || before.cols() != after.cols() || before.rows() != before.cols())
    detail::raiseOtherSizes(before.rows(), after.rows());
  return detail::halfLogOfDeterminants(before.data(), after.data(), static_cast<int>(before.rows()));
}

}  // namespace slom
