// Text files in pieces of constant memory.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "slom/io/numbered_lines.hpp"

namespace slom::io {

/// Calls f with the lines of a file in pieces of some megabytes, numbered from 1. Throws as readLinesOfPart() does.
void forEachPiece(const std::string& file, const std::function<void(const NumberedLines&)>& f);

/// Hands out text in pieces.
class TextPieces {
 public:
  explicit TextPieces(const std::function<void(std::string_view)>& f) : f_(f) {}
  std::string& text() {
    if (text_.size() > (std::size_t{1} << 20)) flush();
    return text_;
  }
  void flush() {
    if (!text_.empty()) f_(text_);
    text_.clear();
  }

 private:
  const std::function<void(std::string_view)>& f_;
  std::string text_;
};

}  // namespace slom::io
