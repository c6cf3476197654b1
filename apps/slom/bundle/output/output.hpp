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

/// Appends to a cloud: its head, then the points in grey, then the centres of the cameras in red. Write a cloud that is
/// too large for the memory with these functions.
void appendPlyHead(std::string& text, std::size_t points, std::size_t cameras);
void appendPly(std::string& text, const mtk::vect<3>& point);
void appendPly(std::string& text, const Camera& camera);

/// Returns the whole cloud.
std::string toPly(const Scene& scene);

/// Returns the text in the format for the extension of the file.
std::string toText(const Scene& scene, const std::string& file);

}  // namespace slom::app::bundle
