// Numbers in the classic locale. printf and similar functions write decimals in the C locale; here always with a point.
#pragma once

#include <locale.h>

namespace slom {

/// A scope in which the calling thread has the classic C locale, whatever the program's locale is.
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
