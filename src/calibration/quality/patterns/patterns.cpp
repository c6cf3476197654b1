#include "calibration/quality/patterns/patterns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "calibration/data/point_key.hpp"
#include "calibration/data/view_facts.hpp"
#include "calibration/limits.hpp"
#include "calibration/median.hpp"
#include "calibration/quality/patterns/flip_test.hpp"
#include "slom/calibration/board.hpp"

namespace slom::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;
using Kind = ResidualPattern::Kind;

constexpr int most_blocks = 12, fewest_blocks_to_flip = 9;
constexpr int place_columns = 8, place_rows = 6;  // cells of the image
constexpr double near = 1.2;  // distance of a neighbour, divided by that of the nearest one

/// Numbers the points of the board by their coordinates.
class BoardPoints {
 public:
  int of(const Corner& corner) {
    const auto [at, is_new] = index_.emplace(keyOf(corner.world), int(all_.size()));
    if (is_new) all_.push_back({corner.number, corner.world, vec3()});
    return at->second;
  }
  const std::vector<MovedCorner>& all() const { return all_; }
  int size() const { return int(all_.size()); }
  /// Returns pairs of points in which one is among the nearest of the other.
  std::vector<std::pair<int, int>> neighbours() const {
    std::vector<std::pair<int, int>> pairs;
    for (int a = 0; a < size(); ++a) {
      double nearest = std::numeric_limits<double>::infinity();
      for (int b = 0; b < size(); ++b) {
        if (b != a) nearest = std::min(nearest, distance(a, b));
      }
      for (int b = 0; b < size(); ++b) {
        if (b != a && distance(a, b) <= near * nearest) pairs.emplace_back(std::min(a, b), std::max(a, b));
      }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

 private:
  double distance(int a, int b) const {
    return (all_[std::size_t(a)].world - all_[std::size_t(b)].world).norm();
  }

  std::map<PointKey, int> index_;
  std::vector<MovedCorner> all_;
};

/// Facts about a view, besides its corners.
struct ViewFacts {
  std::vector<int> points;       // of its corners
  std::vector<Vector2d> motion;  // of its corners, from one image number to the next [px]; NaN: unknown
  double speed = 0, slant = 0, distance = 0;
  double squares = 0;  // sum of squared residuals over Corner::sigma [px^2]
};

/// Tests one sum per block. Errors shared by neighbours give sums of one sign. Between independent errors, the fit
/// itself leaves the other sign.
ResidualPattern ofSums(Kind kind, double value, const VectorXd& sums) {
  ResidualPattern pattern;
  pattern.kind = kind;
  pattern.value = value;
  pattern.probability =
      kind == Kind::neighbours ? probabilityOfSum(sums) : FlipTest(sums * sums.transpose()).probability();
  return pattern;
}

/// Tests whether residuals grow with a fact about the views. Uses the views whose fact is known.
std::optional<ResidualPattern> growth(Kind kind, double ViewFacts::*fact, const std::vector<ViewFacts>& facts,
                                      const std::vector<int>& block_of, int blocks) {
  std::vector<std::size_t> used;
  double squares = 0, corners = 0, sum = 0;
  for (std::size_t i = 0; i < facts.size(); ++i) {
    if (!std::isfinite(facts[i].*fact)) continue;
    const double count = double(facts[i].points.size());
    used.push_back(i);
    squares += facts[i].squares, corners += count, sum += count * facts[i].*fact;
  }
  if (used.size() < std::size_t(fewest_blocks_to_flip) || !(squares > 0)) return std::nullopt;
  VectorXd sums = VectorXd::Zero(blocks);
  for (const std::size_t i : used) {
    const double count = double(facts[i].points.size());
    sums[block_of[i]] += (facts[i].squares - squares / corners * count) * (facts[i].*fact - sum / corners);
  }
  std::sort(used.begin(), used.end(),
            [&](std::size_t a, std::size_t b) { return facts[a].*fact < facts[b].*fact; });
  const std::size_t quarter = (used.size() + 3) / 4;
  std::array<double, 2> mean{};
  for (const bool is_upper : {false, true}) {
    double own_squares = 0, own_corners = 0;
    for (std::size_t k = 0; k < quarter; ++k) {
      const ViewFacts& view = facts[is_upper ? used[used.size() - 1 - k] : used[k]];
      own_squares += view.squares, own_corners += double(view.points.size());
    }
    mean[is_upper ? 1 : 0] = own_squares / own_corners;
  }
  return ofSums(kind, std::sqrt(mean[1] / mean[0]), sums);
}

/// The tests of one camera.
class CameraPatterns {
 public:
  CameraPatterns(const Dataset& data, const FittedRig& rig, const std::map<int, Observation>& observations,
                 std::size_t c, const ImageGrid& grid)
      : data_(data),
        rig_(rig),
        observations_(observations),
        c_(c),
        grid_(grid),
        blocks_(std::min(most_blocks, int(data.cameras[c].views.size()))) {
    const auto& views = data.cameras[c].views;
    for (std::size_t i = 0; i < views.size(); ++i) {
      facts_.emplace_back();
      block_of_.push_back(int(i * std::size_t(blocks_) / views.size()));
      for (const Corner& corner : views[i].corners) facts_[i].points.push_back(points_.of(corner));
    }
    const std::vector<ViewMotion> motions = motionsOf(data.cameras[c]);
    for (std::size_t i = 0; i < views.size(); ++i) {
      facts_[i].motion = motions[i].of_corners;
      facts_[i].speed = motions[i].speed;
    }
  }
  std::vector<ResidualPattern> all(const MatrixXd& covariance, const Limits& limits);

 private:
  struct Scores {
    PatternScores board, place, drift, readout, offset;
  };
  void addView(std::size_t i, Scores& scores);
  void addNeighbours(std::size_t i);
  void addBlur(std::size_t i);
  ResidualPattern fromScores(Kind kind, const PatternScores& scores) const;
  ResidualPattern boardShape(const PatternScores& scores) const;
  ResidualPattern driftOf(const PatternScores& scores) const;
  const CameraData& camera() const { return data_.cameras[c_]; }

  const Dataset& data_;
  const FittedRig& rig_;
  const std::map<int, Observation>& observations_;
  std::size_t c_;
  const ImageGrid& grid_;
  int blocks_;
  BoardPoints points_;
  std::vector<ViewFacts> facts_;
  std::vector<int> block_of_;
  std::vector<std::vector<Vector2d>> residuals_;  // by view, over Corner::sigma
  MatrixXd scores_;                               // of the shared parameters, by block
  Eigen::Matrix3d board2world_;                   // its z axis along the normal
  std::vector<int> free_;                         // lens parameters that are estimated
  double squares_ = 0, corners_ = 0;              // squared residuals in px^2, and their number
  // Pairs of neighbouring points, and sums by block.
  std::vector<std::pair<int, int>> neighbours_;
  VectorXd products_of_neighbours_, along_less_across_;
  double of_neighbours_ = 0, squares_of_neighbours_ = 0, along_ = 0, across_ = 0, usual_speed_ = 0;
};

void CameraPatterns::addView(std::size_t i, Scores& scores) {
  const View& view = camera().views[i];
  const int block = block_of_[i];
  const SE3& left2world = rig_.left2world.at(view.image);
  const SeenBoard board = rig_.seenBoard(c_, left2world);
  const double time = 2.0 * double(i) / double(facts_.size() - 1) - 1;
  const ImageEquations equations = equationsOf(rig_, observations_.at(view.image));
  Eigen::Matrix<double, Eigen::Dynamic, 2> by_shared(rig_.columns.size, 2);
  std::vector<Vector2d>& residuals = residuals_.emplace_back();
  for (std::size_t k = 0; k < view.corners.size(); ++k) {
    const Corner& corner = view.corners[k];
    const double sigma = rig_.sigma_px * corner.sigma, weight = 1 / (sigma * sigma);
    const SeenBoard::Rows rows = board.rowsOf(corner.world);
    setByShared(rig_.columns, c_, rows, corner, equations.pose_by_shared, by_shared);
    const Vector2d e = corner.pixel - rows.pixel();
    residuals.push_back(e / corner.sigma);
    facts_[i].squares += residuals.back().squaredNorm();
    scores_.col(block).noalias() += by_shared * (weight * e);
    const auto add = [&]<int D>(PatternScores& to, int cell, const PatternRows<D>& F) {
      to.add<D>(cell, block, weight, e, F, rows.byLeft2World(), by_shared);
    };
    add(scores.board, facts_[i].points[k], PatternRows<3>(rows.by_point * board2world_));
    const auto cellOf = [](double x, double size, int count) {
      return std::clamp(int(x / size * count), 0, count - 1);
    };
    add(scores.place,
        cellOf(corner.pixel.y(), grid_.box.height, place_rows) * place_columns +
            cellOf(corner.pixel.x(), grid_.box.width, place_columns),
        PatternRows<2>(Eigen::Matrix2d::Identity()));
    add(scores.drift, 0, PatternRows<Eigen::Dynamic>(time * rows.seen.by_parameters(Eigen::all, free_)));
    const Vector2d& motion = facts_[i].motion[k];
    if (!motion.allFinite()) continue;
    add(scores.readout, 0, PatternRows<1>(corner.pixel.y() / grid_.box.height * motion));
    if (c_ > 0) add(scores.offset, 0, PatternRows<1>(motion));
  }
  for (PatternScores* const own :
       {&scores.board, &scores.place, &scores.drift, &scores.readout, &scores.offset})
    own->endView(equations.pose_inverse);
  squares_ += facts_[i].squares, corners_ += double(view.corners.size());
  const ViewGeometry seen =
      geometryOf(view, rig_.left2camera[c_] * left2world.inverse(), board2world_.col(2));
  facts_[i].slant = seen.slant, facts_[i].distance = seen.distance;
}

void CameraPatterns::addNeighbours(std::size_t i) {
  std::vector<int> place(std::size_t(points_.size()), -1);
  for (std::size_t k = 0; k < residuals_[i].size(); ++k) place[std::size_t(facts_[i].points[k])] = int(k);
  for (const auto& [a, b] : neighbours_) {
    const int k = place[std::size_t(a)], l = place[std::size_t(b)];
    if (k < 0 || l < 0) continue;
    const Vector2d &e = residuals_[i][std::size_t(k)], &f = residuals_[i][std::size_t(l)];
    products_of_neighbours_[block_of_[i]] += e.dot(f);
    of_neighbours_ += e.dot(f);
    squares_of_neighbours_ += (e.squaredNorm() + f.squaredNorm()) / 2;
  }
}

void CameraPatterns::addBlur(std::size_t i) {
  if (!(facts_[i].speed > usual_speed_)) return;
  for (std::size_t k = 0; k < residuals_[i].size(); ++k) {
    const Vector2d& motion = facts_[i].motion[k];
    if (!(motion.norm() > usual_speed_)) continue;
    const Vector2d direction = motion.normalized();
    const double along = std::pow(residuals_[i][k].dot(direction), 2);
    const double across = residuals_[i][k].squaredNorm() - along;
    along_ += along, across_ += across;
    along_less_across_[block_of_[i]] += along - across;
  }
}

ResidualPattern CameraPatterns::fromScores(Kind kind, const PatternScores& scores) const {
  const FlipTest test(scores.products());
  ResidualPattern pattern;
  pattern.kind = kind;
  pattern.share = std::min(1.0, test.explained() * rig_.sigma_px * rig_.sigma_px / squares_);
  pattern.probability = test.probability();
  if (scores.cells() == 1) pattern.value = scores.estimates(0).row(0).sum();
  return pattern;
}

/// Mean squares without the contribution of noise, from the products of different blocks.
ResidualPattern CameraPatterns::boardShape(const PatternScores& scores) const {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (int cell = 0; cell < scores.cells(); ++cell) {
    const MatrixXd& estimates = scores.estimates(cell);
    squares +=
        Eigen::Vector3d(estimates.rowwise().sum().cwiseAbs2() - estimates.cwiseAbs2().rowwise().sum()) /
        scores.cells();
  }
  ResidualPattern pattern = fromScores(Kind::board_shape, scores);
  pattern.corners = points_.all();
  for (int cell = 0; cell < scores.cells(); ++cell)
    pattern.corners[std::size_t(cell)].displacement =
        vec3(Eigen::Vector3d(board2world_ * scores.estimates(cell).rowwise().sum()));
  pattern.value = std::sqrt(std::max(0.0, squares.z()));
  pattern.second = std::sqrt(std::max(0.0, (squares.x() + squares.y()) / 2));
  return pattern;
}

ResidualPattern CameraPatterns::driftOf(const PatternScores& scores) const {
  ResidualPattern pattern = fromScores(Kind::drift, scores);
  const VectorXd change = scores.estimates(0).rowwise().sum();
  double clearest = -1;
  for (Index k = 0; k < change.size(); ++k) {
    const double clear = std::abs(change[k]) / std::sqrt(scores.covariance(0)(k, k));
    if (!(clear > clearest)) continue;
    clearest = clear;
    pattern.value = 2 * change[k];
    const std::string& name = rig_.columns.names[std::size_t(rig_.columns.lens[c_] + free_[std::size_t(k)])];
    pattern.parameter = name.substr(name.rfind('.') + 1);
  }
  return pattern;
}

std::vector<ResidualPattern> CameraPatterns::all(const MatrixXd& covariance, const Limits& limits) {
  const int shared = rig_.columns.size;
  for (int k = 0; k < rig_.lenses[c_].parameters(); ++k) {
    const auto& free = rig_.columns.free;
    if (std::binary_search(free.begin(), free.end(), rig_.columns.lens[c_] + k)) free_.push_back(k);
  }
  board2world_ = fitPlane(fullestView(data_).corners).plane2world.orient.toRotationMatrix();
  Scores scores{{points_.size(), 3, blocks_, shared},
                {place_columns * place_rows, 2, blocks_, shared},
                {1, int(free_.size()), blocks_, shared},
                {1, 1, blocks_, shared},
                {1, 1, blocks_, shared}};
  scores_ = MatrixXd::Zero(shared, blocks_);
  products_of_neighbours_ = along_less_across_ = VectorXd::Zero(blocks_);
  for (std::size_t i = 0; i < facts_.size(); ++i) {
    requireTime(limits);
    addView(i, scores);
  }
  if (!(squares_ > 0)) return {};
  for (PatternScores* const own :
       {&scores.board, &scores.place, &scores.drift, &scores.readout, &scores.offset})
    own->finish(covariance, scores_);
  neighbours_ = points_.neighbours();
  std::vector<double> speeds;
  for (const ViewFacts& view : facts_) {
    if (std::isfinite(view.speed)) speeds.push_back(view.speed);
  }
  usual_speed_ = medianOf(speeds);
  for (std::size_t i = 0; i < facts_.size(); ++i) addNeighbours(i), addBlur(i);

  std::vector<ResidualPattern> found;
  if (squares_of_neighbours_ > 0)
    found.push_back(
        ofSums(Kind::neighbours, of_neighbours_ / squares_of_neighbours_, products_of_neighbours_));
  found.push_back(boardShape(scores.board));
  found.push_back(fromScores(Kind::image_place, scores.place));
  found.back().value = std::sqrt(std::max(0.0, found.back().share) * squares_ / (2 * corners_));
  if (!free_.empty()) found.push_back(driftOf(scores.drift));
  const bool is_fitted = rig_.columns.readout[c_] >= 0;
  if (!is_fitted && scores.readout.covariance(0)(0, 0) > 0)
    found.push_back(fromScores(Kind::row_readout, scores.readout));
  if (c_ > 0 && scores.offset.covariance(0)(0, 0) > 0)
    found.push_back(fromScores(Kind::time_offset, scores.offset));
  if (across_ > 0)
    found.push_back(ofSums(Kind::motion_blur, std::sqrt(along_ / across_), along_less_across_));
  for (const auto& [kind, fact] :
       {std::pair(Kind::speed, &ViewFacts::speed), std::pair(Kind::slant, &ViewFacts::slant),
        std::pair(Kind::distance, &ViewFacts::distance)}) {
    if (auto pattern = growth(kind, fact, facts_, block_of_, blocks_)) found.push_back(*pattern);
  }
  for (ResidualPattern& pattern : found) pattern.camera = c_, pattern.blocks = blocks_;
  return found;
}

}  // namespace

std::vector<ResidualPattern> residualPatterns(const Dataset& data, const FittedRig& rig,
                                              const MatrixXd& covariance, const std::vector<ImageGrid>& grids,
                                              const Limits& limits) {
  const std::map<int, Observation> observations = observationsOf(data, rig);
  std::vector<ResidualPattern> all;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    if (data.cameras[c].views.size() < std::size_t(fewest_blocks_to_flip)) continue;
    for (ResidualPattern& pattern :
         CameraPatterns(data, rig, observations, c, grids[c]).all(covariance, limits))
      all.push_back(std::move(pattern));
  }
  return all;
}

}  // namespace slom::calibration
