/// Prefetching of memory that will be written soon.
#pragma once

namespace slom::dense {

inline void prefetch([[maybe_unused]] const double* first, [[maybe_unused]] const double* last) {
#if defined(__GNUC__)
  for (; first < last; first += 8) __builtin_prefetch(first, 1);
#endif
}

}  // namespace slom::dense
