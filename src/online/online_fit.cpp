#include "online/online_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/index.hpp"

namespace slom {

namespace {

/// Relative difference of a Jacobian from that in the factor: beyond the first, the factor gets the new one; beyond the second where a
/// step has decreased the RSS by less than half of what was promised.
constexpr double kStaleOnline = 3e-4, kSlightlyStale = 1e-4;
constexpr double kKeptOnline = 0.5;
/// What a subtree must promise to be moved, relative to what may be left in all. What hundreds of subtrees leave adds up, and another step
/// costs more than moving some that need not move.
constexpr double kShareOnline = 3e-3, kSmallerShare = 0.1;
/// The promise is that of a model; this part of what is allowed is aimed at.
constexpr double kAimedAt = 0.5;
constexpr double kSlowest = 0.99;  // of the promises of two steps
constexpr double kNoiseOfRss = 1e-13;
constexpr double kRoundingSteps = 4;  // of the last digit
/// What rounding errors may hide, squared standard deviations: where a measurement is so exact that they are worth more, others are not.
constexpr double kMostRoundingOnline = 1e-4;
constexpr int kManySteps =
    3;  // after so many, values may have another size than where their measurements were inserted
constexpr double kMostPeak = 1e6;  // of the sum of costs since it was added up, relative to what it is now
/// Nearly all of the RSS is promised to go: the optimum is far off, and which valley is reached is left to optimize().
constexpr double kFarOff = 0.5;
bool isFarOff(double promised, double rss) { return promised >= kFarOff * rss; }
/// A step that decreases the RSS by more than so many times what was promised is prolonged, to so many times its length at most.
constexpr double kStretched = 1.5, kLongest = 8;
/// A step that goes uphill is shortened, by this factor, down to that.
constexpr double kShorterOnline = 0.5, kShortestOnline = 0.1;

}  // namespace

// ---- following the problem --------------------------------------------------------------------------------------

void OnlineFit::follow() {
  const auto changes = has_started_ ? problem_.changesSince(structure_revision_) : std::nullopt;
  if (!changes) {
    startAgain();
  } else {
    records_.resize(problem_.pools().size());
    for (const Change& change : *changes) {
      if (change.kind == Change::Kind::measurement_inserted) {
        records_[at(change.pool)].emplace_back();
        pending_.emplace_back(change.pool, change.index);
      } else if (change.kind == Change::Kind::measurement_removed) {
        std::vector<Record>& records = records_[at(change.pool)];
        dropElement(records[at(change.index)]);
        records[at(change.index)] = records.back();
        records.pop_back();
        pending_.emplace_back(change.pool, change.index);  // where the last one is not yet an element
      } else {
        touched_variables_.push_back(change.index);
      }
    }
  }
  structure_revision_ = problem_.structureRevision();
  followVariables();
  followMoves();
  value_revision_ = problem_.valueRevision();
  for (const Place& place : pending_) {
    if (place.second < static_cast<int>(records_[at(place.first)].size()) &&
        recordOf(place).element == kPending)
      makeElement(place);
  }
  pending_.clear();
}

void OnlineFit::startAgain() {
  factor_ = {};
  rss_ = rss_rest_ = peak_ = rounding_ = 0;
  known_.clear();
  pending_.clear();
  touched_variables_.clear();
  records_.assign(problem_.pools().size(), {});
  for (int p = 0; p < static_cast<int>(records_.size()); ++p) {
    records_[at(p)].resize(at(problem_.pools()[at(p)]->size()));
    for (int i = 0; i < problem_.pools()[at(p)]->size(); ++i) pending_.emplace_back(p, i);
  }
  for (int v = 0; v < static_cast<int>(problem_.variables().size()); ++v) touched_variables_.push_back(v);
  has_started_ = true;
  value_revision_ = problem_.valueRevision();
}

/// Blocks for the variables that are free now and were not, none for those that were. Their measurements become elements anew.
void OnlineFit::followVariables() {
  std::sort(touched_variables_.begin(), touched_variables_.end());
  touched_variables_.erase(std::unique(touched_variables_.begin(), touched_variables_.end()),
                           touched_variables_.end());
  known_.resize(problem_.variables().size(), kUnknown);
  std::vector<int> inserted;
  for (const int v : touched_variables_) {
    const VariableRecord& record = problem_.variables()[at(v)];
    long& known = known_[at(v)];
    const bool exists = record.store != nullptr;
    const bool has_block = exists && problem_.activeSet().isOptimized(v) && record.dof > 0;
    if (has_block && known == record.serial) {  // other components are fixed
      for (const Place& place : usesOf(v)) linearize(place, 1, 0);
      continue;
    }
    if (known == kUnknown && !has_block) continue;
    if (exists) {
      for (const Place& place : usesOf(v)) {
        dropElement(recordOf(place));
        pending_.push_back(place);
      }
    }
    if (known != kUnknown) factor_.removeBlock(v);
    known = has_block ? record.serial : kUnknown;
    if (has_block) inserted.push_back(v);
  }
  const auto isOlder = [&](int a, int b) {
    return problem_.variables()[at(a)].serial < problem_.variables()[at(b)].serial;
  };
  std::sort(inserted.begin(), inserted.end(), isOlder);
  for (const int v : inserted) factor_.insertBlock(v, problem_.variables()[at(v)].dof);
  touched_variables_.clear();
}

void OnlineFit::followMoves() {
  const auto moves = problem_.movedSince(value_revision_);
  const bool all = !moves || std::find(moves->begin(), moves->end(), Problem::kAll) != moves->end();
  touched_.clear();
  ++visit_;
  if (all) {
    for (int p = 0; p < static_cast<int>(records_.size()); ++p) {
      for (int i = 0; i < static_cast<int>(records_[at(p)].size()); ++i) touched_.emplace_back(p, i);
    }
  } else {
    for (const int v : *moves) {
      if (problem_.variables()[at(v)].store != nullptr) touchUsesOf(v);
    }
  }
  linearizeTouched(0);
}

std::vector<OnlineFit::Place> OnlineFit::usesOf(int variable) const {
  std::vector<Place> places;
  problem_.forEachUse(variable, [&](const MeasurementPool& pool, int i) {
    places.emplace_back(problem_.indexOfPool(pool), i);
  });
  return places;
}

/// Adds the variable's measurements to touched_, each once since visit_ changed.
void OnlineFit::touchUsesOf(int variable) {
  problem_.forEachUse(variable, [&](const MeasurementPool& pool, int i) {
    const Place place(problem_.indexOfPool(pool), i);
    if (std::exchange(recordOf(place).visited, visit_) != visit_) touched_.push_back(place);
  });
}

void OnlineFit::dropElement(Record& record) {
  addToRss(-record.cost);
  rounding_ -= record.rounding;
  if (record.element >= 0) factor_.removeElement(record.element);
  record = {};
}

void OnlineFit::makeElement(Place place) {
  const MeasurementPool& pool = *problem_.pools()[at(place.first)];
  std::vector<int> blocks;
  for (int k = 0; k < pool.arity(); ++k) {
    const int v = pool.variables(place.second)[k];
    if (known_[at(v)] != kUnknown && std::find(blocks.begin(), blocks.end(), v) == blocks.end())
      blocks.push_back(v);
  }
  Record& record = recordOf(place);
  const int rows = pool.rows(place.second);
  record.element = blocks.empty() || rows == 0 ? kNone : factor_.insertElement(blocks, rows);
  const int* const variables = pool.variables(place.second);
  record.is_plain = std::equal(blocks.begin(), blocks.end(), variables, variables + pool.arity());
  linearize(place, 1, 0);
  roundAgain(record);
}

/// What the last digits of the variables' values do to the measurement.
void OnlineFit::roundAgain(Record& record) {
  if (record.element < 0) return;
  const int rows = factor_.rowsOf(record.element);
  const double* a = factor_.A(record.element).data();
  double residual = 0;
  std::vector<double> sizes;
  for (const int v : factor_.blocksOf(record.element)) {
    const VariableRecord& variable = problem_.variables()[at(v)];
    sizes.resize(at(variable.dof));
    variable.store->typicalSizes(variable.slot, sizes.data());
    for (const double size : sizes) {
      double length = 0;
      for (int k = 0; k < rows; ++k, ++a) length += *a * *a;
      residual += std::sqrt(length) * size;
    }
  }
  residual *= kRoundingSteps * std::numeric_limits<double>::epsilon();
  rounding_ += residual * residual - record.rounding;
  record.rounding = residual * residual;
}

void OnlineFit::addToRss(double change) {
  // Neumaier's sum: what is added and later subtracted leaves nothing.
  const double sum = rss_ + change;
  rss_rest_ += std::abs(rss_) >= std::abs(change) ? (rss_ - sum) + change : (change - sum) + rss_;
  rss_ = sum;
  peak_ = std::max(peak_, std::abs(sum));
}

/// Adds up all measurements where the sum was so much larger meanwhile that little of what is left can be trusted. That takes time in
/// proportion to everything, once for each such event.
void OnlineFit::sumAgain() {
  if (peak_ <= kMostPeak * std::abs(rss())) return;
  rss_ = rss_rest_ = 0;
  for (const std::vector<Record>& records : records_) {
    for (const Record& record : records) addToRss(record.cost);
  }
  peak_ = std::abs(rss());
}

/// `count` measurements at the current values. The factor gets a Jacobian where that differs from the one it has by more than
/// `most_difference`.
void OnlineFit::linearize(Place first, int count, double most_difference) {
  const MeasurementPool& pool = *problem_.pools()[at(first.first)];
  const bool has_losses = pool.lossCount() > 0;  // costs are not those of the residuals then
  const int each = has_losses ? 1 : count;
  for (int i = first.second; i < first.second + count; i += each) {
    double cost = 0;
    const JacobianBatch batch =
        linearizer_.linearizeSome(problem_, problem_.activeSet(), first.first, i, i + each, &cost);
    const double *r = batch.r, *J = batch.J;
    const int* dof = batch.dof;
    for (int m = 0; m < each; ++m) {
      const int rows = batch.rows[m];
      if (!has_losses) {
        cost = 0;
        for (int k = 0; k < rows; ++k) cost += r[k] * r[k];
      }
      take({first.first, i + m}, r, J, dof, cost, most_difference);
      r += rows;
      for (int k = 0; k < pool.arity(); ++k) J += rows * *dof++;
    }
  }
}

void OnlineFit::take(Place place, const double* r, const double* J, const int* dof, double cost,
                     double most_difference) {
  Record& record = recordOf(place);
  if (record.element == kPending) return;
  ++linearized_;
  addToRss(-record.cost);  // one after the other: their difference would be rounded
  addToRss(cost);
  record.cost = cost;
  if (record.element == kNone) return;
  const std::vector<double>& before = factor_.A(record.element);
  const int rows = factor_.rowsOf(record.element);
  if (!record.is_plain) {
    merge(place, J, dof);
    J = A_.data();
  }
  g_.clear();
  double difference = 0, size = 0;
  const double* b = before.data();
  for (const double* a = J; a < J + before.size();) {
    double sum = 0;
    for (int k = 0; k < rows; ++k, ++a, ++b) {
      sum += *a * r[k];
      difference += (*a - *b) * (*a - *b);
      size += *b * *b;
    }
    g_.push_back(sum);
  }
  factor_.setGradient(record.element, g_);
  if (difference > most_difference * most_difference * size) factor_.setA(record.element, {J, before.size()});
}

/// The Jacobian of an element from those of a measurement, where that has variables without a block, or one twice.
void OnlineFit::merge(Place place, const double* J, const int* dof) {
  const int element = recordOf(place).element, rows = factor_.rowsOf(element);
  const MeasurementPool& pool = *problem_.pools()[at(place.first)];
  const int* const variables = pool.variables(place.second);
  A_.assign(factor_.A(element).size(), 0.0);
  for (int k = 0; k < pool.arity(); ++k) {
    const int entries = rows * dof[k];
    std::size_t start = 0;
    for (const int b : factor_.blocksOf(element)) {
      if (b == variables[k]) {
        for (int e = 0; e < entries; ++e) A_[start + at(e)] += J[e];
        break;
      }
      start += at(rows * factor_.dof(b));
    }
    J += entries;
  }
}

void OnlineFit::linearizeTouched(double most_difference) {
  constexpr std::size_t most = 64;
  for (std::size_t first = 0; first < touched_.size();) {
    std::size_t last = first + 1;
    while (last < touched_.size() && last - first < most && touched_[last].first == touched_[first].first &&
           touched_[last].second == touched_[last - 1].second + 1)
      ++last;
    linearize(touched_[first], static_cast<int>(last - first), most_difference);
    first = last;
  }
}

// ---- steps --------------------------------------------------------------------------------------------------

/// Remembers a step and the measurements that it touches.
void OnlineFit::prepare(const std::vector<IncrementalCholesky::Move>& moves) {
  moved_variables_.clear();
  step_.clear();
  touched_.clear();
  ++visit_;
  for (const auto& [block, d] : moves) {
    moved_variables_.push_back(block);
    step_.insert(step_.end(), d, d + factor_.dof(block));
    touchUsesOf(block);
  }
  std::sort(touched_.begin(), touched_.end());
  moved_ += static_cast<int>(moves.size());
}

/// By a multiple of the last step.
void OnlineFit::moveBy(double factor) {
  const double* d = step_.data();
  std::vector<double> part;
  for (const int v : moved_variables_) {
    part.assign(d, d + factor_.dof(v));
    for (double& x : part) x *= factor;
    problem_.move(v, part.data());
    d += factor_.dof(v);
  }
  value_revision_ = problem_.valueRevision();
}

/// Linearises where a step has led to; whether the RSS is at most this.
bool OnlineFit::isBelow(double most) {
  try {
    linearizeTouched(kStaleOnline);
    return rss() <= most;
  } catch (const Error&) {  // there are no residuals
    return false;
  }
}

/// Takes the step, a part of it or more, such that the RSS falls. Where it does not, the values stay, and the factor gets their Jacobians.
bool OnlineFit::go(double promised) {
  const double before = rss(), most = before + kNoiseOfRss * before;
  moveBy(1);
  if (isBelow(most)) {
    stretch(before, promised);
    return true;
  }
  double length = 1;
  while (!isFarOff(promised, before) && length * kShorterOnline > kShortestOnline) {
    moveBy((kShorterOnline - 1) * length);
    length *= kShorterOnline;
    if (isBelow(most)) return true;
  }
  moveBy(-length);
  linearizeTouched(0);
  return false;
}

/// Goes on along a step that has decreased the RSS by more than was promised, as where losses make the curvature smaller than it is in the
/// factor, or back where it was less, as where large residuals make it larger: to the minimum of the parabola through the promise
/// and the decrease.
void OnlineFit::stretch(double before, double promised) {
  const double after = rss(), ratio = (before - after) / promised;
  if (ratio > kKeptOnline && ratio < kStretched) return;
  const double more = (2 - ratio) * kLongest > 1 ? 1 / (2 - ratio) - 1 : kLongest - 1;
  moveBy(more);
  if (isBelow(after)) return;
  moveBy(-more);
  linearizeTouched(kStaleOnline);
}

bool OnlineFit::run(const UpdateOptions& options, UpdateSummary& summary) {
  try {
    return stepToTolerance(options, summary);
  } catch (...) {  // what was followed is incomplete
    has_started_ = false;
    throw;
  }
}

bool OnlineFit::stepToTolerance(const UpdateOptions& options, UpdateSummary& summary) {
  linearized_ = moved_ = 0;
  factor_.resetWork();
  follow();
  factor_.refactor();
  double share = kShareOnline;
  // What all further steps together promise, relative to the next one: more than 1 where each leaves much to the others.
  double slowness = 1;
  bool is_fresh = false;  // the Jacobians in the factor are those of the current values, where it last moved
  for (int steps = 0;; ++steps) {
    sumAgain();
    const double before = rss(), promised = factor_.promise();
    // Beside the measurements' rounding errors there is no optimum to be found.
    const double allowed = std::max({options.tolerance * before, std::min(rounding_, kMostRoundingOnline),
                                     std::numeric_limits<double>::min()});
    const bool is_near = promised * slowness <= kAimedAt * allowed;
    if (is_near || steps >= options.max_steps) {
      fill(summary, steps, is_near);
      return true;
    }
    prepare(factor_.solve(share * allowed, steps > 0));
    if (steps >= kManySteps) {
      for (const Place& place : touched_) roundAgain(recordOf(place));
    }
    if (!go(promised)) {
      factor_.refactor();
      if (is_fresh || isFarOff(promised, before)) {
        fill(summary, steps + 1, false);
        return false;
      }
      is_fresh = true;
      continue;
    }
    const double decrease = before - rss();
    is_fresh = decrease < kKeptOnline * promised;
    if (is_fresh) {
      linearizeTouched(kSlightlyStale);
      share *= kSmallerShare;
    }
    factor_.refactor();
    slowness = std::max(1.0, decrease / promised) / (1 - std::min(kSlowest, factor_.promise() / promised));
  }
}

void OnlineFit::fill(UpdateSummary& summary, int steps, bool converged) const {
  const IncrementalCholesky::Work& work = factor_.work();
  summary.converged = converged;
  summary.rss = rss();
  summary.promise = factor_.promise();
  summary.steps += steps;
  summary.variables_moved += moved_;
  summary.measurements_linearized += linearized_;
  summary.fronts_factorized += work.fronts_factorized;
  summary.fronts_solved += work.fronts_solved;
  summary.flops += work.flops;
  summary.reordered = summary.reordered || work.reordered_all;
  summary.undetermined.clear();
  for (const auto& [variable, component] : factor_.undetermined()) {
    if (!problem_.activeSet().isHeld(variable, component))
      summary.undetermined.push_back(problem_.componentNames(variable)[at(component)]);
  }
}

}  // namespace slom
