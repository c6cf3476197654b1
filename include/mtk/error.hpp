/// The exception of the project. Its one sentence has a stable id, the subject, the value and the remedy.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "mtk/detail/cpp20.hpp"

namespace mtk {

/// what() reads `[id] sentence`. The id is stable between versions, so programs can branch on it. The sentence ends
/// with the remedy, after its last semicolon.
class Error : public std::runtime_error {
 public:
  /// Creates the error. `subject`: see subject().
  Error(std::string id, const std::string& sentence, std::string subject = {})
      : std::runtime_error("[" + id + "] " + sentence), id_(std::move(id)), subject_(std::move(subject)) {}

  /// Returns the id, such as `slom.bad-option`, which is stable between versions.
  const std::string& id() const noexcept { return id_; }
  /// Returns the name of the subject: a variable or component, a measurement, an option, an argument, a file or its
  /// line, or the type of a handle. Example: `pose[3].pos.x`. Empty if nothing has a name.
  const std::string& subject() const noexcept { return subject_; }
  /// Returns the sentence, such as `max_seconds is -1; pass a positive number`.
  std::string_view sentence() const noexcept { return std::string_view(what()).substr(id_.size() + 3); }
  /// Returns the remedy, such as `pass a positive number`; empty if there is none.
  std::string_view remedy() const noexcept {
    const std::size_t end = endOfFault();
    return end == std::string_view::npos ? std::string_view() : sentence().substr(end + 2);
  }
  /// Returns the sentence without the remedy, such as `max_seconds is -1`.
  std::string_view fault() const noexcept { return sentence().substr(0, endOfFault()); }

 private:
  /// Returns the place of the last semicolon outside the subject's name.
  std::size_t endOfFault() const noexcept {
    const std::size_t end = sentence().rfind("; "), name = sentence().rfind(subject_);
    const bool is_in_name = end != std::string_view::npos && name != std::string_view::npos && name < end &&
                            end < name + subject_.size();
    return is_in_name ? std::string_view::npos : end;
  }

  std::string id_, subject_;
};

namespace detail {

/// Returns the number as printf writes it, but with a decimal point in every C locale.
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

/// Throws the error. Without exceptions (-fno-exceptions, on microcontrollers) it ends the program.
[[noreturn, gnu::noinline, gnu::cold]] inline void raise([[maybe_unused]] const Error& error) {
#if defined(__cpp_exceptions)
  throw error;
#else
  std::abort();
#endif
}

/// Throws an error whose sentence contains numbers: `before`(1, 2.5, 0)`after`.
[[noreturn, gnu::noinline, gnu::cold]] inline void raiseBadNumbers(const char* id, const char* before,
                                                                   std::initializer_list<double> numbers,
                                                                   const char* after) {
  std::string text = before;
  for (const double& x : numbers) {
    text += (&x == numbers.begin() ? "(" : ", ") + classicText("%.6g", x);
  }
  raise(Error(id, text + ")" + after));
}

}  // namespace detail
}  // namespace mtk

namespace MTK = mtk;
