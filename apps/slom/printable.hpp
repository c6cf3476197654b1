// Text of others (names of files, tags, messages) as it may stand where it goes to.
#pragma once

#include <string>
#include <string_view>

namespace slom::app {

/// For terminals: control characters other than the end of a line and a tabulator, and bytes that are no
/// UTF-8, as \x1b.
std::string printable(std::string_view text);

/// The same without lines and columns: the end of a line as \x0a, a tabulator as \x09. For names of files,
/// and sentences that hold some, before they enter a text of several lines.
std::string oneLine(std::string_view text);

/// For elements and attributes of XML 1.0 in UTF-8: & < > " escaped; what no such text may hold, as the
/// replacement character.
std::string xmlText(std::string_view text);

/// To standard output and standard error, printable. Throws nothing; main() finds out that standard output is
/// lost.
void say(const std::string& text);
void sayError(const std::string& text);

}  // namespace slom::app
