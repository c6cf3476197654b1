#include "calibration/hand_eye/align.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/hand_eye/fourier.hpp"
#include "calibration/median.hpp"

namespace slom::calibration {
namespace {

/// A speed at equal intervals; 0 where it is unknown.
struct Series {
  std::vector<double> value, known;
};

enum class Speed { angular, linear };

/// The speed of a track at a time, over a window.
double speedAt(const Track& track, double time, double window, Speed kind) {
  const auto a = track.at(time - window / 2), b = track.at(time + window / 2);
  return kind == Speed::angular ? SO3::log(a.orient.inverse() * b.orient).norm() / window
                                : (b.pos - a.pos).norm() / window;
}

/// How far each pose is from the middle between its neighbours: [rad], [m]. 0 at the ends.
struct Bends {
  std::vector<double> turn, move;
};

Bends bendsOf(const std::vector<StampedPose>& poses) {
  Bends bends{std::vector<double>(poses.size()), std::vector<double>(poses.size())};
  for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
    const StampedPose &a = poses[i - 1], &b = poses[i], &c = poses[i + 1];
    const double share = c.t_s > a.t_s ? (b.t_s - a.t_s) / (c.t_s - a.t_s) : 0.5;
    const SO3 between = a.pose.orient * SO3::exp(SO3::log(a.pose.orient.inverse() * c.pose.orient), share);
    bends.turn[i] = SO3::log(between.inverse() * b.pose.orient).norm();
    bends.move[i] = (b.pose.pos - a.pose.pos - share * (c.pose.pos - a.pose.pos)).norm();
  }
  return bends;
}

/// Leaves out single wrong poses, which would look like fast motion.
std::vector<StampedPose> withoutSpikes(std::vector<StampedPose> poses) {
  constexpr int passes = 4;
  constexpr double large = 6;  // times the median
  for (int pass = 0; pass < passes && poses.size() > 10; ++pass) {
    const Bends bends = bendsOf(poses);
    const double turn = large * medianOf(bends.turn), move = large * medianOf(bends.move);
    const auto isSpike = [&](const std::vector<double>& bend, double limit, std::size_t i) {
      return bend[i] > limit && bend[i] >= bend[i - 1] && bend[i] >= bend[i + 1];
    };
    std::vector<StampedPose> kept{poses.front()};
    for (std::size_t i = 1; i + 1 < poses.size(); ++i) {
      if (!isSpike(bends.turn, turn, i) && !isSpike(bends.move, move, i)) kept.push_back(poses[i]);
    }
    kept.push_back(poses.back());
    if (kept.size() == poses.size()) break;
    poses = std::move(kept);
  }
  return poses;
}

/// Returns the speed that 2 % exceed; 0 if none is known.
double highSpeed(const Series& series) {
  std::vector<double> all;
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    if (series.known[i] != 0) all.push_back(series.value[i]);
  }
  if (all.empty()) return 0;
  const auto high = all.begin() + std::ptrdiff_t(all.size() * 49 / 50);
  std::nth_element(all.begin(), high, all.end());
  return *high;
}

/// Forgets speeds above `most`, which are those of wrong poses, and cuts those above `high`.
void cutPeaks(Series& series, double high, double most) {
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    if (series.value[i] > most) series.known[i] = 0;
    series.value[i] = std::min(series.value[i], high);
  }
}

void subtractMean(Series& series) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < series.value.size(); ++i) {
    sum += series.known[i] * series.value[i];
    n += series.known[i];
  }
  for (std::size_t i = 0; i < series.value.size(); ++i)
    series.value[i] = series.known[i] * (series.value[i] - sum / std::max(n, 1.0));
}

Series speedOf(const Track& track, double interval, double window, Speed kind) {
  Series series;
  const auto count = std::size_t(track.last() / interval) + 1;
  series.value.assign(count, 0);
  series.known.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const double time = double(i) * interval;
    if (!track.covers(time - window / 2) || !track.covers(time + window / 2)) continue;
    series.value[i] = speedAt(track, time, window, kind);
    series.known[i] = 1;
  }
  return series;
}

