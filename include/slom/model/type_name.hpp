/// Names of types for messages, without the noise of namespaces and default arguments.
#pragma once

#include <string>
#include <string_view>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// `mtk::trafo<mtk::SO3<double> >` becomes `trafo<SO3>`, a type inside a function loses the function.
std::string readableTypeName(std::string_view compiler_text);

namespace detail {
/// The readable name of the type T in what a compiler calls `f() [with T = X; ...]` (gcc) or `f() [T = X]` (clang).
std::string typeNameIn(const char* function);
}  // namespace detail

/// The type's name as the user would write it.
template <class T>
std::string typeName() {
  return detail::typeNameIn(__PRETTY_FUNCTION__);
}

}  // namespace slom
