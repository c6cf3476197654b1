#include "calibration/quality/uncertainty/clustered.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibration/data/fitted_board.hpp"
#include "calibration/median.hpp"
#include "calibration/quality/uncertainty/whitened_scores.hpp"
#include "calibration/rotation_vector.hpp"
#include "calibration/symmetric.hpp"
#include "slom/analyze/long_memory.hpp"
#include "slom/calibration/number_text.hpp"

namespace slom::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int fewest_groups = 2;
constexpr int fewest_blocks = 8;         // of successive images
constexpr int fewest_board_points = 10;  // to compare errors of points

/// Returns the mean over all directions of the clustered variance, divided by the stated one.
double ratioOf(const MatrixXd& V) { return V.trace() / double(V.rows()); }

/// Returns the standard deviation of the growth of the trace when the length of the blocks is doubled, relative to
/// the trace, if errors of neighbours are independent. Computes it from the products of neighbouring scores.
double scatterOfGrowth(const GroupSums& sums) {
  return std::sqrt(sums.V.squaredNorm() / std::max(1, sums.groups - 1)) / sums.V.trace();
}

struct BlockChoice {
  GroupSums sums;
  int length = 1;
  bool levels_off = true;
  double by_image = 1;       // ratioOf() of single images
  double extrapolation = 1;  // factor on the variance of the longest blocks
};

/// Tries blocks of 1, 2, 4, ... images until the mean variance over all directions grows by less than its
/// uncertainty. Blocks of length b miss a part of order 1 / b, so 2 V(2 b) - V(b) misses less. If the mean does not
/// level off, extrapolates it from the longest blocks.
///   source   Flegal and Jones 2010; Politis and Romano 1995 for 2 V(2 b) - V(b)
BlockChoice chooseBlocks(const WhitenedScores& scores) {
  constexpr double dof_left = 0.4;  // fraction of the degrees of freedom of V(2 b) that 2 V(2 b) - V(b) has
  BlockChoice choice{scores.byBlocks(1)};
  choice.by_image = ratioOf(choice.sums.V);
  std::vector<double> ratios{choice.by_image};
  for (int length = 2; scores.images() / length >= fewest_blocks; length *= 2) {
    choice.sums = scores.byBlocks(length);
    choice.length = length;
    const double before = ratios.back(), now = ratioOf(choice.sums.V);
    choice.levels_off = now - before <= now * scatterOfGrowth(choice.sums);
    ratios.push_back(now);
    if (!choice.levels_off) continue;
    if (now > before) {
      choice.sums.V *= 2 - before / now;
      choice.sums.dof = (dof_left * choice.sums.dof).cwiseMax(1);
    }
    return choice;
  }
  if (choice.levels_off) return choice;
  choice.extrapolation = longMemoryFactor(ratios, scores.images(), choice.length);
  choice.sums.V *= choice.extrapolation;
  if (choice.extrapolation > 1) choice.sums.dof = (dof_left * choice.sums.dof).cwiseMax(1);
  return choice;
}

MatrixXd semidefinite(const MatrixXd& V) {
  const SymmetricEigen eigen = eigenOf(V);
  if (V.rows() == 0 || !(eigen.eigenvalues()[0] < 0)) return V;
  return composed(eigen.eigenvectors(), eigen.eigenvalues().cwiseMax(0));
}

/// Standard deviations and degrees of freedom by shared parameter.
struct Columns {
  VectorXd std, dof;

  ClusteredVector vector(int first) const {
    return {vec3(Eigen::Vector3d(std.segment<3>(first))), vec3(Eigen::Vector3d(dof.segment<3>(first)))};
  }
};

/// Returns the standard deviations of the rotation vector of R, with the least degrees of freedom of its axes.
ClusteredVector ofRotationVector(const SO3& R, const MatrixXd& covariance, const Columns& columns,
                                 int first) {
  const double dof = columns.dof.segment<3>(first).minCoeff();
  return {rotationVectorStd(R, covariance.block<3, 3>(first, first)), vec3(dof, dof, dof)};
}

