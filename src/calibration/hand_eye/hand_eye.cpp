// The procedure: checks, time offset, start, fits without outliers, what is free, uncertainty.
#include "slom/calibration/hand_eye.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "calibration/hand_eye/align.hpp"
#include "calibration/hand_eye/check.hpp"
#include "calibration/hand_eye/fit.hpp"
#include "calibration/hand_eye/free_directions.hpp"
#include "calibration/hand_eye/robust_fit.hpp"
#include "calibration/hand_eye/start.hpp"
#include "calibration/hand_eye/words.hpp"
#include "calibration/median.hpp"
#include "calibration/rotation_vector.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

constexpr double not_determined = std::numeric_limits<double>::quiet_NaN();

/// Pairs of poses as streams: the row is the time.
PoseStream asPairs(PoseStream stream) {
  for (std::size_t i = 0; i < stream.poses.size(); ++i) stream.poses[i].t_s = double(i);
  return stream;
}

/// Returns start values at the shift at which the streams agree best.
HandEyeStart startOf(const Streams& streams, const PoseStream& hand, const PoseStream& camera,
                     const HandEyeSettings& settings) {
  if (settings.pairs) return startAt(streams, 0, settings);
  if (!settings.estimate_offset) return startAt(streams, streams.shiftOf(settings.time_offset_s), settings);
  HandEyeStart best;
  double least = std::numeric_limits<double>::infinity(), extent = 0;
  const std::vector<ShiftCandidate> candidates = shiftCandidates(streams, hand, camera);
  for (const ShiftCandidate& candidate : candidates) {
    const HandEyeStart start = startAt(streams, candidate.shift, settings);
    if (start.rows < int(least_items)) continue;
    if (extent == 0) extent = std::max(extentOf(streams), 1e-3);
    if (const double misfit = start.misfit_m + extent * start.misfit_rad; misfit < least) {
      least = misfit;
      best = start;
      best.alike_shift = candidates.front().shift;
    }
  }
  return best;
}

/// A fit, and what it leaves free.
struct FitAndFreedom {
  RobustFit fit;
  Freedom freedom;
};

/// Fits with what is free held at its start. What is free is known for certain only after the fit.
FitAndFreedom fitWhatIsDetermined(const Streams& streams, const HandEyeSettings& settings,
                                  const HandEyeValues& start) {
  constexpr int most_rounds = 3;
  RobustFit fit = unfitted(streams, settings, start);
  if (fit.goodItems().size() < least_items) return {std::move(fit), {}};
  Freedom freedom = freedomOf(streams, settings, fit.goodItems(), fit.values, fit.noise);
  for (int round = 0; round < most_rounds; ++round) {
    fit = fitRobustly(streams, settings, start, freedom.held);
    if (fit.goodItems().size() < least_items) break;
    const std::size_t before = freedom.directions.size();
    freedom = freedomOf(streams, settings, fit.goodItems(), fit.values, fit.noise);
    if (freedom.directions.size() == before) break;
  }
  return {std::move(fit), std::move(freedom)};
}

/// Sets a component to NaN if it takes part in a free direction.
void hideFree(const Freedom& freedom, int first, PoseEstimate::Deviations& std) {
  for (const Direction& direction : freedom.held.directions) {
    for (int k = 0; k < 6; ++k) {
      if (std::abs(direction[first + k]) > 1e-2) std[k] = not_determined;
    }
  }
}

/// Standard deviations of all values, by residuals or clustered.
struct Deviations {
  Eigen::VectorXd X, Y, shift, scale;
  template <class Source>
  Deviations(const Source& source, const HandEyeProblem& problem)
      : X(source.standardDeviation(problem.X)),
        Y(source.standardDeviation(problem.Y)),
        shift(source.standardDeviation(problem.shift)),
        scale(source.standardDeviation(problem.scale)) {}
};

void setDeviations(const Deviations& own, const Freedom& freedom, bool is_clustered, HandEyeResult& result) {
  auto PoseEstimate::*std = is_clustered ? &PoseEstimate::std_clustered : &PoseEstimate::std;
  auto NumberEstimate::*number = is_clustered ? &NumberEstimate::std_clustered : &NumberEstimate::std;
  result.hand_T_camera.*std = own.X;
  hideFree(freedom, 0, result.hand_T_camera.*std);
  // If a direction of X is free, a direction of Y is free, too. The mean pose says which.
  if (result.base_T_target) {
    if (freedom.directions.empty())
      (*result.base_T_target).*std = own.Y;
    else
      ((*result.base_T_target).*std).setConstant(not_determined);
  }
  result.time_offset_s.*number = own.shift[0];
  result.scale.*number = own.scale[0];
  for (const FreeDirection& free : freedom.directions) {
    if (free.kind == FreeDirection::Kind::time_offset) result.time_offset_s.*number = not_determined;
    if (free.kind == FreeDirection::Kind::scale) result.scale.*number = not_determined;
  }
}

