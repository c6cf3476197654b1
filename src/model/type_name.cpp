#include "slom/model/type_name.hpp"

#include <cctype>

namespace slom {

namespace {

void eraseAll(std::string& text, std::string_view part) {
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at))
    text.erase(at, part.size());
}

/// Removes `qualifier::` before names: everything from the start of a name up to its last `::`.
std::string withoutQualifiers(const std::string& text) {
  std::string result;
  std::size_t name_start = 0;  // in result
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == ':' && i + 1 < text.size() && text[i + 1] == ':') {
      result.resize(name_start);
      ++i;
      continue;
    }
    result += text[i];
    const bool in_name = std::isalnum(static_cast<unsigned char>(text[i])) || text[i] == '_';
    if (!in_name) name_start = result.size();
  }
  return result;
}

}  // namespace

std::string readableTypeName(std::string_view compiler_text) {
  if (compiler_text.find("lambda") != std::string_view::npos) return "lambda";
  std::string text(compiler_text);
  eraseAll(text, "(anonymous namespace)::");
  eraseAll(text, "{anonymous}::");
  // A type that is local to a function: `f(int)::Name`.
  if (const auto local = text.rfind(")::"); local != std::string::npos) text.erase(0, local + 3);
  text = withoutQualifiers(text);
  eraseAll(text, "<double>");
  eraseAll(text, ", double");
  for (auto at = text.find(" >"); at != std::string::npos; at = text.find(" >")) text.erase(at, 1);
  eraseAll(text, "<>");
  return text;
}

std::string detail::typeNameIn(const char* function) {
  std::string_view text = function;
  text.remove_prefix(text.find("T = ") + 4);
  const auto end = text.find("; std::string");  // gcc appends the meaning of std::string
  return readableTypeName(text.substr(0, end == std::string_view::npos ? text.rfind(']') : end));
}

}  // namespace slom
