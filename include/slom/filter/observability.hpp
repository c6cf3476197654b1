/// Observability along a run: the directions of the state at its start that the data do not determine.
///
///     slom::Observability run(filter, "");           // a copy of a filter
///     run.predict(motion, noise, ...);               // as of the filter
///     run.update(h, data, noise);
///     std::puts(run.sentence().c_str());             // `the data do not see 1 direction of the state: ...`
///
/// Let Phi be the product of the derivatives of the motions, and H the derivative of a measurement with covariance R.
/// The information of the data is
///   I = sum Phi^T H^T R^-1 H Phi
/// on the state at the start, if the motions have no noise. In units of the standard deviations at the start, a
/// direction with an eigenvalue below `threshold` is not seen: the information of the data is less than this fraction
/// of the prior.
///
/// Derivatives are taken at the means, also for an UnscentedFilter. Each update moves the mean, so a direction that no
/// measurement sees gets some information: with ranges to one beacon, 1e-4 of the best direction. So the sentence
/// names directions below 1e-3 of the best as hardly seen. To decide, pass data without noise, such as
/// slom::measured(h(run.filter().state())): then the means stay, and directions that are not seen are below the
/// threshold.
///   source  Maybeck, "Stochastic models, estimation, and control", 1979, section 1.7; Chen, "Local observability matrix
///           and its application to observability analyses", 1990
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "slom/filter/error_state_filter.hpp"

namespace slom {

/// A direction in the tangent space of the state at the start of a run, in units of its standard deviations.
struct StateDirection {
  std::vector<double> weights;  ///< of each component; the squares sum to 1
  double information = 0;       ///< of the data, 1: as much as the prior
  std::string text;  ///< components with the largest weights, such as `0.71 pose.pos.x - 0.71 offset`
};

template <class Filter>
class Observability {
 public:
  using S = typename Filter::scalar;
  static constexpr int N = Filter::DOF;
  using State = std::remove_cvref_t<decltype(std::declval<const Filter&>().state())>;

  /// Begins at the estimate of a filter. `name`: before the names of the components.
  explicit Observability(const Filter& filter, const std::string& name = "")
      : filter_(filter),
        names_(mtk::componentNames(filter.state(), name)),
        sigma_(filter.standardDeviations()) {}

  /// Returns the filter, with what was taken so far.
  const Filter& filter() const { return filter_; }
  /// Predicts as the filter does, and records the derivative.
  template <class... Args>
  PredictionResult predict(const Args&... args) {
    detail::SquareMatrix<S, N> derivative;
    const PredictionResult result = filter_.predictObserved([&](const auto& F) { derivative = F; }, args...);
    if (result) passed_ = detail::product(derivative, passed_);
    return result;
  }
  /// Updates as the filter does, and records the information of the measurement.
  template <class... Args>
  auto update(const Args&... args) {
    return filter_.updateObserved(
        [&](const auto&, const auto& H, const auto& noise) {
          const auto by_start = detail::product(H, passed_);
          constexpr int M = std::remove_const_t<decltype(by_start)>::RowsAtCompileTime;
          detail::SquareMatrix<S, M> W;  // R = W W^T
          noise.writeRoot(W, 0);
          detail::FixedMatrix<S, M, N> whitened = by_start;
          detail::solveLower<M>(W, whitened);
          information_ += detail::product(whitened.transpose(), whitened);
        },
        args...);
  }

  /// Returns the directions that the data do not see, least seen first.
  std::vector<StateDirection> unseen(double threshold = 1e-6) const {
    std::vector<StateDirection> directions = all();
    // Rounding errors of the largest eigenvalue look like information.
    const double limit = std::max(threshold, 1e-13 * directions.back().information);
    std::erase_if(directions, [&](const StateDirection& d) { return d.information >= limit; });
    return directions;
  }
  /// Returns the direction with the least information.
  StateDirection weakest() const { return all().front(); }
  /// Returns one sentence: the directions that are not seen, or else those that are hardly seen, or else the weakest one.
  std::string sentence(double threshold = 1e-6) const {
    std::vector<StateDirection> directions = unseen(threshold);
    if (!directions.empty()) return "the data do not see " + listOf(directions);
    directions = all();
    const double best = directions.back().information;
    const auto share = [&](const StateDirection& d) {
      char number[20];
      std::snprintf(number, sizeof number, "%.1g", d.information / best);
      return std::string(number);
    };
    if (N == 1 || directions.front().information > 1e-3 * best) {
      return "the data see all directions of the state; the weakest has " + share(directions.front()) +
             " of the information on the best: " + directions.front().text;
    }
    const std::string weakest = share(directions.front());
    std::erase_if(directions, [&](const StateDirection& d) { return d.information > 1e-3 * best; });
    return "the data hardly see " + listOf(directions) + "; the weakest has " + weakest +
           " of the information on the best, and moving estimates alone can cause this; try data without noise";
  }

 private:
  /// Returns all directions, least seen first.
  std::vector<StateDirection> all() const {
    Eigen::MatrixXd scaled(N, N);
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j)
        scaled(i, j) = double(information_(i, j)) * double(sigma_[i]) * double(sigma_[j]);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
    std::vector<StateDirection> directions;
    for (int k = 0; k < N; ++k) {
      const Eigen::VectorXd v = solver.eigenvectors().col(k);
      directions.push_back({{v.data(), v.data() + N}, std::max(0., solver.eigenvalues()[k]), textOf(v)});
    }
    return directions;
  }
  static std::string listOf(const std::vector<StateDirection>& directions) {
    std::string text = std::to_string(directions.size()) +
                       (directions.size() == 1 ? " direction of the state: " : " directions of the state: ");
    for (const StateDirection& d : directions) text += (&d == directions.data() ? "" : "; ") + d.text;
    return text;
  }
  std::string textOf(const Eigen::VectorXd& v) const {
    std::vector<int> order(std::size_t{N});
    for (int i = 0; i < N; ++i) order[std::size_t(i)] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return std::abs(v[a]) > std::abs(v[b]) + 1e-9; });
    std::string text;
    for (int i = 0; i < std::min(N, 4); ++i) {
      const int c = order[std::size_t(i)];
      if (std::abs(v[c]) < 0.1) break;
      const double weight = v[c] * (v[order[0]] < 0 ? -1 : 1);
      char number[40];
      std::snprintf(number, sizeof number, "%s%.2f ",
                    text.empty() ? ""
                    : weight < 0 ? " - "
                                 : " + ",
                    std::abs(weight));
      text += number + names_[std::size_t(c)];
    }
    return text;
  }

  Filter filter_;
  std::vector<std::string> names_;
  mtk::tangent_t<State> sigma_;
  detail::SquareMatrix<S, N> passed_ = detail::SquareMatrix<S, N>::Identity();
  detail::SquareMatrix<S, N> information_ = detail::SquareMatrix<S, N>::Zero();
};

}  // namespace slom
