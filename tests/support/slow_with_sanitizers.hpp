#pragma once
// Tests that take long with sanitizers and run no other code than smaller ones.

#include <gtest/gtest.h>

// What the sanitizers' libraries define, in programs that are linked with them.
extern "C" {
__attribute__((weak)) void __asan_init();
__attribute__((weak)) void __tsan_init();
}

namespace slom::testing {

/// The program runs under the address or the thread sanitizer. The test itself may be compiled without: see SLOM_TEST_OBJECTS.
inline bool hasSanitizers() { return __asan_init != nullptr || __tsan_init != nullptr; }

}  // namespace slom::testing

#define SLOM_SKIP_WITH_SANITIZERS()     \
  if (::slom::testing::hasSanitizers()) \
  GTEST_SKIP() << "takes long with sanitizers; the smaller data sets run the same code"
