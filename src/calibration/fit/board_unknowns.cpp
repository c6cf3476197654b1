#include "calibration/fit/board_unknowns.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace slom::calibration {
namespace {

/// Standard deviation before the fit, relative to the root mean square distance of the corners from their centre.
/// Boards are more exact than this.
constexpr double wide = 0.02;
constexpr double least = 1e-6;  // relative likewise; boards are less exact than this
/// A second fit is made only if the standard deviation changes by at least this factor.
constexpr double much = 1.2;

}  // namespace

BoardUnknowns::BoardUnknowns(Estimator& estimator, const Dataset& data, const Settings& settings,
                             const FittedBoard* start)
    : est_(&estimator), basis_(settings.board_shape, data), sigma_is_given_(start || settings.sigma_board) {
  std::vector<vec3> displacements(std::size_t(basis_.points()), vec3(0., 0., 0.));
  if (start) {
    for (const MovedCorner& corner : start->corners) {
      const int point = basis_.find(corner.world);
      if (point >= 0) displacements[std::size_t(point)] = corner.displacement;
    }
  }
  const std::vector<vec3> unknowns = basis_.unknownsOf(displacements);
  for (int i = 0; i < basis_.blocks(); ++i) {
    const std::string name = basis_.shape() == BoardShape::free
                                 ? "board[" + std::to_string(basis_.point(i).number) + "]"
                                 : "board";
    blocks_.push_back(est_->insertRV(unknowns[std::size_t(i)], true, name));
  }
  setSigma(start ? start->sigma : settings.sigma_board.value_or(wide * basis_.plane().size));
}

void BoardUnknowns::setSigma(double sigma) {
  sigma_ = sigma;
  for (const PriorID& prior : priors_) est_->removeMeasurement(prior);
  priors_.clear();
  for (const VarID<vec3>& block : blocks_)
    priors_.push_back(est_->prior(block, vec3(0., 0., 0.), StandardDeviation(sigma)));
}

vec3 BoardUnknowns::displacement(int point) const {
  return vec3(basis_.map(point) * *blocks_[std::size_t(basis_.block(point))]);
}

vec3 BoardUnknowns::worldOf(const Corner& corner) const {
  return vec3(corner.world + displacement(basis_.find(corner.world)));
}

double BoardUnknowns::rmsDisplacement() const {
  double square = 0;
  for (int i = 0; i < basis_.points(); ++i) square += displacement(i).squaredNorm();
  return std::sqrt(square / (3.0 * basis_.points()));
}

Summary BoardUnknowns::optimize(const Options& options) {
  Summary summary = est_->optimize(options);
  if (sigma_is_given_ || basis_.shape() != BoardShape::free || !summary.converged) return summary;
  const double shown = std::max(rmsDisplacement(), least * basis_.plane().size);
  if (shown < much * sigma_ && sigma_ < much * shown) return summary;
  setSigma(shown);
  const int iterations = summary.iterations;
  summary = est_->optimize(options);
  summary.iterations += iterations;
  return summary;
}

FittedBoard BoardUnknowns::board() const {
  FittedBoard board;
  board.shape = basis_.shape();
  board.sigma = sigma_;
  const Eigen::Vector3d normal = basis_.plane().plane2world.orient.toRotationMatrix().col(2);
  double square = 0, square_off_plane = 0;
  for (int i = 0; i < basis_.points(); ++i) {
    const MovedCorner corner{basis_.point(i).number, basis_.point(i).world, displacement(i)};
    square += corner.displacement.squaredNorm();
    square_off_plane += std::pow(normal.dot(corner.displacement), 2);
    board.corners.push_back(corner);
  }
  board.off_plane = std::sqrt(square_off_plane / basis_.points());
  board.within_plane = std::sqrt(std::max(0.0, square - square_off_plane) / (2.0 * basis_.points()));
  return board;
}

void BoardUnknowns::addStandardDeviations(FittedBoard& board) const {
  const Marginals marginals = est_->marginals();
  for (int i = 0; i < basis_.points(); ++i) {
    const Eigen::Matrix3d& map = basis_.map(i);
    const Eigen::Matrix3d C = marginals.covariance(blocks_[std::size_t(basis_.block(i))]);
    board.corners[std::size_t(i)].std =
        vec3(Eigen::Vector3d((map * C * map.transpose()).diagonal().cwiseSqrt()));
  }
}

}  // namespace slom::calibration
