#include "calibration/files/document.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "calibration/files/text.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
const Node* Node::find(std::string_view key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[std::size_t(found - keys.begin())];
}

void Document::fail(int line, const std::string& fault_and_remedy) const {
  badFile(fmt::format("{}:{}: {}", file, line, fault_and_remedy));
}

double Document::number(const Node& node, std::string_view key, double most) const {
  if (node.kind != Node::Kind::scalar) fail(node.line, fmt::format("{} is not a number; write one", key));
  double value = 0;
  if (!io::parseNumber(node.text, value) || !std::isfinite(value)) {
    fail(node.line, fmt::format("{} is \"{}\"; write a finite number there, or remove the image", key,
                                shortened(node.text, longest_quote)));
  }
  if (std::abs(value) > most) {
    fail(node.line, fmt::format("{} is \"{}\"; write a number from {:g} to {:g}", key,
                                shortened(node.text, longest_quote), -most, most));
  }
  return value;
}

int Document::whole(const Node& node, std::string_view key, int least, int most) const {
  const double value = number(node, key, 1e9);
  if (value != std::floor(value) || value < least || value > most)
    fail(node.line, fmt::format("{} is \"{}\"; write a whole number from {} to {}", key,
                                shortened(node.text, longest_quote), least, most));
  return int(value);
}

}  // namespace slom::calibration
