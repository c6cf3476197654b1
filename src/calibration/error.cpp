#include "slom/calibration/error.hpp"

#include <utility>

#include <fmt/format.h>

namespace slom::calibration {

namespace {

std::string sentenceMadeOf(const DataError::Parts& parts) {
  std::string sentence = fmt::format("{}: {}; {}", parts.place, parts.fault, parts.remedy);
  for (const std::vector<std::string>& names : parts.worth_fixing)
    sentence += fmt::format(", or fix {}", fmt::join(names, " and "));
  return sentence;
}

}  // namespace

DataError::DataError(std::string id, Parts parts)
    : mtk::Error(std::move(id), sentenceMadeOf(parts), parts.place), parts_(std::move(parts)) {}

}  // namespace slom::calibration
