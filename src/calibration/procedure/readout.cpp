#include "calibration/procedure/readout.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/image_box.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/median.hpp"
#include "calibration/quality/patterns/flip_test.hpp"
#include "calibration/quality/patterns/residuals.hpp"
#include "calibration/quality/uncertainty/information.hpp"
#include "calibration/quality/uncertainty/uncertainties.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t most_blocks_of_readout = 12;

/// Returns one camera's step, given the covariance of the shared parameters.
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
