/// An online fit follows changes of the problem: elements of the factor for measurements, blocks for free variables.
#include <algorithm>
#include <utility>

#include "base/index.hpp"
#include "online/online_fit.hpp"

namespace slom {

void OnlineFit::follow(bool remembers_new) {
  const auto changes = has_started_ ? problem_.changesSince(structure_revision_) : std::nullopt;
  if (!changes) {
    startAgain();
  } else {
    records_.resize(problem_.pools().size());
    for (const Change& change : *changes) {
      if (change.kind == Change::Kind::measurement_inserted) {
        records_[at(change.pool)].emplace_back().is_new = true;
        pending_.emplace_back(change.pool, change.index);
      } else if (change.kind == Change::Kind::measurement_removed) {
        std::vector<Record>& records = records_[at(change.pool)];
        dropElement(records[at(change.index)]);
        records[at(change.index)] = records.back();
        records.pop_back();
        pending_.emplace_back(change.pool, change.index);  // the moved one may not be an element yet
      } else {
        touched_variables_.push_back(change.index);
        if (change.kind != Change::Kind::variable_inserted) forgetTrialValues(true);
      }
    }
  }
  structure_revision_ = problem_.structureRevision();
  forgetTrialValues(!changes);
  followVariables();
  followMoves();
  for (const Place& place : pending_) {
    if (place.second < static_cast<int>(records_[at(place.first)].size()) &&
        recordOf(place).element == kPending)
      makeElement(place, remembers_new);
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

/// Inserts blocks for variables that have become free, and removes those of variables that are no longer free. Makes
/// new elements of their measurements.
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
    if (has_block && known == record.serial) {  // only other components are fixed
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
  value_revision_ = problem_.valueRevision();
  linearizeTouched(0);
}

std::vector<OnlineFit::Place> OnlineFit::usesOf(int variable) const {
  std::vector<Place> places;
  problem_.forEachUse(variable,
                      [&](const MeasurementPool& pool, int i) { places.emplace_back(pool.index(), i); });
  return places;
}

/// Adds the variable's measurements to touched_, each once since visit_ changed.
void OnlineFit::touchUsesOf(int variable) {
  problem_.forEachUse(variable, [&](const MeasurementPool& pool, int i) {
    const Place place(pool.index(), i);
    if (std::exchange(recordOf(place).visited, visit_) != visit_) touched_.push_back(place);
  });
}

void OnlineFit::dropElement(Record& record) {
  addToRss(-record.cost);
  rounding_ -= record.rounding;
  if (record.element >= 0) factor_.removeElement(record.element);
  record = {.is_new = record.is_new};
}

void OnlineFit::makeElement(Place place, bool remembers_new) {
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
  if (std::exchange(record.is_new, false) && remembers_new && record.element >= 0 &&
      pool.lossOf(place.second) != nullptr)
    waiting_.push_back({place.first, pool.handleOf(place.second)});
}

}  // namespace slom
