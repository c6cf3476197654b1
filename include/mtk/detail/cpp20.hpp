/// A check that stops compilers not set to C++20 with one sentence instead of a thousand errors.
#pragma once

#if defined(_MSVC_LANG)
#define MTK_CPLUSPLUS _MSVC_LANG
#else
#define MTK_CPLUSPLUS __cplusplus
#endif
#if MTK_CPLUSPLUS < 202002L
#error "SLoM needs C++20: compile with -std=c++20, in CMake by the feature cxx_std_20"
#include <SLoM needs C++20: compile with -std=c++20>  // no such file: ends the compilation, as #error may not
#endif
#undef MTK_CPLUSPLUS
