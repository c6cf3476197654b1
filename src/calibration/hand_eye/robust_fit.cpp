#include "calibration/hand_eye/robust_fit.hpp"

#include <algorithm>
#include <cmath>

#include "calibration/median.hpp"

namespace slom::calibration {
namespace {

constexpr double median_of_length = 1.5382;  // of a normal vector in space with standard deviations 1
constexpr std::size_t least_items = 3;

Items itemsAt(const Streams& streams, const HandEyeSettings& settings, double shift) {
  const std::vector<std::size_t> rows = streams.covered(shift);
  if (settings.drifting) return motionsOver(streams, rows, settings.motion_s);
  Items items;
  for (const std::size_t row : rows) items.push_back({row, row});
  return items;
}

/// Returns the noise that most items show. It is never 0, so that exact data can be fitted.
HandEyeNoise noiseOf(const std::vector<Misfit>& misfits, double extent) {
  std::vector<double> turns, moves;
  for (const Misfit& misfit : misfits) {
    turns.push_back(misfit.rotation_rad);
    moves.push_back(misfit.translation_m);
  }
  return {std::max(medianOf(std::move(turns)) / median_of_length, 1e-9),
          std::max(medianOf(std::move(moves)) / median_of_length, 1e-9 * extent)};
}

std::vector<bool> goodOnes(const std::vector<Misfit>& misfits, const HandEyeNoise& noise, double sigmas) {
  std::vector<bool> is_good;
  for (const Misfit& misfit : misfits)
    is_good.push_back(misfit.rotation_rad <= sigmas * noise.rotation_rad &&
                      misfit.translation_m <= sigmas * noise.translation_m);
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

RobustFit fitRobustly(const Streams& streams, const HandEyeSettings& settings, const HandEyeValues& start) {
  constexpr int rounds_with_loss = 3, most_rounds = 20;
  const double extent = std::max(extentOf(streams), 1e-6);
  RobustFit fit;
  fit.values = start;
  for (int round = 0; round < most_rounds; ++round) {
    const Items items = itemsAt(streams, settings, fit.values.shift);
    if (items.size() < least_items) return fit;
    const std::vector<Misfit> misfits = misfitsOf(residualsAt(streams, settings, items, fit.values));
    fit.noise = noiseOf(misfits, extent);
    const std::vector<bool> is_good = goodOnes(misfits, fit.noise, settings.outlier_sigmas);
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
    problem.optimize();
    fit.values = problem.values();
  }
  fit.block_s = blockLength(streams, settings, fit.items);
  return fit;
}

HandEyeProblem finalProblem(const Streams& streams, const HandEyeSettings& settings, RobustFit& fit,
                            const Held& held) {
  for (int round = 0; round < 2; ++round) {
    HandEyeProblem problem(streams, settings, fit.values, fit.noise);
    problem.insert(fit.goodItems(), Loss(), fit.block_s);
    problem.hold(held);
    if (!problem.optimize().converged) break;
    const VarianceComponents components =
        varianceComponents(problem.estimator(), {.kinds = {"rotation", "translation"}});
    fit.values = problem.values();
    const double turn = components.at("rotation").factor, move = components.at("translation").factor;
    if (turn > 0) fit.noise.rotation_rad *= turn;
    if (move > 0) fit.noise.translation_m *= move;
  }
  HandEyeProblem problem(streams, settings, fit.values, fit.noise);
  problem.insert(fit.goodItems(), Loss(), fit.block_s);
  problem.hold(held);
  return problem;
}

}  // namespace slom::calibration
