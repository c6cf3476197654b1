#include "slom/calibration/readout.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/quality/patterns/flip_test.hpp"
#include "calibration/quality/uncertainty/information.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"

namespace slom::calibration {
namespace {

constexpr std::size_t most_blocks_of_readout = 12;

/// Returns the readout that the residuals of one camera suggest to first order, with poses and all shared parameters
/// free; nothing if its corners are not known to move. `covariance`: of the shared parameters.
std::optional<ReadoutTrial> trialOf(const Dataset& on_board, const FittedRig& rig,
                                    const std::map<int, Observation>& observations,
                                    const Eigen::MatrixXd& covariance, std::size_t c) {
  const std::vector<View>& views = on_board.cameras[c].views;
  const std::size_t blocks = std::min(most_blocks_of_readout, views.size());
  const int shared = rig.columns.size;
  PatternScores scores(1, 1, int(blocks), shared);
  Eigen::MatrixXd of_shared = Eigen::MatrixXd::Zero(shared, Eigen::Index(blocks));
  Eigen::Matrix<double, Eigen::Dynamic, 2> by_shared(shared, 2);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const View& view = views[i];
    const int block = int(i * blocks / views.size());
    const SeenBoard board = rig.seenBoard(c, rig.left2world.at(view.image));
    const ImageEquations equations = equationsOf(rig, observations.at(view.image));
    for (const Corner& corner : view.corners) {
      const double sigma = rig.sigma_px * corner.sigma, weight = 1 / (sigma * sigma);
      const SeenBoard::Rows rows = board.rowsOf(corner.world);
      setByShared(rig.columns, c, rows, corner, equations.pose_by_shared, by_shared);
      const Eigen::Vector2d e = corner.pixel - rows.pixel();
      of_shared.col(block) += by_shared * (weight * e);
      scores.add<1>(0, block, weight, e, PatternRows<1>(corner.by_readout), rows.byLeft2World(), by_shared);
    }
    scores.endView(equations.pose_inverse);
  }
  scores.finish(covariance, of_shared);
  const double variance = scores.covariance(0)(0, 0);
  if (!(variance > 0)) return std::nullopt;
  const Eigen::RowVectorXd by_block = scores.estimates(0).row(0);
  const double count = double(blocks), mean = by_block.mean();
  const double clustered =
      std::sqrt(count / std::max(1.0, count - 1) * (by_block.array() - mean).square().sum());
  return ReadoutTrial{{by_block.sum(), std::sqrt(variance), clustered},
                      FlipTest(scores.products()).probability()};
}

}  // namespace

bool ReadoutTrial::isFound() const {
  constexpr double by_chance = 0.005, clear = 3;
  return probability <= by_chance && std::abs(readout.value) > clear * readout.largestStd();
}

std::vector<std::optional<ReadoutTrial>> compareReadout(const Dataset& all, const Result& result) {
  std::vector<std::optional<ReadoutTrial>> trials;
  if (!result.success()) return trials;
  const Dataset data = withoutRejected(all, result);
  const SortedDataset sorted(data);
  const Dataset moving = withMotion(result, asFitted(result, *sorted));
  const DataOnBoard on_board(moving, result.board);
  const FittedRig rig(result);
  const std::map<int, Observation> observations = observationsOf(*on_board, rig);
  const Eigen::MatrixXd covariance = WhitenedScores(*on_board, rig).statedCovariance();
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    trials.emplace_back();
    if (!result.cameras[c].readout && moves((*on_board).cameras[c]))
      trials.back() = trialOf(*on_board, rig, observations, covariance, c);
  }
  return trials;
}

}  // namespace slom::calibration
