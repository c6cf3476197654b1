// Names and limits of the numbers of a BAL file.
#pragma once

#include <array>

namespace slom::io::bal {

constexpr double most_px = 1e6;                               // magnitude of a coordinate in an image [px]
constexpr double least_focal_px = 1e-3, most_focal_px = 1e9;  // limits of a focal length [px]
constexpr std::array<const char*, 9> camera_parts{
    "rotation x", "rotation y", "rotation z", "translation x", "translation y", "translation z",
    "f",          "k1",         "k2"};
constexpr std::array<const char*, 3> point_parts{"x", "y", "z"};
constexpr std::array<const char*, 2> pixel_parts{"u", "v"};
constexpr int focal_part = 6;  // place of f in camera_parts

}  // namespace slom::io::bal