void writeStandardDeviations(const SharedColumns& shared, const MatrixXd& covariance, const Columns& columns,
                             Result& result) {
  for (std::size_t c = 0; c < result.cameras.size(); ++c) {
    CameraResult& camera = result.cameras[c];
    for (std::size_t i = 0; i < camera.parameters.size(); ++i) {
      const Index column = shared.lens[c] + Index(i);
      camera.parameters[i].std_clustered = columns.std[column];
      camera.parameters[i].dof = columns.dof[column];
    }
    if (camera.readout) camera.readout->std_clustered = columns.std[shared.readout[c]];
    const vec3 none(0., 0., 0.);
    camera.translation_clustered.std = camera.rotation_clustered.std = camera.rotation_vector_clustered.std =
        none;
    if (c == 0) continue;
    const int pose = shared.pose[c];
    camera.translation_clustered = columns.vector(pose);
    camera.rotation_clustered = columns.vector(pose + 3);
    camera.rotation_vector_clustered =
        ofRotationVector(camera.left2camera.orient, covariance, columns, pose + 3);
  }
  if (!result.imu) return;
  ImuResult& imu = *result.imu;
  imu.rotation_clustered = columns.vector(shared.imu);
  imu.rotation_vector_clustered = ofRotationVector(imu.left2imu, covariance, columns, shared.imu);
  imu.acc_bias_clustered = columns.vector(shared.imu + 3);
  imu.gravity_std_clustered = columns.std[shared.imu + 6];
  imu.gravity_dof = columns.dof[shared.imu + 6];
}

/// Number of standard deviations beyond which a corner is gross. Noise exceeds it once in 10^7 corners.
constexpr double gross = 6;
/// Least redundancy. Fewer residuals beyond the unknowns do not determine the noise.
constexpr int fewest_redundant = 100;

/// Adds corners that are gross compared with all images and with their own image, because a blurred or slanted image
/// makes all its corners worse.
void addGrossCorners(const Dataset& data, const WhitenedScores& scores, Result& result) {
  constexpr std::size_t fewest_of_image = 12;  // corners that determine the noise of an image
  const auto& tests = scores.cornerTests();
  std::vector<double> sizes;
  for (const auto& test : tests) sizes.push_back(test.weighted);
  const double noise_of_all = noiseOfDistances(sizes);
  if (result.redundancy < fewest_redundant || !(noise_of_all > 0)) return;
  std::size_t first = 0;
  for (const ImageResult& image : result.images) {
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      const View* const view = data.cameras[c].find(image.image);
      if (!view) continue;
      const std::size_t count = view->corners.size();
      double noise = noise_of_all;
      if (count >= fewest_of_image) {
        const auto begin = sizes.begin() + std::ptrdiff_t(first);
        noise = std::max(noise, noiseOfDistances({begin, begin + std::ptrdiff_t(count)}));
      }
      for (std::size_t i = 0; i < count; ++i) {
        const auto [without, weighted] = tests[first + i];
        if (!(weighted > gross * noise)) continue;
        const Corner& corner = view->corners[i];
        const CameraResult& camera = result.cameras[c];
        const double error =
            (camera.project(camera.left2camera * (image.left2world.inverse() * corner.world)) - corner.pixel)
                .norm();
        result.gross.push_back({c, image.image, corner.number, corner.line, error, without, weighted / noise,
                                data.cameras[c].place(*view, corner)});
      }
      first += count;
    }
  }
  std::stable_sort(result.gross.begin(), result.gross.end(),
                   [](const GrossCorner& a, const GrossCorner& b) { return a.studentised > b.studentised; });
}

}  // namespace

Clustering::Clustering(const Dataset& data, const Result& result) {
  if (!result.success() || result.images.size() < std::size_t(fewest_groups)) return;
  const FittedRig rig(result);
  if (rig.columns.free.empty()) return;
  on_board_ = *DataOnBoard(data, result.board);
  scores_ = std::make_unique<const WhitenedScores>(*on_board_, rig);
  if (!scores_->root().allFinite()) scores_.reset();
}

