// Limits of plausible values. Values beyond them are mistakes in files, or have squares that are not finite.
#pragma once

namespace slom::app {

inline constexpr double most_px = 1e6;  ///< magnitude of a coordinate in an image [px]
inline constexpr double least_focal_px = 1e-3, most_focal_px = 1e9;  ///< limits of a focal length [px]
inline constexpr double most_m_s2 = 1e6;                             ///< magnitude of an acceleration [m/s^2]
inline constexpr double most_distortion = 1e6;                       ///< magnitude of a coefficient
inline constexpr double least_square_m = 1e-6, most_square_m = 1e3;  ///< side of a square, tag or marker [m]
inline constexpr double most_board_m = 10;  ///< from the first corner of a board to the last [m]
inline constexpr double least_spacing = 1e-3,
                        most_spacing = 10;  ///< gap between tags, as a fraction of their side
inline constexpr double least_sigma = 1e-6,
                        most_sigma = 1e6;  ///< limits of the sigma of a pixel [px] or an acceleration [m/s^2]
inline constexpr double least_sigma_board = 1e-9;  ///< of a coordinate of a corner of the board [m]
inline constexpr double least_gravity = 1e-3;  ///< the least magnitude at which --fix fixes gravity [m/s^2]

}  // namespace slom::app
