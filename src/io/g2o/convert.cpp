// A graph in a container has a section for each tag. A record has the line of the text file, the ids and the numbers.
#include "io/g2o/convert.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "io/g2o/line_forms.hpp"
#include "io/g2o/lines.hpp"
#include "io/pieces.hpp"
#include "slom/io/g2o.hpp"

namespace slom::io {

namespace g2o {

namespace {

constexpr std::uint64_t no_line = std::numeric_limits<std::uint64_t>::max();

/// Returns the number of the line's form; -1 if the tag is unknown.
int formOf(const std::vector<LineForm>& forms, const Lines& line) {
  const auto found =
      std::find_if(forms.begin(), forms.end(), [&](const LineForm& form) { return form.name == line.tag(); });
  return found == forms.end() ? -1 : int(found - forms.begin());
}

/// Calls f(words) for each record of the line: one, or one for each id of a FIX line.
template <class F>
void forEachRecord(Lines& line, const LineForm& form, const F& f) {
  line.expect(form.words, form.form);
  std::vector<std::uint64_t> words;
  do {
    words.assign(1, std::uint64_t(line.lineNumber()));
    for (int i = 0; i < form.ids; ++i) words.push_back(line.id());
    for (int i = form.ids; i < form.words; ++i) words.push_back(std::bit_cast<std::uint64_t>(line.number()));
    f(words);
  } while (form.words == form.ids && !line.atEnd());
  line.finish();
}

/// Appends the line of a record, without a line feed.
void appendLine(std::string& text, const ContainerSection& section, std::span<const std::uint64_t> words) {
  text += section.name;
  for (std::size_t k = 1; k < words.size(); ++k) {
    if (int(k) < section.whole) {
      fmt::format_to(std::back_inserter(text), " {}", words[k]);
    } else {
      fmt::format_to(std::back_inserter(text), " {}", std::bit_cast<double>(words[k]));
    }
  }
}

/// Throws for a section that lineForms() does not have.
void requireKnownSections(const Container& container) {
  container.requireContent(ContainerContent::graph);
  const std::vector<LineForm> forms = lineForms();
  for (const ContainerSection& section : container.sections()) {
    const bool is_known = std::any_of(forms.begin(), forms.end(), [&](const LineForm& form) {
      return form.name == section.name && section.whole == 1 + form.ids &&
             section.real == form.words - form.ids;
    });
    if (is_known) continue;
    fail("other-container",
         fmt::format(
             "{}: this slom does not know the section {} of the container; convert the text file again",
             container.file(), shortened(section.name, 40)),
         container.file());
  }
}

/// The records of a section one after another, a small piece of them in memory.
class Cursor {
 public:
  Cursor(const Container& container, const ContainerSection& section)
      : container_(container), section_(section) {
    fill();
  }
  /// Returns the line of the record; no_line at the end.
  std::uint64_t line() const { return words_.empty() ? no_line : words_[at_]; }
  void appendTo(std::string& text) const { appendLine(text, section_, {&words_[at_], width()}); }
  void next() {
    at_ += width();
    if (at_ == words_.size()) fill();
  }

 private:
  std::size_t width() const { return std::size_t(section_.words()); }
  void fill() {
    constexpr std::uint64_t piece = 2000;
    const std::uint64_t end = std::min(section_.count, read_ + piece);
    words_.clear();
    at_ = 0;
    container_.read(section_, {read_, end}, [&](std::uint64_t, std::span<const std::uint64_t> words) {
      words_.insert(words_.end(), words.begin(), words.end());
    });
    read_ = end;
  }

  const Container& container_;
  const ContainerSection& section_;
  std::uint64_t read_ = 0;
  std::vector<std::uint64_t> words_;
  std::size_t at_ = 0;
};

}  // namespace

UnknownTags writeContainer(const std::string& text_file, int descriptor, const std::string& name) {
  const std::vector<LineForm> forms = lineForms();
  std::vector<ContainerSection> sections;
  for (const LineForm& form : forms)
    sections.push_back(
        {.name = std::string(form.name), .whole = 1 + form.ids, .real = form.words - form.ids});
  UnknownTags unknown;
  const auto forEachLine = [&](const auto& f) {
    forEachPiece(text_file, [&](const NumberedLines& lines) {
      Lines line(text_file, lines);
      while (line.next()) f(line, formOf(forms, line));
    });
  };
  forEachLine([&](Lines& line, int form) {
    if (form < 0) return unknown.add(line.tag());
    forEachRecord(line, forms[std::size_t(form)], [&](const auto&) { ++sections[std::size_t(form)].count; });
  });
  // Sections without records are left out.
  std::vector<std::size_t> place(forms.size());
  std::vector<ContainerSection> used;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    place[i] = used.size();
    if (sections[i].count > 0) used.push_back(sections[i]);
  }
  if (used.empty())
    fail("no-edges",
         text_file +
             ": no line has a known tag; give a pose graph of g2o or TORO, or a bundle adjustment of BAL",
         text_file);
  ContainerWriter writer(descriptor, name, ContainerContent::graph, used);
  forEachLine([&](Lines& line, int form) {
    if (form < 0) return;
    forEachRecord(line, forms[std::size_t(form)],
                  [&](const auto& words) { writer.add(place[std::size_t(form)], words); });
  });
  writer.finish();
  return unknown;
}

void readAsText(const Container& container, const std::function<void(std::string_view)>& f) {
  requireKnownSections(container);
  std::vector<Cursor> cursors;
  for (const ContainerSection& section : container.sections()) cursors.emplace_back(container, section);
  TextPieces pieces(f);
  for (;;) {
    const auto first = std::min_element(cursors.begin(), cursors.end(),
                                        [](const Cursor& a, const Cursor& b) { return a.line() < b.line(); });
    if (first == cursors.end() || first->line() == no_line) break;
    first->appendTo(pieces.text());
    pieces.text() += '\n';
    first->next();
  }
  pieces.flush();
}

}  // namespace g2o

NumberedLines readLinesOfPart(const Container& container, int part, int parts) {
  g2o::requireKnownSections(container);
  NumberedLines lines;
  std::string text;
  for (const ContainerSection& section : container.sections()) {
    container.read(section, rangeOf(section, part, parts),
                   [&](std::uint64_t, std::span<const std::uint64_t> words) {
                     text.clear();
                     g2o::appendLine(text, section, words);
                     lines.add(text, int(std::min<std::uint64_t>(words[0], std::numeric_limits<int>::max())));
                   });
  }
  return lines;
}

}  // namespace slom::io
