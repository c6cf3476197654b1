// Results of reading a file with given content.
#pragma once

#include <string>
#include <variant>

#include <slom/io/g2o.hpp>

#include "support/temporary_folder.hpp"

namespace slom::io::testing {

template <class Pose>
PoseGraph<Pose> parsed(const std::string& content) {
  const slom::testing::TemporaryFolder folder;
  slom::testing::writeFile(folder / "map.g2o", content);
  return std::get<PoseGraph<Pose>>(readPoseGraph((folder / "map.g2o").string()));
}

/// Information matrices that are the identity, row by row.
const std::string unit3 = " 1 0 0 1 0 1\n";
const std::string unit6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

}  // namespace slom::io::testing
