#include "calibration/procedure/corner_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "calibration/data/fitted_board.hpp"
#include "calibration/data/rejected.hpp"
#include "calibration/data/sorted.hpp"
#include "calibration/data/view_facts.hpp"
#include "calibration/fit/as_fitted.hpp"
#include "calibration/median.hpp"
#include "slom/calibration/board.hpp"
#include "slom/model/loss.hpp"

namespace slom::calibration {

const char* toString(SigmaBy by) {
  switch (by) {
    case SigmaBy::constant:
      break;
    case SigmaBy::speed:
      return "speed";
    case SigmaBy::slant:
      return "slant";
    case SigmaBy::distance:
      return "distance";
  }
  return "constant";
}

namespace {

constexpr std::size_t fewest_views = 4;  // to estimate a growth from

/// The residuals of one view.
struct ViewResiduals {
  double x = 0;        // quantity that the noise may grow with
  double squares = 0;  // over Corner::sigma, with the weights of a loss [px^2]
  double dof = 0;      // numbers measured, less those that the pose absorbs
};

/// Returns the residuals of each view. All cameras that see an image share the degrees of freedom of its pose.
std::vector<std::vector<ViewResiduals>> residualsOf(const Dataset& on_board, const Result& result) {
  const std::map<int, SE3> poses = posesOf(result);
  std::map<int, int> seen_by;
  for (const CameraData& camera : on_board.cameras) {
    for (const View& view : camera.views) ++seen_by[view.image];
  }
  std::vector<std::vector<ViewResiduals>> all;
  for (std::size_t c = 0; c < on_board.cameras.size(); ++c) {
    all.emplace_back();
    for (const View& view : on_board.cameras[c].views) {
      const std::vector<double> distances = distancesOf(view, result.cameras[c], poses.at(view.image));
      ViewResiduals& own = all.back().emplace_back();
      for (std::size_t k = 0; k < distances.size(); ++k)
        own.squares += std::pow(distances[k] / view.corners[k].sigma, 2);
      const double count = 2 * double(view.corners.size());
      own.dof = std::max(0.1 * count, count - 6.0 / seen_by[view.image]);
    }
  }
  return all;
}

/// Returns the variance of a view over that of a view with x = 0, as in CornerNoise.
double growthOf(const ViewResiduals& view, double typical, double growth) {
  const double ratio = std::isfinite(view.x) ? view.x / typical : 1;
  return 1 + growth * ratio * ratio;
}

/// Returns minus twice the logarithm of the restricted likelihood of a growth, up to a constant, with the best common
/// sigma. Writes the square of that sigma to `common`.
double unlikelihood(const std::vector<ViewResiduals>& views, double typical, double growth,
                    double* common = nullptr) {
  double squares = 0, dof = 0, logarithms = 0;
  for (const ViewResiduals& view : views) {
    const double variance = growthOf(view, typical, growth);
    squares += view.squares / variance;
    dof += view.dof;
    logarithms += view.dof * std::log(variance);
  }
  if (common) *common = squares / dof;
  return dof * std::log(squares / dof) + logarithms;
}

double medianOfKnown(const std::vector<ViewResiduals>& views) {
  std::vector<double> known;
  for (const ViewResiduals& view : views) {
    if (std::isfinite(view.x)) known.push_back(view.x);
  }
  return known.size() < fewest_views ? 0 : medianOf(known);
}

/// Returns the most likely growth from 0 to 1e6. Searches a table of its logarithm, then between the neighbours of
/// the best entry.
double bestGrowth(const std::vector<ViewResiduals>& views, double typical) {
  constexpr double lowest = -4, highest = 6, step = 0.5;  // powers of ten
  const auto of = [&](double power) { return unlikelihood(views, typical, std::pow(10, power)); };
  double best = lowest;
  for (double power = lowest; power <= highest; power += step) {
    if (of(power) < of(best)) best = power;
  }
  double lower = best - step, upper = best + step;
  constexpr double golden = 0.381966;
  while (upper - lower > 1e-4) {
    const double a = lower + golden * (upper - lower), b = upper - golden * (upper - lower);
    of(a) < of(b) ? upper = b : lower = a;
  }
  const double power = (lower + upper) / 2;
  return of(power) < unlikelihood(views, typical, 0) ? std::pow(10, power) : 0;
}

/// Estimates the noise from the residuals of views.
CornerNoise noiseFrom(SigmaBy by, const std::vector<ViewResiduals>& views) {
  CornerNoise noise{by};
  const double typical = medianOfKnown(views);
  const bool is_known = std::any_of(views.begin(), views.end(), [](const auto& v) { return v.squares > 0; });
  if (by == SigmaBy::constant || !(typical > 0) || !is_known) return noise;
  noise.typical = typical;
  noise.growth = bestGrowth(views, typical);
  double logarithms = 0, dof = 0;
  std::vector<double> known;
  for (const ViewResiduals& view : views) {
    logarithms += view.dof * std::log(noise.at(view.x)), dof += view.dof;
    if (std::isfinite(view.x)) known.push_back(view.x);
  }
  noise.factor = std::exp(-logarithms / dof);
  std::sort(known.begin(), known.end());
  noise.lower_quarter = noise.at(known[known.size() / 4]);
  noise.upper_quarter = noise.at(known[(3 * known.size()) / 4]);
  return noise;
}

void setQuantity(SigmaBy by, const Dataset& on_board, const Result& result, std::size_t c,
                 std::vector<ViewResiduals>& views) {
  const std::vector<double> x = quantityOf(by, on_board, result, c);
  for (std::size_t i = 0; i < x.size(); ++i) views[i].x = x[i];
}

/// Returns the standard deviation of u and v that most corners show.
double noisePx(const Result& result, const Dataset& on_board, const Dataset& data) {
  const std::map<int, SE3> poses = posesOf(result);
  std::vector<double> sizes;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    for (std::size_t v = 0; v < data.cameras[c].views.size(); ++v) {
      const View& view = on_board.cameras[c].views[v];
      const std::vector<double> distances = distancesOf(view, result.cameras[c], poses.at(view.image));
      for (std::size_t k = 0; k < distances.size(); ++k)
        sizes.push_back(distances[k] / data.cameras[c].views[v].corners[k].sigma);
    }
  }
  return noiseOfDistances(std::move(sizes));
}

}  // namespace

