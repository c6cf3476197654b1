/// An array of numbers with undefined initial values. If the system has huge pages, a large array is placed on them.
/// Otherwise, handing out small pages would take most of the time of a first factorisation.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace slom::dense {

class BigArray {
 public:
  BigArray() = default;
  BigArray(const BigArray& other) = delete;
  BigArray& operator=(const BigArray& other) = delete;
  BigArray(BigArray&&) = default;
  BigArray& operator=(BigArray&&) = default;

  /// Resizes the array and discards its content.
  void resize(std::size_t size) {
    if (size <= capacity_) return;
    numbers_.reset();
    capacity_ = 0;
    const bool is_large = size * sizeof(double) >= 2 * kHugePage;
    const std::size_t page = is_large ? kHugePage : kSmallAlignment;
    const std::size_t bytes = (size * sizeof(double) + page - 1) / page * page;
    numbers_.reset(static_cast<double*>(std::aligned_alloc(page, bytes)));
    if (!numbers_) throw std::bad_alloc();
    capacity_ = size;
#ifdef __linux__
    if (is_large) madvise(numbers_.get(), bytes, MADV_HUGEPAGE);  // a hint: nothing depends on it
#endif
  }
  double* data() { return numbers_.get(); }
  const double* data() const { return numbers_.get(); }

 private:
  static constexpr std::size_t kHugePage = std::size_t{1} << 21, kSmallAlignment = 64;
  struct Free {
    void operator()(double* p) const { std::free(p); }
  };
  std::unique_ptr<double, Free> numbers_;
  std::size_t capacity_ = 0;
};

}  // namespace slom::dense
