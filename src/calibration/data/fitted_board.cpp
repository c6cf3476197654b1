#include "calibration/data/fitted_board.hpp"

#include <array>
#include <map>

namespace slom::calibration {

DataOnBoard::DataOnBoard(const Dataset& data, const std::optional<FittedBoard>& board) : data_(&data) {
  if (!board) return;
  std::map<std::array<double, 3>, vec3> moved;
  for (const MovedCorner& corner : board->corners) {
    const vec3& p = corner.world;
    moved.emplace(std::array{p.x(), p.y(), p.z()}, vec3(p + corner.displacement));
  }
  copy_ = data;
  for (CameraData& camera : copy_->cameras) {
    for (View& view : camera.views) {
      for (Corner& corner : view.corners) {
        const vec3& p = corner.world;
        const auto at = moved.find({p.x(), p.y(), p.z()});
        if (at != moved.end()) corner.world = at->second;
      }
    }
  }
}

}  // namespace slom::calibration
