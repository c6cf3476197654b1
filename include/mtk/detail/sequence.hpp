/// Preprocessor macros that walk lists of the published form `((Type, name)) ((Type, name)) ...`.
#pragma once

#include "mtk/detail/cpp20.hpp"

#define MTK_APPEND_END_(...) __VA_ARGS__##_END
#define MTK_APPEND_END(...) MTK_APPEND_END_(__VA_ARGS__)

/// MTK_SEQUENCE(MACRO, list): MACRO_A takes the first pair and leaves the name of the macro for the second one, and so
/// on. The name left at the end becomes NAME_END, which is defined empty.
#define MTK_SEQUENCE(MACRO, list) MTK_APPEND_END(MACRO##_A list)

#define MTK_PAIR_NAME(type, name) name
#define MTK_PAIR_TYPE(type, name) type
