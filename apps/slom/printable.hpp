// Text of others (names of files, tags, messages) as it may stand where it goes to.
#pragma once

#include <string>
#include <string_view>

namespace slom::app {

/// The text for terminals: control characters other than newline and tab, and bytes that are not UTF-8, are escaped as \x1b.
std::string printable(std::string_view text);

/// The same without lines and columns: newline as \x0a, tab as \x09. For names of files, and sentences that contain them,
/// before they enter a text of several lines.
std::string oneLine(std::string_view text);

/// The text for elements and attributes of XML 1.0 in UTF-8: & < > " are escaped; characters that XML does not allow become the
/// replacement character.
std::string xmlText(std::string_view text);

/// To standard output and standard error, printable. Throws nothing; main() finds out that standard output is
/// lost.
void say(const std::string& text);
void sayError(const std::string& text);

}  // namespace slom::app
