#include "model/allocations.hpp"

#include <cstdlib>
#include <new>

#include "mtk/detail/sanitizers.hpp"

namespace {

std::size_t count = 0;

}  // namespace

#if !defined(MTK_ADDRESS_SANITIZER)
void* operator new(std::size_t size) {
  ++count;
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace slom::testing {

std::size_t allocations() { return count; }

}  // namespace slom::testing
