// The fitted scene as a file.
#pragma once

#include <string>

#include "bundle/scene.hpp"

namespace slom::app::bundle {

enum class Format {
  bal,  ///< cameras, points and observations, as the file that was read
  ply,  ///< points and camera centres, to look at
  unknown
};

/// The format that the extension asks for: .txt and .bal, or .ply.
Format formatOf(const std::string& file);

/// Points in grey, then the centres of the cameras in red; text.
std::string toPly(const Scene& scene);

/// In the format that the name of the file asks for.
std::string toText(const Scene& scene, const std::string& file);

}  // namespace slom::app::bundle
