#include "calibration/quality/patterns/split_half.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "calibration/cross_matrix.hpp"
#include "calibration/data/check.hpp"
#include "calibration/data/fitted_board.hpp"
#include "calibration/fit/model_fit.hpp"
#include "calibration/limits.hpp"
#include "calibration/quality/uncertainty/clustered.hpp"
#include "calibration/quality/uncertainty/projection.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// One half: its calibration and its posterior.
struct Half {
  Half(const Result& result, const Dataset& data)
      : rig(result), posterior(posteriorOf(*DataOnBoard(data, result.board), rig)) {}

  static Posterior posteriorOf(const Dataset& data, const FittedRig& rig) {
    Information sum(rig.columns);
    for (const auto& [image, observation] : observationsOf(data, rig))
      sum.add(informationOf(rig, observation));
    sum.addPrior(rig);
    return statedPosterior(data, rig, sum);
  }

  FittedRig rig;
  Posterior posterior;
};

/// A node for which both halves have a ray.
struct Compared {
  int node;
  vec3 ray;  ///< ray according to the first half
  vec2 difference;
  Lens::PointProjection at;  ///< in the second half
  double weight;
};

Eigen::Matrix<double, 2, 3> byRotation(const Lens::PointProjection& q, const vec3& ray) {
  return -q.by_point * crossMatrix(ray);
}

/// Turns the first half's rays so that the second half projects them as near to the nodes as possible.
void fitRotation(std::vector<Compared>& nodes, const Lens& second, const ImageGrid& grid) {
  constexpr int steps = 5;
  constexpr double no_turn = 1e-13;
  for (int step = 0; step < steps; ++step) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const Compared& c : nodes) {
      const Eigen::Matrix<double, 2, 3> J = byRotation(c.at, c.ray);
      H += c.weight * J.transpose() * J;
      g += c.weight * J.transpose() * c.difference;
    }
    const vec3 angle(-H.ldlt().solve(g));
    const SO3 turn = SO3::exp(angle);
    for (Compared& c : nodes) {
      c.ray = turn * c.ray;
      c.at = second.differentiate(c.ray);
      c.difference = vec2(c.at.pixel - grid.node(c.node));
    }
    if (angle.norm() < no_turn) break;
  }
}

/// Returns the mean over the nodes of the variance of the difference after fitting the rotation, if the difference
/// comes from lens parameters with this covariance [px^2].
double expectedSquare(const std::vector<Compared>& nodes, const Lens& second,
                      const Eigen::MatrixXd& covariance) {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(3, covariance.cols());
  Eigen::MatrixXd J(2 * Eigen::Index(nodes.size()), covariance.cols());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Compared& c = nodes[i];
    const Eigen::Matrix<double, 2, 3> by_rotation = byRotation(c.at, c.ray);
    const auto by_parameters = second.differentiate(c.ray).by_parameters;
    H += c.weight * by_rotation.transpose() * by_rotation;
    g += (c.weight * by_rotation.transpose()).lazyProduct(by_parameters);
    J.middleRows<2>(2 * Eigen::Index(i)) = by_parameters;
  }
  const Eigen::MatrixXd turn = H.ldlt().solve(g);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    J.middleRows<2>(2 * Eigen::Index(i)) -= byRotation(nodes[i].at, nodes[i].ray).lazyProduct(turn);
  const double sum = (J * covariance).cwiseProduct(J).sum();
  return sum / double(nodes.size());
}

