#include "calibration/hand_eye/robust_fit.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/median.hpp"

namespace slom::calibration {
namespace {

constexpr double least_move = 1e-9, least_turn = 1e-9;  // noise, relative to the extent, and [rad]

Items itemsAt(const Streams& streams, const HandEyeSettings& settings, double shift) {
  const std::vector<std::size_t> rows = streams.covered(shift);
  if (settings.drifting) return motionsOver(streams, rows, settings.motion_s);
  Items items;
  for (const std::size_t row : rows) items.push_back({row, row});
  return items;
}

/// Returns the noise that most items show, equal along all axes. It is never 0, so that exact data can be fitted.
HandEyeNoise roughNoise(const std::vector<Residual>& residuals, double extent) {
  std::vector<double> turns, moves;
  for (const Residual& residual : residuals) {
    moves.push_back(residual.head<3>().norm());
    turns.push_back(residual.tail<3>().norm());
  }
  const double move = std::max(medianOf(std::move(moves)) / median_of_length, least_move * extent),
               turn = std::max(medianOf(std::move(turns)) / median_of_length, least_turn);
  HandEyeNoise noise;
  noise.covariance.diagonal().head<3>().setConstant(move * move);
  noise.covariance.diagonal().tail<3>().setConstant(turn * turn);
  return noise;
}

/// Returns the covariance of the residuals of good items; with few of them, equal along all axes.
HandEyeNoise noiseOf(const std::vector<Residual>& residuals, const std::vector<bool>& is_good,
                     double extent) {
  constexpr double unknowns = 13, few = 60;
  double n = 0;
  HandEyeNoise noise;
  noise.covariance.setZero();
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (!is_good[i]) continue;
    noise.covariance += residuals[i] * residuals[i].transpose();
    ++n;
  }
  noise.covariance /= std::max(n - unknowns / 6, 1.0);
  const double move = noise.translation(), turn = noise.rotation_rad();
  if (n < few) noise.covariance.setZero();
  if (n < few) {
    noise.covariance.diagonal().head<3>().setConstant(move * move);
    noise.covariance.diagonal().tail<3>().setConstant(turn * turn);
  }
  // A floor for each component, so that exact data can be fitted.
  const double floor_m = std::max(least_move * extent, 1e-3 * move),
               floor_rad = std::max(least_turn, 1e-3 * turn);
  noise.covariance.diagonal().head<3>().array() += floor_m * floor_m;
  noise.covariance.diagonal().tail<3>().array() += floor_rad * floor_rad;
  return noise;
}

/// Returns for each residual whether its translation and its rotation alone are within so many standard deviations.
std::vector<bool> goodOnes(const std::vector<Residual>& residuals, const HandEyeNoise& noise, double sigmas) {
  std::vector<bool> is_good;
  for (const Residual& residual : residuals)
    is_good.push_back(residual.head<3>().norm() <= sigmas * noise.translation() &&
                      residual.tail<3>().norm() <= sigmas * noise.rotation_rad());
  return is_good;
}

double blockLength(const Streams& streams, const HandEyeSettings& settings, const Items& items) {
  constexpr double blocks = 64;
  if (settings.pairs || items.empty()) return 1;
  const double length = streams.rows[items.back().from].t_s - streams.rows[items.front().from].t_s;
  return std::max(length / blocks, 2 * std::max(streams.hand.step(), streams.camera.step()));
}

}  // namespace

Items RobustFit::goodItems() const {
  Items good;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (is_good[i]) good.push_back(items[i]);
  }
  return good;
}

RobustFit unfitted(const Streams& streams, const HandEyeSettings& settings, const HandEyeValues& start) {
  RobustFit fit;
  fit.values = start;
  fit.items = itemsAt(streams, settings, start.shift);
  const std::vector<Residual> residuals = residualsAt(streams, settings, fit.items, start);
  fit.noise = roughNoise(residuals, std::max(extentOf(streams), 1e-6));
  fit.is_good = goodOnes(residuals, fit.noise, settings.outlier_sigmas);
  return fit;
}

RobustFit fitRobustly(const Streams& streams, const HandEyeSettings& settings, const HandEyeValues& start,
                      const Held& held) {
  constexpr int rounds_with_loss = 3, most_rounds = 20;
  const double extent = std::max(extentOf(streams), 1e-6);
  RobustFit fit;
  fit.values = start;
  for (int round = 0; round < most_rounds; ++round) {
    const Items items = itemsAt(streams, settings, fit.values.shift);
    if (items.size() < least_items) return fit;
    const std::vector<Residual> residuals = residualsAt(streams, settings, items, fit.values);
    fit.noise = roughNoise(residuals, extent);
    const std::vector<bool> is_good = goodOnes(residuals, fit.noise, settings.outlier_sigmas);
    if (round >= rounds_with_loss) fit.noise = noiseOf(residuals, is_good, extent);
    const bool has_loss = round < rounds_with_loss;
    const auto same = [](const RowPair& a, const RowPair& b) { return a.from == b.from && a.to == b.to; };
    const bool is_same = is_good == fit.is_good &&
                         std::equal(items.begin(), items.end(), fit.items.begin(), fit.items.end(), same);
    if (round > rounds_with_loss && is_same) break;
    fit.items = items;
    fit.is_good = is_good;
    HandEyeProblem problem(streams, settings, fit.values, fit.noise);
    constexpr double scale_of_loss = 3;
    problem.insert(has_loss ? items : fit.goodItems(), has_loss ? Loss(Cauchy(scale_of_loss)) : Loss(), 1);
    problem.hold(held);
    problem.optimize();
    fit.values = problem.values();
  }
  fit.block_s = blockLength(streams, settings, fit.items);
  return fit;
}

HandEyeProblem finalProblem(const Streams& streams, const HandEyeSettings& settings, RobustFit& fit,
                            const Held& held) {
  constexpr int rounds = 3;
  const double extent = std::max(extentOf(streams), 1e-6);
  for (int round = 0;; ++round) {
    HandEyeProblem problem(streams, settings, fit.values, fit.noise);
    problem.insert(fit.goodItems(), Loss(), fit.block_s);
    problem.hold(held);
    if (round == rounds) return problem;
    problem.optimize();
    fit.values = problem.values();
    fit.noise = noiseOf(residualsAt(streams, settings, fit.items, fit.values), fit.is_good, extent);
  }
}

}  // namespace slom::calibration
