/// The exception of the project: a stable id, the subject, its value and the remedy, in one sentence.
#pragma once

#include <cstdio>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace mtk {

/// what() reads `[id] sentence`; id() is stable between versions, so that programs can branch on it. A sentence ends with what
/// to do about it, after its last semicolon.
class Error : public std::runtime_error {
 public:
  /// subject: see subject().
  Error(std::string id, const std::string& sentence, std::string subject = {})
      : std::runtime_error("[" + id + "] " + sentence), id_(std::move(id)), subject_(std::move(subject)) {}

  /// `slom.bad-option`: stable between versions.
  const std::string& id() const noexcept { return id_; }
  /// The name of what the sentence is about: of a variable or of one of its components, of a measurement, an option, an argument, a
  /// file or its line, the type of a handle. `pose[3].pos.x`; empty where nothing has a name.
  const std::string& subject() const noexcept { return subject_; }
  /// `max_seconds is -1; pass a positive number`
  std::string_view sentence() const noexcept { return std::string_view(what()).substr(id_.size() + 3); }
  /// `pass a positive number`; empty where nothing can be done.
  std::string_view remedy() const noexcept {
    const std::size_t end = endOfFault();
    return end == std::string_view::npos ? std::string_view() : sentence().substr(end + 2);
  }
  /// `max_seconds is -1`: the sentence without the remedy.
  std::string_view fault() const noexcept { return sentence().substr(0, endOfFault()); }

 private:
  /// The last semicolon that is not part of the subject's name.
  std::size_t endOfFault() const noexcept {
    const std::size_t end = sentence().rfind("; "), name = sentence().rfind(subject_);
    const bool is_in_name = end != std::string_view::npos && name != std::string_view::npos && name < end &&
                            end < name + subject_.size();
    return is_in_name ? std::string_view::npos : end;
  }

  std::string id_, subject_;
};

namespace detail {

/// The number as printf writes it, with a decimal point whatever the locale of C.
[[gnu::noinline, gnu::cold]] inline std::string classicText(const char* format, double x) {
  if (x != x) return "nan";
  char number[400];
  std::snprintf(number, sizeof number, format, x);
  std::string text;
  for (const char* c = number; *c != 0; ++c) {
    const bool is_plain = (*c >= '0' && *c <= '9') || (*c >= 'a' && *c <= 'z') || *c == '-' || *c == '+';
    if (is_plain) {
      text += *c;
    } else if (text.empty() || text.back() != '.') {  // a decimal sign may have several bytes
      text += '.';
    }
  }
  return text;
}

/// Throws an error whose sentence has numbers in its middle: `before`(1, 2.5, 0)`after`.
[[noreturn, gnu::noinline, gnu::cold]] inline void raiseBadNumbers(const char* id, const char* before,
                                                                   std::initializer_list<double> numbers,
                                                                   const char* after) {
  std::string text = before;
  for (const double& x : numbers) {
    text += (&x == numbers.begin() ? "(" : ", ") + classicText("%.6g", x);
  }
  throw Error(id, text + ")" + after);
}

}  // namespace detail
}  // namespace mtk

namespace MTK = mtk;
