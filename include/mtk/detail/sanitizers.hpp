/// Used by the library: whether the program is compiled for the address or the thread sanitizer.
#pragma once

#include "mtk/detail/cpp20.hpp"

// g++ defines macros, clang has features.
#if defined(__SANITIZE_ADDRESS__)
#define MTK_ADDRESS_SANITIZER
#elif defined(__SANITIZE_THREAD__)
#define MTK_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define MTK_ADDRESS_SANITIZER
#elif __has_feature(thread_sanitizer)
#define MTK_THREAD_SANITIZER
#endif
#endif
