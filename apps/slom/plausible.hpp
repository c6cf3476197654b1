// What no measurement can be. Beyond these limits lie slips in files, and squares that are no longer finite.
#pragma once

namespace slom::app {

inline constexpr double most_px = 1e6;  ///< magnitude of a coordinate in an image [px]
inline constexpr double least_focal_px = 1e-3, most_focal_px = 1e9;  ///< of a focal length [px]
inline constexpr double most_m = 1e6;           ///< magnitude of a coordinate on a board [m]
inline constexpr double most_m_s2 = 1e6;        ///< magnitude of an acceleration [m/s^2]
inline constexpr double most_distortion = 1e6;  ///< magnitude of a coefficient
inline constexpr int most_side_px = 100'000;    ///< width or height of an image [px]

}  // namespace slom::app
