#include "slom/problem/measurement_pool.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "problem/group_keys.hpp"
#include "problem/guarded.hpp"
#include "problem/pool_parts.hpp"

namespace slom {

namespace {
/// Returns the sum of the degrees of freedom of all variables; Dynamic unless all are fixed at compile time.
int columnsOf(const MeasurementType& type) {
  if (type.dof == nullptr) return Dynamic;
  int sum = 0;
  for (int k = 0; k < type.arity; ++k) {
    if (type.dof[k] == Dynamic) return Dynamic;
    sum += type.dof[k];
  }
  return sum;
}
}  // namespace

MeasurementPool::MeasurementPool(const std::string& name, const std::string& label,
                                 const MeasurementType& type, const std::vector<VariableRecord>& table,
                                 const ActiveSet& active)
    : name_(name),
      label_(label),
      type_(type),
      arity_(type.arity),
      columns_(columnsOf(type)),
      table_(table),
      active_(active),
      losses_(new Losses),
      group_keys_(nullptr),
      presence_(std::make_shared<PoolPresence>(PoolPresence{this})),
      origins_(nullptr) {}

MeasurementPool::SavedNoise MeasurementPool::saveNoise() const { return {noise_kind_, noise_at_, noise_}; }

void MeasurementPool::restoreNoise(SavedNoise&& noise) noexcept {
  noise_kind_.swap(noise.kind);
  noise_at_.swap(noise.place);
  noise_.swap(noise.numbers);
}

MeasurementPool::~MeasurementPool() { presence_->pool = nullptr; }

const RuntimeMeasurement* MeasurementPool::runtimeMeasurement(int) const { return nullptr; }

std::string MeasurementPool::measurementName(int i) const {
  return name_ + " #" + std::to_string(serial_[at(i)]);
}
std::string MeasurementPool::nextName() const { return name_ + " #" + std::to_string(*inserted_ + 1); }

int MeasurementPool::sumOfDof(int i) const {
  int sum = 0;
  for (int k = 0; k < arity_; ++k) sum += table_[at(variables(i)[k])].dof;
  return sum;
}

void MeasurementPool::sizes(int first, int last, int* row, int* dof) const {
  const int* variable = variables(first);
  const auto is_fixed = [&](int k) { return type_.dof != nullptr && type_.dof[k] != Dynamic; };
  for (int i = first; i < last; ++i) {
    *row++ = rows(i);
    for (int k = 0; k < arity_; ++k, ++variable)
      *dof++ = is_fixed(k) ? type_.dof[k] : table_[at(*variable)].dof;
  }
}

SlotRef MeasurementPool::insert(void* measurement, const int* variables, const NoiseView& noise,
                                const Loss& loss) {
  int rows = type_.rows;
  if (rows == Dynamic) {
    const int next = size();
    rows = guarded(next, [&] { return lengthOf(measurement); });
  }
  reserveOne();
  const Loss* const kept_loss = keepLoss(loss);
  WhiteningKind kind = WhiteningKind::unit;
  const std::size_t noise_at = appendNoise(noise, rows, kind);
  push(measurement);
  if (type_.rows == Dynamic) rows_.push_back(rows);
  total_rows_ += rows;
  return append(variables, kind, noise_at, kept_loss);
}

int MeasurementPool::indexOf(SlotRef ref) const {
  if (has(ref)) return index_of_slot_[ref.slot];
  throw Error("slom.stale-handle",
              "the MeasID<" + name_ +
                  "> refers to a measurement that has been removed; keep the MeasID that "
                  "insertMeasurement returned last",
              "MeasID<" + name_ + ">");
}

void MeasurementPool::reserveOne() {
  const auto grow = [](auto& v, std::size_t more) {
    if (v.size() + more > v.capacity()) v.reserve(std::max(2 * v.capacity(), v.size() + more));
  };
  grow(variables_, at(arity_));
  if (type_.rows == Dynamic) grow(rows_, 1);
  grow(noise_kind_, 1);
  grow(noise_at_, 1);
  grow(loss_, 1);
  grow(serial_, 1);
  grow(slot_, 1);
  grow(index_of_slot_, 1);
  grow(generation_, 1);
  grow(free_slots_, index_of_slot_.size() + 1 - free_slots_.size());  // so remove() cannot fail
}

std::size_t MeasurementPool::appendNoise(const NoiseView& noise, int rows, WhiteningKind& kind) {
  const std::size_t start = noise_.size();
  kind = appendWhitening(noise, rows, noise_, [&] { return nextName(); });
  const std::size_t size = noise_.size() - start;
  // Most measurements of a kind have the same uncertainty. Such a measurement shares the numbers of the one before it.
  if (size > 0 && !noise_kind_.empty() && noise_kind_.back() == kind) {
    const std::size_t last = noise_at_.back();
    if (last + size <= start && std::equal(noise_.begin() + static_cast<std::ptrdiff_t>(start), noise_.end(),
                                           noise_.begin() + static_cast<std::ptrdiff_t>(last))) {
      noise_.resize(start);
      return last;
    }
  }
  return start;
}

void MeasurementPool::scaleSigmas(const std::vector<double>& factors) {
  constexpr std::size_t unit = ~std::size_t{0};  // a place that stands for W = I
  std::vector<double> scaled;
  std::vector<WhiteningKind> kinds = noise_kind_;
  std::vector<std::size_t> places(noise_at_.size(), 0);
  std::map<std::pair<std::size_t, double>, std::size_t> known;  // place of W times that number
  for (int i = 0; i < size(); ++i) {
    const bool is_unit = noise_kind_[at(i)] == WhiteningKind::unit;
    const double by = 1 / factors[at(i)];
    if (is_unit && by == 1) continue;
    const std::size_t from = is_unit ? unit : noise_at_[at(i)];
    const auto [place, is_new] = known.try_emplace({from, by}, scaled.size());
    places[at(i)] = place->second;
    if (is_unit) kinds[at(i)] = WhiteningKind::scalar;
    if (!is_new) continue;
    const int count = whiteningSize(kinds[at(i)], rows(i));
    for (int k = 0; k < count; ++k) scaled.push_back(by * (is_unit ? 1 : noise_[from + at(k)]));
  }
  noise_ = std::move(scaled);
  noise_kind_ = std::move(kinds);
  noise_at_ = std::move(places);
}

const Loss* MeasurementPool::keepLoss(const Loss& loss) {
  if (loss.kind() == nullptr) return nullptr;
  checkLoss(loss, [&] { return nextName(); });
  return &*losses_->all.insert(loss).first;
}

SlotRef MeasurementPool::append(const int* variables, WhiteningKind kind, std::size_t noise_at,
                                const Loss* loss) {
  const int index = size();
  variables_.insert(variables_.end(), variables, variables + arity_);
  noise_kind_.push_back(kind);
  noise_at_.push_back(noise_at);
  loss_.push_back(loss);
  if (loss != nullptr) ++loss_count_;
  serial_.push_back(++*inserted_);
  std::uint32_t slot = static_cast<std::uint32_t>(index_of_slot_.size());
  if (free_slots_.empty()) {
    index_of_slot_.push_back(index);
    generation_.push_back(0);
  } else {
    slot = free_slots_.back();
    free_slots_.pop_back();
    index_of_slot_[slot] = index;
  }
  slot_.push_back(slot);
  return {slot, generation_[slot]};
}

void MeasurementPool::remove(int i) {
  const std::size_t hole = at(i), last = slot_.size() - 1;
  total_rows_ -= rows(i);
  moveLastTo(i);
  if (type_.rows == Dynamic) {
    rows_[hole] = rows_[last];
    rows_.pop_back();
  }
  if (loss_[hole] != nullptr) --loss_count_;
  if (group_keys_) group_keys_->remove(hole, last);
  free_slots_.push_back(slot_[hole]);
  ++generation_[slot_[hole]];
  index_of_slot_[slot_[hole]] = -1;
  if (hole != last) {
    std::copy_n(variables_.begin() + static_cast<std::ptrdiff_t>(last * at(arity_)), arity_,
                variables_.begin() + static_cast<std::ptrdiff_t>(hole * at(arity_)));
    noise_kind_[hole] = noise_kind_[last];
    noise_at_[hole] = noise_at_[last];
    loss_[hole] = loss_[last];
    serial_[hole] = serial_[last];
    slot_[hole] = slot_[last];
    index_of_slot_[slot_[hole]] = i;
  }
  variables_.resize(last * at(arity_));
  noise_kind_.pop_back();
  noise_at_.pop_back();
  loss_.pop_back();
  serial_.pop_back();
  slot_.pop_back();
  if (++removed_since_compaction_ > size() + 64) compact();
}

/// Frees the noise and the losses that no measurement uses any more.
void MeasurementPool::compact() {
  compactNoise();
  const std::set<const Loss*> used(loss_.begin(), loss_.end());
  std::erase_if(losses_->all, [&](const Loss& loss) { return !used.contains(&loss); });
  removed_since_compaction_ = 0;
}

void MeasurementPool::compactNoise() {
  std::vector<double> compact;
  std::map<std::size_t, std::size_t> moved;  // old place of W, new place
  for (int i = 0; i < size(); ++i) {
    const auto [place, is_new] = moved.try_emplace(noise_at_[at(i)], compact.size());
    if (is_new) {
      const auto from = noise_.begin() + static_cast<std::ptrdiff_t>(noise_at_[at(i)]);
      compact.insert(compact.end(), from, from + whiteningSize(noise_kind_[at(i)], rows(i)));
    }
    noise_at_[at(i)] = place->second;
  }
  noise_ = std::move(compact);
}

}  // namespace slom
