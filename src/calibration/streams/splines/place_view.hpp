// SplineProblem::place, for both kinds of views.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "calibration/streams/splines/problem.hpp"

namespace slom::calibration {

/// Returns the derivatives of a measurement by the variables that are estimated, side by side.
template <class Measurement, class... T>
Eigen::MatrixXd jacobianOf(const Measurement& measurement, const std::vector<bool>& is_estimated,
                           const VarID<T>&... ids) {
  std::array<Eigen::MatrixXd, sizeof...(T)> blocks;
  blocks.fill(Eigen::MatrixXd(6, 6));
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    measurement.jacobian(*ids..., blocks[I]...);
  }(std::index_sequence_for<T...>());
  Eigen::MatrixXd J(6, 0);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (!is_estimated[i]) continue;
    J.conservativeResize(Eigen::NoChange, J.cols() + blocks[i].cols());
    J.rightCols(blocks[i].cols()) = blocks[i];
  }
  return J;
}

template <class Measurement, class... T>
void SplineProblem::place(const Measurement& measurement, std::size_t stretch, std::size_t first_control,
                          const Group& time, const std::pair<VarID<T>, bool>&... others) {
  const auto controls = splines_[stretch].controls().begin() + std::ptrdiff_t(first_control);
  const auto insert = [&](const auto&... ids) {
    views_.push_back(est_.insertMeasurement(measurement, ids..., StandardDeviation(start_.sigma_px), time,
                                            named("corners")));
    PlacedView view;
    std::vector<bool> is_estimated(pose_order, true);
    (is_estimated.push_back(others.second), ...);
    std::size_t next = 0;
    ((is_estimated[next++] ? view.variables.push_back(ids) : void()), ...);
    view.jacobian = [measurement, is_estimated, ids...] {
      return jacobianOf(measurement, is_estimated, ids...);
    };
    views_on_splines_.push_back(std::move(view));
  };
  [&]<std::size_t... K>(std::index_sequence<K...>) {
    insert(controls[K]..., others.first...);
  }(std::make_index_sequence<pose_order>());
}

}  // namespace slom::calibration
