/// Names of types for messages, without namespaces and default arguments.
#pragma once

#include <string>
#include <string_view>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// Returns a readable name: `mtk::trafo<mtk::SO3<double> >` becomes `trafo<SO3>`, and a type inside a function loses
/// the function.
std::string readableTypeName(std::string_view compiler_text);

namespace detail {
/// Returns the readable name of the type T in the compiler's text `f() [with T = X; ...]` (gcc) or `f() [T = X]`
/// (clang).
std::string typeNameIn(const char* function);
}  // namespace detail

/// Returns the type's name as the user would write it.
template <class T>
std::string typeName() {
  return detail::typeNameIn(__PRETTY_FUNCTION__);
}

}  // namespace slom
