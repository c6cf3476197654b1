#include "bundle/faulty.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "text.hpp"

namespace slom::app::bundle {

void Faulty::addUp(const Collective& processes) {
  if (processes.isAlone()) return;
  const std::string own = fmt::format("{} {}", count_, fmt::join(first_, " "));
  count_ = 0;
  first_.clear();
  for (const std::string& text : processes.gather(own)) {
    std::istringstream words(text);
    std::size_t count = 0;
    words >> count;
    count_ += count;
    for (int number = 0; words >> number;) first_.push_back(number);
  }
  std::sort(first_.begin(), first_.end());
  first_.resize(std::min(first_.size(), most_named_ + 1));
}

std::string Faulty::text() const {
  return fmt::format("{} (number{} {})", plural(count_, kind_), count_ == 1 ? "" : "s", names());
}

std::string Faulty::names() const {
  const auto end = first_.begin() + std::ptrdiff_t(std::min(first_.size(), most_named_));
  return fmt::format("{}{}", fmt::join(first_.begin(), end, ", "), count_ > most_named_ ? ", ..." : "");
}

}  // namespace slom::app::bundle
