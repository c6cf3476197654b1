/// The shape of the board, as stated or estimated in the calibration.
#pragma once

#include <limits>
#include <vector>

#include "slom/calibration/types.hpp"

namespace slom::calibration {

/// Which positions of the board's corners are estimated.
enum class BoardShape {
  flat,  ///< none: the corners are at their stated positions
  bent,  ///< a bend: heights over the plane are a second-degree polynomial in the plane, with 3 unknowns
  /// Each corner has 3 unknowns, near its stated position. The overall size of the board stays as stated.
  free,
};
/// Returns `flat`, `bent` or `free`.
const char* toString(BoardShape shape);

/// The estimated position of a corner of the board.
struct MovedCorner {
  int number = 0;  ///< Corner::number in the first image that shows the corner
  vec3 world;      ///< as stated [m]
  /// Displacement from `world`, in the world, without the part that the poses of all images and the lens can follow
  /// [m].
  vec3 displacement;
  /// Standard deviation of each coordinate of the displacement [m]; NaN if it is not an unknown of the fit.
  vec3 std = vec3(std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                  std::numeric_limits<double>::quiet_NaN());
};

/// The estimated board.
struct FittedBoard {
  BoardShape shape = BoardShape::free;
  /// Prior standard deviation of each unknown [m], which keeps the board as a whole in place. For a free board, of each
  /// coordinate of each corner. For a bent board, of the root mean square height of each of the 3 bends.
  double sigma = 0;
  std::vector<MovedCorner> corners;  ///< in the order of first appearance in the images
  double off_plane = 0;              ///< root mean square displacement along the normal [m]
  double within_plane = 0;  ///< root mean square displacement of each coordinate within the plane [m]
};

}  // namespace slom::calibration
