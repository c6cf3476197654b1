#include "bundle/output/report.hpp"

#include <fmt/format.h>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::bundle {

std::string sceneText(const Scene& scene, const std::vector<std::string>& warnings) {
  std::string text = fmt::format(
      "bundle adjustment, {}\n  {}, {}, {}\n"
      "  gauge: {} directions are free (place, rotation and scale of the whole), kept in place by damping alone\n",
      oneLine(scene.file), plural(scene.cameras.size(), "camera"), plural(scene.points.size(), "point"),
      plural(scene.observations.size(), "observation"), gauge_directions);
  for (const std::string& warning : warnings) text += fmt::format("  warning: {}\n", warning);
  return text;
}

std::string rmsText(double before, double after) {
  return fmt::format("  RMS {:.6g} px before, {:.6g} px after\n", before, after);
}

}  // namespace slom::app::bundle
