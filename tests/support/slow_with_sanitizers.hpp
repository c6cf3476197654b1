#pragma once
// Tests that take long with sanitizers and run no other code than smaller ones.

#include <gtest/gtest.h>

namespace slom::testing {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool has_sanitizers = true;
#else
inline constexpr bool has_sanitizers = false;
#endif
}  // namespace slom::testing

#define SLOM_SKIP_WITH_SANITIZERS()    \
  if (::slom::testing::has_sanitizers) \
  GTEST_SKIP() << "takes long with sanitizers; the smaller data sets run the same code"
