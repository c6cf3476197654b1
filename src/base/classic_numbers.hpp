// printf and its like write decimals as the locale of C says; here always after a point.
#pragma once

#include <locale.h>

namespace slom {

/// The calling thread has the classic locale of C within this scope, whatever that of the program is.
class ClassicNumbers {
 public:
  ClassicNumbers() : before_(::uselocale(classic())) {}
  ClassicNumbers(const ClassicNumbers&) = delete;
  ClassicNumbers& operator=(const ClassicNumbers&) = delete;
  ~ClassicNumbers() { ::uselocale(before_); }

 private:
  static locale_t classic() {
    static const locale_t locale = ::newlocale(LC_ALL_MASK, "C", nullptr);
    return locale;
  }
  locale_t before_;
};

}  // namespace slom