/// Prepares the speeds of one rigid body, seen by both streams, for their correlation.
void prepare(Series& a, Series& b, Speed kind) {
  const double high_a = highSpeed(a), high_b = highSpeed(b);
  if (kind ==
      Speed::angular) {  // both are equal, so the calmer stream says which speeds of the other are wrong
    constexpr double margin = 1.5;
    const double high = std::min(high_a, high_b);
    cutPeaks(a, high, margin * high);
    cutPeaks(b, high, margin * high);
  } else {
    constexpr double any = std::numeric_limits<double>::infinity();
    cutPeaks(a, high_a, any);
    cutPeaks(b, high_b, any);
  }
  subtractMean(a);
  subtractMean(b);
}

std::vector<double> squares(std::vector<double> numbers) {
  for (double& x : numbers) x *= x;
  return numbers;
}

/// Pearson's correlation at each shift, over the samples that both series know.
std::vector<ShiftCandidate> correlations(const Series& a, const Series& b, double interval,
                                         double least_overlap) {
  const std::vector<double> n = crossCorrelation(a.known, b.known),
                            sum_a = crossCorrelation(a.value, b.known),
                            sum_b = crossCorrelation(a.known, b.value),
                            sum_ab = crossCorrelation(a.value, b.value),
                            sum_aa = crossCorrelation(squares(a.value), b.known),
                            sum_bb = crossCorrelation(a.known, squares(b.value));
  std::vector<ShiftCandidate> all(n.size());
  for (std::size_t k = 0; k < n.size(); ++k) {
    all[k].shift = (double(k) - double(a.value.size() - 1)) * interval;
    all[k].overlap = n[k] * interval;
    if (all[k].overlap < least_overlap || n[k] < 20) continue;
    const double aa = sum_aa[k] - sum_a[k] * sum_a[k] / n[k], bb = sum_bb[k] - sum_b[k] * sum_b[k] / n[k];
    if (!(aa > 0) || !(bb > 0)) continue;
    all[k].correlation = std::clamp((sum_ab[k] - sum_a[k] * sum_b[k] / n[k]) / std::sqrt(aa * bb), -1.0, 1.0);
    all[k].score = std::atanh(0.999 * all[k].correlation) * std::sqrt(n[k]);
  }
  return all;
}

/// The local maxima with the highest scores, between samples by a parabola.
std::vector<ShiftCandidate> peaks(const std::vector<ShiftCandidate>& all, double interval) {
  constexpr std::size_t most = 8;
  std::vector<ShiftCandidate> found;
  for (std::size_t k = 1; k + 1 < all.size(); ++k) {
    const double left = all[k - 1].score, here = all[k].score, right = all[k + 1].score;
    if (!(here > 0) || here < left || here <= right) continue;
    found.push_back(all[k]);
    const double curvature = left - 2 * here + right;
    if (curvature < 0)
      found.back().shift += interval * std::clamp((left - right) / (2 * curvature), -0.5, 0.5);
  }
  std::sort(found.begin(), found.end(), [](const auto& x, const auto& y) { return x.score > y.score; });
  found.resize(std::min(found.size(), most));
  return found;
}

}  // namespace

std::vector<ShiftCandidate> shiftCandidates(const Streams& streams, const PoseStream& hand_stream,
                                            const PoseStream& camera_stream) {
  const Track hand(withoutSpikes(hand_stream.poses), streams.origin_hand),
      camera(withoutSpikes(camera_stream.poses), streams.origin_camera);
  const double steps = std::max(streams.hand.step(), streams.camera.step());
  const double length = std::max(streams.hand.last(), streams.camera.last());
  const double shorter = std::min(streams.hand.last(), streams.camera.last());
  const double interval = std::max({steps / 2, 1e-4, length / 300'000});
  const double window = std::max(4 * interval, std::min(0.1, 8 * interval));
  constexpr double good = 0.5;  // correlation of angular speeds beyond which speeds are not looked at
  std::vector<ShiftCandidate> best;
  for (const Speed kind : {Speed::angular, Speed::linear}) {
    Series a = speedOf(camera, interval, window, kind), b = speedOf(hand, interval, window, kind);
    prepare(a, b, kind);
    std::vector<ShiftCandidate> found = peaks(correlations(a, b, interval, shorter / 4), interval);
    if (!found.empty() && (best.empty() || found.front().score > best.front().score)) best = std::move(found);
    if (!best.empty() && best.front().correlation > good) break;
  }
  return best;
}

}  // namespace slom::calibration