void takeUncertainty(HandEyeProblem& problem, const HandEyeSettings& settings, const Freedom& freedom,
                     HandEyeResult& result) {
  if (!result.converged) return;
  try {
    setDeviations(Deviations(problem.estimator(), problem), freedom, false, result);
  } catch (const mtk::Error& error) {
    result.converged = false;
    result.message = error.fault();
    return;
  }
  try {
    const Clustered clustered =
        slom::clustered(problem.estimator(), {.by = {"time"}, .ordered = !settings.pairs});
    setDeviations(Deviations(clustered, problem), freedom, true, result);
  } catch (const mtk::Error& error) {
    result.warnings.push_back("no clustered standard deviations: " + std::string(error.fault()));
  }
}

void takeResiduals(const Streams& streams, const PoseStream& stream, const HandEyeSettings& settings,
                   const RobustFit& fit, HandEyeResult& result) {
  const std::vector<Residual> residuals = residualsAt(streams, settings, fit.items, fit.values);
  std::vector<double> turns, moves;
  double turn = 0, move = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const double off_m = fit.values.scale * residuals[i].head<3>().norm(),
                 off_rad = residuals[i].tail<3>().norm();
    const std::size_t row = streams.indices[fit.items[i].from];
    if (!fit.is_good[i]) {
      result.outliers.push_back(
          {stream.poses[row].t_s, stream.place(row), off_rad * degrees_per_radian, off_m});
      continue;
    }
    turns.push_back(off_rad);
    moves.push_back(off_m);
    turn += off_rad * off_rad;
    move += off_m * off_m;
  }
  const auto size = [&](const HandEyeOutlier& outlier) {
    return std::max(outlier.rotation_deg / degrees_per_radian / fit.noise.rotation_rad(),
                    outlier.translation_m / (fit.values.scale * fit.noise.translation()));
  };
  std::stable_sort(result.outliers.begin(), result.outliers.end(),
                   [&](const auto& a, const auto& b) { return size(a) > size(b); });
  const double n = std::max(double(turns.size()), 1.0);
  result.rms_rotation_deg = std::sqrt(turn / n) * degrees_per_radian;
  result.rms_translation_m = std::sqrt(move / n);
  result.median_rotation_deg = medianOf(std::move(turns)) * degrees_per_radian;
  result.median_translation_m = medianOf(std::move(moves));
}

}  // namespace

HandEyeResult handEye(const PoseStream& hand, const PoseStream& camera, const HandEyeSettings& settings) {
  checkStreams(hand, camera, settings);
  const Streams streams = settings.pairs ? Streams(asPairs(hand), asPairs(camera)) : Streams(hand, camera);
  const PoseStream& stream = streams.interpolates_hand ? camera : hand;
  const HandEyeStart start = startOf(streams, hand, camera, settings);
  requireCommonTime(start, hand, camera, settings);
  HandEyeResult result;
  if (!settings.pairs) result.warnings = noticesOf(hand);
  if (!settings.pairs) {
    for (std::string& notice : noticesOf(camera)) result.warnings.push_back(std::move(notice));
  }
  if (std::string notice = noticeOfNames(hand, camera); !notice.empty())
    result.warnings.push_back(std::move(notice));
  auto [fit, freedom] = fitWhatIsDetermined(streams, settings, start.values);
  requireItems(fit, streams, hand, camera);
  HandEyeProblem problem = finalProblem(streams, settings, fit, freedom.held);
  const Summary summary = problem.optimize();
  fit.values = problem.values();
  result.converged = summary.converged;
  result.message = summary.message;
  result.free = freedom.directions;
  result.turns_deg = freedom.turns_deg;
  result.hand_T_camera.pose = fit.values.hand_T_camera;
  if (!settings.drifting) result.base_T_target = PoseEstimate{.pose = fit.values.base_T_target};
  const double offset = settings.pairs ? 0 : streams.offsetOf(fit.values.shift);
  result.time_offset_s = {offset, not_determined, not_determined};
  result.scale = {fit.values.scale, not_determined, not_determined};
  result.rows = int(streams.covered(fit.values.shift).size());
  result.unused = int(streams.rows.size()) - result.rows;
  result.motions = settings.drifting ? int(fit.items.size()) : 0;
  result.block_s = fit.block_s;
  result.sigma_rotation_rad = fit.noise.rotation_rad();
  result.sigma_translation_m = fit.values.scale * fit.noise.translation();
  takeResiduals(streams, stream, settings, fit, result);
  judge(streams, hand, camera, settings, start, freedom, result);
  takeUncertainty(problem, settings, freedom, result);
  return result;
}

}  // namespace slom::calibration
