/// The shape of the board: as stated, or found with the rest of the calibration.
#pragma once

#include <limits>
#include <vector>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// What is estimated of where the corners of the board are.
enum class BoardShape {
  flat,  ///< nothing: they are where the data say
  bent,  ///< a bend: their heights over the plane are a polynomial of second degree in the plane, with three unknowns
  free,  ///< each corner by itself, three unknowns each, about where the data say; the size of the board stays as stated on the whole
};
/// `flat`, `bent` or `free`.
const char* toString(BoardShape shape);

/// Where a corner of the board is.
struct MovedCorner {
  int number = 0;  ///< Corner::number, of the first image that shows it
  vec3 world;      ///< as stated [m]
  vec3
      displacement;  ///< from there, in the world; what all images' poses and the lens can follow is not in it [m]
  /// Of each coordinate of the displacement [m]; NaN where it is not an unknown of the fit.
  vec3 std = vec3(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                  std::numeric_limits<double>::quiet_NaN());
};

/// The board as the fit finds it.
struct FittedBoard {
  BoardShape shape = BoardShape::free;
  /// Standard deviation of each unknown beforehand [m], which keeps the board as a whole where it is: of a free board, of each coordinate of each
  /// corner; of a bent one, of the root mean square height of each of three bends.
  double sigma = 0;
  std::vector<MovedCorner> corners;  ///< in the order in which the images show them first
  double off_plane = 0;              ///< root mean square displacement along the normal [m]
  double within_plane = 0;  ///< root mean square displacement of each coordinate within the plane [m]
};

}  // namespace slom::calibration
