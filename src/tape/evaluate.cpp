/// Evaluation of a tape for many measurements.
#include "tape/evaluate.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#include "slom/tape/tape.hpp"

namespace slom::tape {

namespace {

/// Memory of a thread for registers.
class Arena {
 public:
  Arena() = default;
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() { std::free(memory_); }
  /// Returns room for this many numbers. What was there before is lost.
  double* room(std::size_t numbers) {
    if (numbers > size_) {
      std::free(memory_);
      size_ = 0;
      memory_ = static_cast<double*>(std::aligned_alloc(64, (numbers * sizeof(double) + 63) / 64 * 64));
      if (memory_ == nullptr) throw std::bad_alloc();
      size_ = numbers;
    }
    return memory_;
  }

 private:
  double* memory_ = nullptr;
  std::size_t size_ = 0;
};

const Kernels*& chosenKernels() {
  static const Kernels* chosen = &kernels();
  return chosen;
}

}  // namespace

void evaluateBy(const Kernels& with) { chosenKernels() = &with; }

void Tape::gather(const Source& source, int first, int count, double* arena) const {
  const Kernels& kernels = *chosenKernels();
  const int arity = static_cast<int>(sizes_.size());
  const double* from[kManyLanes];
  const auto fillRest = [&] {  // lanes without a measurement repeat the last one
    for (int k = count; k < lanes_; ++k) from[k] = from[count - 1];
  };
  double* to = arena;
  for (int v = 0; v < arity; ++v) {
    const double* const* next = source.variables + static_cast<std::ptrdiff_t>(first) * arity + v;
    for (int k = 0; k < count; ++k, next += arity) from[k] = *next;
    fillRest();
    kernels.gather(from, sizes_[static_cast<std::size_t>(v)], lanes_, to);
    to += static_cast<std::ptrdiff_t>(sizes_[static_cast<std::size_t>(v)]) * lanes_;
  }
  if (code_.data == 0) return;
  const double* next = source.data + static_cast<std::ptrdiff_t>(first) * code_.data;
  for (int k = 0; k < count; ++k, next += code_.data) from[k] = next;
  fillRest();
  kernels.gather(from, code_.data, lanes_, to);
}

void Tape::evaluate(int count, const Source& source, double* r, double* J) const {
  static thread_local Arena memory;
  const Kernels& kernels = *chosenKernels();
  const auto lanes = static_cast<std::size_t>(lanes_);
  const std::size_t entries = entry_row_.size(), rows = static_cast<std::size_t>(code_.rows);
  const std::size_t registers = (static_cast<std::size_t>(code_.registers) + entries_.size()) * lanes;
  // registers, constant entries, pointers to the rows of outputs, and a place for the last measurements
  double* const arena = memory.room(registers + rows + entries + std::max(rows, entries) * lanes);
  auto** const pointers = reinterpret_cast<const double**>(arena + registers);
  double* const rest = arena + registers + rows + entries;
  const std::size_t inputs = static_cast<std::size_t>(coordinates_ + code_.data);
  for (std::size_t i = 0; i < code_.constants.size(); ++i)
    std::fill_n(arena + (inputs + i) * lanes, lanes, code_.constants[i]);
  for (std::size_t i = 0; i < entries_.size(); ++i)
    std::fill_n(arena + (static_cast<std::size_t>(code_.registers) + i) * lanes, lanes, entries_[i]);
  for (std::size_t i = 0; i < rows; ++i) pointers[i] = arena + (inputs + code_.constants.size() + i) * lanes;
  for (std::size_t i = 0; i < entries; ++i)
    pointers[rows + i] = arena + static_cast<std::size_t>(entry_row_[i]) * lanes;

  const auto& instructions = J == nullptr ? code_.residual : code_.linearization;
  const auto run = lanes_ == kManyLanes ? kernels.run_many : kernels.run_few;
  const auto scatter = [&](const double* const* from, std::size_t size, int used, double*& to) {
    const std::size_t numbers = size * static_cast<std::size_t>(used);
    if (used == lanes_) {
      kernels.scatter(from, static_cast<int>(size), lanes_, to);
    } else {
      kernels.scatter(from, static_cast<int>(size), lanes_, rest);
      std::copy_n(rest, numbers, to);
    }
    to += numbers;
  };
  for (int first = 0; first < count; first += lanes_) {
    const int used = std::min(lanes_, count - first);
    gather(source, first, used, arena);
    run(instructions.data(), instructions.size(), arena);
    scatter(pointers, rows, used, r);
    if (J != nullptr && entries > 0) scatter(pointers + rows, entries, used, J);
  }
}

}  // namespace slom::tape