Clustering::~Clustering() = default;

void Clustering::addGrossCorners(Result& result) const {
  if (scores_) calibration::addGrossCorners(*on_board_, *scores_, result);
}

void Clustering::addClustered(Result& result) const {
  if (!scores_) return;
  const WhitenedScores& scores = *scores_;
  const BlockChoice blocks = chooseBlocks(scores);
  ClusteredUncertainty clustered;
  clustered.images = scores.images();
  clustered.block_length = blocks.length;
  clustered.blocks = blocks.sums.groups;
  clustered.levels_off = blocks.levels_off;
  clustered.extrapolation = std::sqrt(blocks.extrapolation);
  clustered.ratio_by_image = std::sqrt(blocks.by_image);
  clustered.ratio_by_block = std::sqrt(ratioOf(blocks.sums.V));
  const double over_curvature = result.downweighted ? result.downweighted->over_curvature : 1;
  const MatrixXd by_blocks = over_curvature * over_curvature * blocks.sums.V;
  MatrixXd V = by_blocks;
  Columns columns{VectorXd(), blocks.sums.dof};
  const BoardPointSums points = scores.byBoardPoints(blocks.length);
  if (points.points >= fewest_board_points) {
    clustered.board_points = points.points;
    V = semidefinite(V + over_curvature * over_curvature * (points.by_point - points.by_both));
    columns.dof = columns.dof.cwiseMin(points.dof);
  }
  clustered.ratio = std::sqrt(ratioOf(V));
  const MatrixXd K = scores.root();
  const MatrixXd covariance = K * V * K.transpose(), by_block = K * by_blocks * K.transpose();
  // With few groups, the difference of two groupings may be less reliable than one of them.
  columns.std = covariance.diagonal().cwiseMax(by_block.diagonal()).cwiseSqrt();
  clustered.covariance.assign(covariance.data(), covariance.data() + covariance.size());
  writeStandardDeviations(FittedRig(result).columns, covariance, columns, result);
  result.clustered = std::move(clustered);
}

void addClustered(const Dataset& data, Result& result) {
  const Clustering clustering(data, result);
  result.gross.clear();
  clustering.addGrossCorners(result);
  clustering.addClustered(result);
}

MatrixXd covarianceOf(const ClusteredUncertainty& clustered) {
  const auto n = Index(std::lround(std::sqrt(double(clustered.covariance.size()))));
  return Eigen::Map<const MatrixXd>(clustered.covariance.data(), n, n);
}

std::vector<std::string> sentencesOf(const ClusteredUncertainty& clustered) {
  std::vector<std::string> sentences;
  if (!clustered.isReliable()) {
    sentences.push_back(fmt::format(
        "There are only {} images: the clustered standard deviations are estimated from as few numbers, "
        "and are as uncertain as their degrees of freedom say. Projection uncertainty and verdict use the "
        "stated ones; from {} images on, they use the clustered ones.",
        clustered.images, ClusteredUncertainty::fewest_images));
  } else if (clustered.images < 2 * fewest_blocks) {
    sentences.push_back(fmt::format(
        "There are only {} images, too few to see whether successive images share errors; {} are needed.",
        clustered.images, 2 * fewest_blocks));
  }
  if (!clustered.levels_off) {
    sentences.push_back(fmt::format(
        "The variances still grow with blocks of {} successive images ({} blocks): errors are shared over "
        "longer series, {}.",
        clustered.block_length, clustered.blocks,
        clustered.extrapolation > 1
            ? fmt::format(
                  "for example by a drift or a model that is too simple. The growth is extrapolated: the "
                  "clustered standard deviations are {} times those of these blocks, and rough",
                  fixedDecimals(clustered.extrapolation, 1))
            : "and the clustered standard deviations are too small"));
  }
  return sentences;
}

}  // namespace slom::calibration
