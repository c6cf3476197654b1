/// Names of types for messages, without the noise of namespaces and default arguments.
#pragma once

#include <string>
#include <string_view>

namespace slom {

/// `mtk::trafo<mtk::SO3<double> >` becomes `trafo<SO3>`, a type inside a function loses the function.
std::string readableTypeName(std::string_view compiler_text);

/// The type's name as the user would write it.
template <class T>
std::string typeName() {
  std::string_view text = __PRETTY_FUNCTION__;  // "... [with T = X; ...]" (gcc), "... [T = X]" (clang)
  text.remove_prefix(text.find("T = ") + 4);
  const auto end = text.find("; std::string");  // gcc appends what std::string is
  text = text.substr(0, end == std::string_view::npos ? text.rfind(']') : end);
  return readableTypeName(text);
}

}  // namespace slom
