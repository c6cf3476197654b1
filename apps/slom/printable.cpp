#include "printable.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdio>

#include <fmt/format.h>

namespace slom::app {

namespace {

/// The first character of a text. Its length is 0 if the first byte begins no character.
struct Character {
  std::uint32_t code = 0;
  std::size_t length = 0;
};

/// Reads UTF-8 by RFC 3629: the shortest form, no surrogates, nothing beyond U+10FFFF.
Character firstOf(std::string_view text) {
  const auto byte = [&](std::size_t i) { return std::uint32_t(static_cast<unsigned char>(text[i])); };
  const std::uint32_t first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {};
  std::uint32_t code = first & (0x7F >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3F);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < least[length] || code > 0x10FFFF || is_surrogate) return {};
  return {code, length};
}

/// Calls `write(character, its bytes)` for each character. Bytes that begin no character are passed one at a time.
template <class F>
void forEach(std::string_view text, const F& write) {
  while (!text.empty()) {
    const Character character = firstOf(text);
    const std::size_t length = character.length == 0 ? 1 : character.length;
    write(character, text.substr(0, length));
    text.remove_prefix(length);
  }
}

std::string escaped(std::string_view text, std::string_view allowed) {
  std::string result;
  forEach(text, [&](const Character& character, std::string_view bytes) {
    const bool is_control = character.code < 0x20 || (character.code >= 0x7F && character.code < 0xA0);
    const bool is_allowed = bytes.size() == 1 && allowed.find(bytes[0]) != std::string_view::npos;
    if (is_allowed || (character.length > 0 && !is_control)) {
      result += bytes;
    } else {
      for (const char c : bytes) result += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    }
  });
  return result;
}

}  // namespace

std::string printable(std::string_view text) { return escaped(text, "\n\t"); }

std::string oneLine(std::string_view text) { return escaped(text, ""); }

std::string xmlText(std::string_view text) {
  std::string result;
  forEach(text, [&](const Character& character, std::string_view bytes) {
    switch (character.code) {
      case '&':
        result += "&amp;";
        return;
      case '<':
        result += "&lt;";
        return;
      case '>':
        result += "&gt;";
        return;
      case '"':
        result += "&quot;";
        return;
      default:
        break;
    }
    const bool is_character = character.length > 0 && character.code != 0xFFFE && character.code != 0xFFFF &&
                              (character.code >= 0x20 || character.code == '\t' || character.code == '\n');
    result += is_character ? bytes : std::string_view("\xEF\xBF\xBD");
  });
  return result;
}

void say(const std::string& text) { std::fputs(printable(text).c_str(), stdout); }

void sayError(const std::string& text) {
  std::fflush(stdout);  // both may go to one file
  std::fputs(printable(text).c_str(), stderr);
}

}  // namespace slom::app