bool estimatesNoise(const Settings& settings) {
  return settings.sigma_by != SigmaBy::constant || lossOf(settings.robust).kind() != nullptr;
}

void estimateNoise(const Dataset& data, const Settings& settings, Result& result) {
  for (CameraResult& camera : result.cameras) camera.noise = {};
  // The weights of a loss also keep gross corners from dominating the growth of the noise.
  const DataOnBoard before(data, result.board);
  const Dataset weighted = withNoiseOf(result, data);
  result.downweighted.reset();
  const DataOnBoard on_board(weighted, result.board);
  if (settings.sigma_by != SigmaBy::constant) {
    auto residuals = residualsOf(*on_board, result);
    for (std::size_t c = 0; c < data.cameras.size(); ++c) {
      setQuantity(settings.sigma_by, *on_board, result, c, residuals[c]);
      result.cameras[c].noise = noiseFrom(settings.sigma_by, residuals[c]);
    }
  }
  const Loss loss = lossOf(settings.robust);
  if (!loss.kind()) return;
  Dataset grown = data;
  applyGrowth(result, *before, grown);
  Downweighted down{loss.text(), noisePx(result, *before, grown)};
  if (!(down.noise_px > 0)) return;
  applyLoss(loss, result, *before, grown, down);
  result.downweighted = std::move(down);
}

namespace {

/// Returns the gain in log-likelihood of `views` if the noise grows as in `others`, over noise that is constant as in
/// `others`.
double gainOf(const std::vector<ViewResiduals>& views, const std::vector<ViewResiduals>& others) {
  const double typical = medianOfKnown(others);
  if (!(typical > 0)) return 0;
  const double growth = bestGrowth(others, typical);
  double common = 0, common_of_constant = 0, gain = 0;
  unlikelihood(others, typical, growth, &common);
  unlikelihood(others, typical, 0, &common_of_constant);
  for (const ViewResiduals& view : views) {
    const double variance = common * growthOf(view, typical, growth);
    gain += (view.dof * std::log(common_of_constant / variance) +
             view.squares * (1 / common_of_constant - 1 / variance)) /
            2;
  }
  return gain;
}

/// Adds the gains of blocks of successive views, each predicted from the other views.
void addGains(const std::vector<ViewResiduals>& views, std::vector<double>& gains) {
  constexpr std::size_t most_blocks = 12;
  const std::size_t blocks = std::min(most_blocks, views.size());
  for (std::size_t b = 0; b < blocks; ++b) {
    const auto first = std::ptrdiff_t(b * views.size() / blocks),
               last = std::ptrdiff_t((b + 1) * views.size() / blocks);
    std::vector<ViewResiduals> others(views.begin(), views.begin() + first);
    others.insert(others.end(), views.begin() + last, views.end());
    gains.push_back(gainOf({views.begin() + first, views.begin() + last}, others));
  }
}

}  // namespace

NoiseComparison compareNoise(const Dataset& all, const Result& result) {
  constexpr double clear = 2;  // standard errors
  NoiseComparison comparison;
  comparison.trials.push_back({SigmaBy::constant, 0, 0, std::vector<CornerNoise>(result.cameras.size())});
  if (!result.success()) return comparison;
  const Dataset data = withoutRejected(all, result);
  const SortedDataset sorted(data);
  const Dataset weighted = asFitted(result, *sorted);
  const DataOnBoard on_board(weighted, result.board);
  const auto residuals = residualsOf(*on_board, result);
  double most = 0;
  for (const SigmaBy by : {SigmaBy::speed, SigmaBy::slant, SigmaBy::distance}) {
    NoiseComparison::Trial trial{by};
    std::vector<double> gains;  // by block
    for (std::size_t c = 0; c < residuals.size(); ++c) {
      std::vector<ViewResiduals> views = residuals[c];
      setQuantity(by, *on_board, result, c, views);
      trial.noise.push_back(noiseFrom(by, views));
      addGains(views, gains);
    }
    const double count = double(gains.size());
    trial.gain = std::accumulate(gains.begin(), gains.end(), 0.0);
    double square = 0;
    for (const double gain : gains) square += std::pow(gain - trial.gain / count, 2);
    const double error = std::sqrt(square / std::max(1.0, count - 1) * count);
    trial.standard_errors = error > 0 ? trial.gain / error : 0;
    if (trial.standard_errors > clear && trial.gain > most) {
      most = trial.gain;
      comparison.chosen = by;
    }
    comparison.trials.push_back(std::move(trial));
  }
  return comparison;
}

}  // namespace slom::calibration
