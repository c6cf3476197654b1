#include "bundle/output/report.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::bundle {

std::string sceneText(const std::string& file, const SceneNumbers& numbers, const SceneCheck& check) {
  std::string text = fmt::format(
      "bundle adjustment, {}\n  {}, {}, {}\n"
      "  gauge: {} directions are free (place, rotation and scale of {}), held only by damping\n",
      oneLine(file), plural(std::size_t(numbers.camera_count), "camera"),
      plural(std::size_t(numbers.point_count), "point"),
      plural(std::size_t(numbers.observation_count), "observation"), similarity * check.parts,
      check.parts == 1 ? "the whole" : fmt::format("each of {} parts", check.parts));
  for (const std::string& warning : check.warnings) text += fmt::format("  warning: {}\n", warning);
  return text;
}

std::string furtherText(const FreeDirections& free) {
  if (free.further == 0) return "";
  constexpr std::size_t most_named = 5;
  std::string names;
  for (std::size_t i = 0; i < std::min(free.names.size(), most_named); ++i)
    names += (i == 0 ? "" : ", ") + free.names[i];
  if (free.names.size() > most_named) names += ", ...";
  return fmt::format(
      "{} free beyond place, rotation and scale: {} can move, alone or with others, without changing any "
      "image, and only damping holds them; add observations",
      free.further == 1 ? "1 direction is" : fmt::format("{} directions are", free.further),
      names.empty() ? "cameras and points" : names);
}

std::string rmsText(double before, double after) {
  return fmt::format("  RMS {:.6g} px before, {:.6g} px after\n", before, after);
}

}  // namespace slom::app::bundle
