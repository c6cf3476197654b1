#pragma once
// Tests that take long with sanitizers and run no other code than smaller ones.

#include <gtest/gtest.h>

#include "mtk/detail/sanitizers.hpp"

namespace slom::testing {

/// Returns whether the program runs under the address or the thread sanitizer.
constexpr bool hasSanitizers() {
#if defined(MTK_ADDRESS_SANITIZER) || defined(MTK_THREAD_SANITIZER)
  return true;
#else
  return false;
#endif
}

}  // namespace slom::testing

#define SLOM_SKIP_WITH_SANITIZERS()     \
  if (::slom::testing::hasSanitizers()) \
  GTEST_SKIP() << "takes long with sanitizers; the smaller data sets run the same code"
