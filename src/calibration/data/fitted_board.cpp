#include "calibration/data/fitted_board.hpp"

#include <map>

#include "calibration/data/point_key.hpp"

namespace slom::calibration {

DataOnBoard::DataOnBoard(const Dataset& data, const std::optional<FittedBoard>& board) : data_(&data) {
  if (!board) return;
  std::map<PointKey, vec3> moved;
  for (const MovedCorner& corner : board->corners)
    moved.emplace(keyOf(corner.world), vec3(corner.world + corner.displacement));
  copy_ = data;
  for (CameraData& camera : copy_->cameras) {
    for (View& view : camera.views) {
      for (Corner& corner : view.corners) {
        const auto at = moved.find(keyOf(corner.world));
        if (at != moved.end()) corner.world = at->second;
      }
    }
  }
}

}  // namespace slom::calibration
