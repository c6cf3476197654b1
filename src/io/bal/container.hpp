// Sections of a container with a bundle adjustment.
#pragma once

#include <vector>

#include "slom/io/bal_part.hpp"
#include "slom/io/container.hpp"

namespace slom::io::bal {

enum Section : std::size_t { observation_section, camera_section, point_section };

/// Returns the sections: observations (camera, point, u, v), cameras and points as in the text.
inline std::vector<ContainerSection> sectionsOf(const BalCounts& counts) {
  return {{.name = "observation", .whole = 2, .real = 2, .count = std::uint64_t(counts.observations)},
          {.name = "camera", .real = bal_camera_size, .count = std::uint64_t(counts.cameras)},
          {.name = "point", .real = bal_point_size, .count = std::uint64_t(counts.points)}};
}

/// Returns the section of the container that one of sectionsOf() describes.
inline const ContainerSection& sectionIn(const Container& container, Section which) {
  const ContainerSection form = sectionsOf({})[which];
  return container.section(form.name, form.whole, form.real);
}

}  // namespace slom::io::bal
