// Foreign text (names of files, tags, messages) made safe for its destination.
#pragma once

#include <string>
#include <string_view>

namespace slom::app {

/// Returns the text for terminals. Control characters except newline and tab, and bytes that are not UTF-8, are escaped
/// as \x1b.
std::string printable(std::string_view text);

/// Returns the text as one line: also escapes newline as \x0a and tab as \x09. For names of files, and sentences that
/// contain them, before they enter a text of several lines.
std::string oneLine(std::string_view text);

/// Returns the text for elements and attributes of XML 1.0 in UTF-8. & < > " are escaped; characters that XML does not
/// allow become the replacement character.
std::string xmlText(std::string_view text);

/// Prints to standard output, and sayError() to standard error, made printable. Throws nothing; main() detects the loss
/// of standard output.
void say(const std::string& text);
void sayError(const std::string& text);

}  // namespace slom::app