/// Compares the difference of the estimated lens parameters with its covariance.
void compareParameters(const CameraResult& a, const CameraResult& b, const Eigen::MatrixXd& covariance,
                       SplitHalfCamera& result) {
  std::vector<int> free;
  for (int i = 0; i < covariance.rows(); ++i) {
    if (covariance(i, i) > 0) free.push_back(i);
  }
  Eigen::VectorXd difference(Eigen::Index(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) {
    const auto p = std::size_t(free[i]);
    difference[Eigen::Index(i)] = a.parameters[p].value - b.parameters[p].value;
  }
  const Eigen::MatrixXd C = covariance(free, free);
  const Eigen::VectorXd scale = C.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::VectorXd z = scale.asDiagonal() * difference;
  const Eigen::MatrixXd scaled = scale.asDiagonal() * C * scale.asDiagonal();
  result.chi2 = z.dot(scaled.ldlt().solve(z));
  result.dof = int(free.size());
  result.probability = result.dof > 0 ? chiSquareProbability(result.chi2, result.dof) : 1;
}

/// Returns the mean of the clustered and the stated covariance, with the stated one scaled to the same size. The
/// clustered one alone, from few blocks of images, has directions without variance.
Eigen::MatrixXd wellConditioned(const ClusteredUncertainty& clustered, const Eigen::MatrixXd& stated) {
  return (covarianceOf(clustered) + clustered.ratio * clustered.ratio * stated) / 2;
}

SplitHalfCamera compare(const Half& a, const Half& b, std::size_t c, const ImageGrid& grid,
                        const Eigen::MatrixXd& covariance) {
  const Lens& first = a.rig.lenses[c];
  const Lens& second = b.rig.lenses[c];
  const auto rays = raysOf(first, grid), others = raysOf(second, grid);
  const auto stds = CameraPosterior(a.rig, a.posterior, c).stdOfRays(rays),
             other_stds = CameraPosterior(b.rig, b.posterior, c).stdOfRays(others);
  std::vector<Compared> nodes;
  auto std = stds.begin(), other_std = other_stds.begin();
  for (int i = 0; i < grid.size(); ++i) {
    const auto k = std::size_t(i);
    const double variance = (rays[k] ? std::pow(*std++, 2) : 0) + (others[k] ? std::pow(*other_std++, 2) : 0);
    if (!rays[k] || !others[k]) continue;
    const Lens::PointProjection at = second.differentiate(*rays[k]);
    // A poorly determined lens projects some rays nowhere, or with infinite uncertainty.
    if (!at.pixel.allFinite() || !at.by_point.allFinite() || !(variance > 0) || !std::isfinite(variance))
      continue;
    nodes.push_back({i, *rays[k], vec2(at.pixel - grid.node(i)), at, 1 / variance});
  }
  SplitHalfCamera result;
  result.difference_px.assign(std::size_t(grid.size()), unknown);
  if (nodes.size() < 3) return result;
  fitRotation(nodes, second, grid);
  double sum = 0;
  for (const Compared& node : nodes) {
    const double error = node.difference.norm();
    result.difference_px[std::size_t(node.node)] = error;
    result.largest_px = std::max(result.largest_px, error);
    sum += error * error;
  }
  result.rms_px = std::sqrt(sum / double(nodes.size()));
  result.expected_rms_px = std::sqrt(expectedSquare(nodes, second, covariance));
  return result;
}

}  // namespace

Dataset halfOf(const Dataset& data, int half) {
  const std::vector<int> images = data.images();
  return data.withImages([&](int image) {
    return (std::lower_bound(images.begin(), images.end(), image) - images.begin()) % 2 == half;
  });
}

SplitHalf splitHalf(const Dataset& data, const Settings& settings, const Result& fit,
                    const std::vector<ImageGrid>& grids) {
  constexpr std::size_t fewest_images = 2;
  Settings with_known_readout = settings;
  with_known_readout.rolling_shutter = false;  // which the data no longer show
  SplitHalf result;
  std::vector<Result> results;
  std::vector<std::unique_ptr<Half>> halves;
  for (int half = 0; half < 2; ++half) {
    const Dataset part = halfOf(data, half);
    const std::string which = half == 0 ? "first" : "second";
    for (const CameraData& camera : part.cameras) {
      if (camera.views.size() >= fewest_images) continue;
      result.why_not =
          fmt::format("the {} half has fewer than {} images of camera {}", which, fewest_images, camera.name);
      return result;
    }
    try {
      checkConnected(part);
      results.push_back(calibrateModelFrom(fit, part, with_known_readout));
      addClustered(part, results.back());
    } catch (const DataError&) {
      result.why_not = fmt::format("the {} half of the images does not determine a calibration", which);
      return result;
    }
    requireTime(settings.limits);
    if (!results.back().success()) {
      result.why_not = fmt::format("the {} half of the images does not determine a calibration", which);
      return result;
    }
    halves.push_back(std::make_unique<Half>(results.back(), part));
  }
  const bool is_clustered = std::all_of(results.begin(), results.end(), [](const Result& half) {
    return half.clustered && half.clustered->isReliable();
  });
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    const int n = halves[0]->rig.lenses[c].parameters(), first = halves[0]->rig.columns.lens[c];
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
    for (std::size_t h = 0; h < halves.size(); ++h) {
      const Eigen::MatrixXd stated = halves[h]->posterior.covarianceOfShared();
      covariance +=
          (is_clustered ? wellConditioned(*results[h].clustered, stated) : stated).block(first, first, n, n);
    }
    result.cameras.push_back(compare(*halves[0], *halves[1], c, grids[c], covariance));
    compareParameters(results[0].cameras[c], results[1].cameras[c], covariance, result.cameras.back());
  }
  return result;
}

}  // namespace slom::calibration
