/// The exception of the project: a stable id, the subject, its value and the remedy, in one sentence.
#pragma once

#include <cstdio>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

namespace mtk {

/// what() reads `[id] sentence`; id() is stable between versions, so that programs can branch on it.
class Error : public std::runtime_error {
 public:
  Error(std::string id, const std::string& sentence)
      : std::runtime_error("[" + id + "] " + sentence), id_(std::move(id)) {}

  const std::string& id() const noexcept { return id_; }

 private:
  std::string id_;
};

namespace detail {

/// Throws an error whose sentence has numbers in its middle: `before`(1, 2.5, 0)`after`.
[[noreturn, gnu::noinline, gnu::cold]] inline void raiseBadNumbers(const char* id, const char* before,
                                                                   std::initializer_list<double> numbers,
                                                                   const char* after) {
  std::string text = before;
  for (const double& x : numbers) {
    char number[40];
    std::snprintf(number, sizeof number, "%.6g", x);
    text += (&x == numbers.begin() ? "(" : ", ") + std::string(x != x ? "nan" : number);
  }
  throw Error(id, text + ")" + after);
}

}  // namespace detail
}  // namespace mtk

namespace MTK = mtk;
