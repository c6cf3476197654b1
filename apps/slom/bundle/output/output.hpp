// The fitted scene as a file.
#pragma once

#include <string>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

enum class Format {
  bal,  ///< cameras, points and observations, like the input file
  ply,  ///< points and camera centres, for viewing
  unknown
};

/// Returns the format for the extension of the file: .txt and .bal, or .ply.
Format formatOf(const std::string& file);

/// Returns text with the points in grey, then the centres of the cameras in red.
std::string toPly(const Scene& scene);

/// Returns the text in the format for the extension of the file.
std::string toText(const Scene& scene, const std::string& file);

}  // namespace slom::app::bundle
