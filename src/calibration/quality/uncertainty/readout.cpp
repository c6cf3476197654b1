#include "calibration/quality/uncertainty/readout.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/fit/corner_noise.hpp"
#include "calibration/median.hpp"
#include "calibration/quality/patterns/flip_test.hpp"
#include "calibration/quality/patterns/residuals.hpp"
#include "calibration/quality/uncertainty/information.hpp"
#include "calibration/quality/uncertainty/uncertainties.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t most_blocks_of_readout = 12;

/// How the corners of all views of a camera move from one image number to the next, by the poses of the images before and after, where these are not
/// much farther away than usual [px]; NaN: unknown. Corners as they were found would bring their noise along, which no pose takes up.
std::vector<std::vector<Eigen::Vector2d>> motionsByPoses(const CameraData& camera, const CameraResult& fitted,
                                                         const Result& result) {
  std::map<int, SE3> world2camera;
  std::vector<double> gaps;
  for (const ImageResult& image : result.images) {
    if (!world2camera.empty()) gaps.push_back(image.image - world2camera.rbegin()->first);
    world2camera.emplace(image.image, fitted.left2camera * image.left2world.inverse());
  }
  const double most = 2 * medianOf(gaps);
  std::vector<std::vector<Eigen::Vector2d>> motions;
  for (const View& view : camera.views) {
    motions.emplace_back();
    const auto here = world2camera.find(view.image);
    if (here == world2camera.end()) {
      motions.back().assign(view.corners.size(), Eigen::Vector2d::Constant(unknown));
      continue;
    }
    const bool has_before = here != world2camera.begin() && here->first - std::prev(here)->first <= most;
    const bool has_after =
        std::next(here) != world2camera.end() && std::next(here)->first - here->first <= most;
    const auto first = has_before ? std::prev(here) : here, last = has_after ? std::next(here) : here;
    for (const Corner& corner : view.corners) {
      const auto at = [&](const SE3& pose) {
        return Eigen::Vector2d(fitted.project(vec3(pose * corner.world)));
      };
      motions.back().push_back((at(last->second) - at(first->second)) / double(last->first - first->first));
    }
  }
  return motions;
}

/// One camera's step, with the covariance of the shared parameters.
std::optional<ReadoutStep> stepOf(const Dataset& on_board, const Result& result, const FittedRig& rig,
                                  const std::map<int, Observation>& observations,
                                  const Eigen::MatrixXd& covariance, std::size_t c) {
  const CameraData& camera = on_board.cameras[c];
  const double height = imageBoxOf(camera, result.cameras[c]).height;
  const auto motions = motionsByPoses(camera, result.cameras[c], result);
  const std::size_t views = camera.views.size(), blocks = std::min(most_blocks_of_readout, views);
  const int shared = rig.columns.size;
  PatternScores scores(1, 1, int(blocks), shared);
  Eigen::MatrixXd of_shared = Eigen::MatrixXd::Zero(shared, Eigen::Index(blocks));
  Eigen::VectorXd cross = Eigen::VectorXd::Zero(shared);
  Eigen::Matrix<double, Eigen::Dynamic, 2> by_shared(shared, 2);
  bool is_known = false;
  for (std::size_t i = 0; i < views; ++i) {
    const View& view = camera.views[i];
    const int block = int(i * blocks / views);
    const SeenBoard board(rig, c, rig.left2world.at(view.image));
    const ImageEquations equations = equationsOf(rig, observations.at(view.image));
    for (std::size_t k = 0; k < view.corners.size(); ++k) {
      const Corner& corner = view.corners[k];
      const double sigma = rig.sigma_px * corner.sigma, weight = 1 / (sigma * sigma);
      const SeenBoard::Rows rows = board.rowsOf(corner.world);
      board.setByShared(rows, equations.pose_by_shared, by_shared);
      const Eigen::Vector2d e = corner.pixel - rows.pixel();
      of_shared.col(block) += by_shared * (weight * e);
      const Eigen::Vector2d& motion = motions[i][k];
      if (!motion.allFinite()) continue;
      is_known = true;
      const PatternRows<1> F = corner.pixel.y() / height * motion;
      scores.add<1>(0, block, weight, e, F, rows.by_pose, by_shared);
      cross += weight * (by_shared * F);
    }
    scores.endView(equations.pose_inverse);
  }
  if (!is_known) return std::nullopt;
  scores.finish(covariance, of_shared);
  const double variance = scores.covariance(0)(0, 0);
  if (!(variance > 0)) return std::nullopt;
  const Eigen::RowVectorXd by_block = scores.estimates(0).row(0);
  const double count = double(blocks), mean = by_block.mean();
  return ReadoutStep{by_block.sum(), std::sqrt(variance),
                     std::sqrt(count / std::max(1.0, count - 1) * (by_block.array() - mean).square().sum()),
                     FlipTest(scores.products()).probability(), -covariance * cross};
}

}  // namespace

bool ReadoutTrial::isFound() const {
  constexpr double by_chance = 0.005, clear = 3;
  return probability <= by_chance && std::abs(readout.value) > clear * readout.std_clustered;
}

std::vector<std::optional<ReadoutTrial>> compareReadout(const Dataset& all, const Result& result) {
  std::vector<std::optional<ReadoutTrial>> trials;
  if (!result.success()) return trials;
  const Dataset data = withoutRejected(all, result);
  const SortedDataset sorted(data);
  for (const std::optional<ReadoutStep>& step : readoutSteps(asFitted(result, *sorted), result)) {
    trials.emplace_back();
    if (step) trials.back() = {{step->value, step->std, step->std_clustered}, step->probability};
  }
  return trials;
}

Dataset withoutReadout(const Dataset& data, const Result& result) {
  Dataset still = data;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    if (!result.cameras[c].readout) continue;
    const double height = imageBoxOf(data.cameras[c], result.cameras[c]).height;
    const auto motions = motionsByPoses(data.cameras[c], result.cameras[c], result);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      for (std::size_t k = 0; k < motions[i].size(); ++k) {
        const Eigen::Vector2d& motion = motions[i][k];
        Corner& corner = still.cameras[c].views[i].corners[k];
        if (motion.allFinite())
          corner.pixel -= result.cameras[c].readout->value * corner.pixel.y() / height * motion;
      }
    }
  }
  return still;
}

Dataset asFitted(const Result& result, const Dataset& data) {
  return withNoiseOf(result, withoutReadout(data, result));
}

std::vector<std::optional<ReadoutStep>> readoutSteps(const Dataset& data, const Result& result) {
  const DataOnBoard on_board(data, result.board);
  const FittedRig rig(result);
  const std::map<int, Observation> observations = observationsOf(*on_board, rig);
  const Eigen::MatrixXd covariance = WhitenedScores(*on_board, rig).statedCovariance();
  std::vector<std::optional<ReadoutStep>> steps;
  for (std::size_t c = 0; c < data.cameras.size(); ++c)
    steps.push_back(stepOf(*on_board, result, rig, observations, covariance, c));
  return steps;
}

void addUncertaintyOf(const std::vector<std::optional<ReadoutStep>>& steps, Result& result) {
  const FittedRig rig(result);
  for (const std::optional<ReadoutStep>& step : steps) {
    if (step) addIndependentError(step->followed, step->std, step->std_clustered, rig.columns, result);
  }
}

}  // namespace slom::calibration
