#include "calibrate/quality/assess.hpp"

#include <chrono>
#include <cmath>

#include "calibrate/quality/board.hpp"
#include "calibrate/quality/correlations.hpp"
#include "calibrate/quality/further_views.hpp"
#include "calibrate/quality/projection.hpp"
#include "calibrate/quality/residuals.hpp"
#include "calibrate/quality/split_half.hpp"

namespace slom::app::calib {
namespace {

constexpr int grid_columns = 33;
constexpr std::size_t worst_corners = 20;

/// Nodes as far apart along u as along v, as near as that can be; an odd number of them, so that there is a
/// middle.
ImageGrid gridOver(const ImageBox& box) {
  const double ratio = (box.height - 1.0) / (box.width - 1.0);
  const int rows = 2 * int(std::lround((grid_columns - 1) * std::min(ratio, 3.0) / 2)) + 1;
  return {grid_columns, std::max(rows, 5), box};
}

class Clock {
 public:
  explicit Clock(std::vector<PhaseTime>& times) : times_(times) {}
  void record(const char* phase) {
    const auto now = std::chrono::steady_clock::now();
    times_.push_back({phase, std::chrono::duration<double>(now - last_).count()});
    last_ = now;
  }

 private:
  std::vector<PhaseTime>& times_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// From a third of the boards' distance to far behind them.
void addDistances(const FittedRig& rig, const Knowledge& knowledge, std::size_t c, double board_distance_m,
                  const std::vector<std::optional<vec3>>& rays, CameraQuality& camera) {
  constexpr int count = 25;
  ImageGrid coarse = camera.grid;
  coarse.columns = 9, coarse.rows = 7;
  for (int i = 0; i < count; ++i) {
    const double distance = board_distance_m * std::pow(10, -0.5 + 2.0 * i / (count - 1));
    camera.distances_m.push_back(distance);
    const auto map = projectionUncertainty(rig, knowledge, c, coarse, rays, distance);
    camera.middle_px.push_back(map.middle_px);
    camera.worst_px.push_back(map.worst_px);
  }
}

void addProjection(const FittedRig& rig, const Knowledge& knowledge, double board_distance_m,
                   std::vector<CameraQuality>& cameras) {
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    CameraQuality& camera = cameras[c];
    const auto rays = raysOf(*rig.lenses[c], camera.grid);
    for (const double distance : {board_distance_m, std::numeric_limits<double>::infinity()}) {
      camera.projection.push_back(projectionUncertainty(rig, knowledge, c, camera.grid, rays, distance));
    }
    ImageGrid coarse = camera.grid;
    coarse.columns = 9, coarse.rows = 7;
    addDistances(rig, knowledge, c, board_distance_m, raysOf(*rig.lenses[c], coarse), camera);
  }
}

}  // namespace

Quality assess(const Dataset& data, const Settings& settings, const Result& result) {
  Quality quality;
  Clock clock(quality.times);
  const FittedRig rig(result);
  std::vector<ImageGrid> grids;
  for (std::size_t c = 0; c < data.cameras.size(); ++c) {
    grids.push_back(gridOver(imageBoxOf(data.cameras[c], result.cameras[c])));
    CameraQuality camera;
    camera.grid = grids.back();
    camera.residuals = residualsOf(data.cameras[c], rig, c);
    quality.cameras.push_back(std::move(camera));
  }
  quality.worst = worstResiduals(quality.cameras, worst_corners);
  clock.record("residuals");
  if (!result.success()) return quality;

  const std::map<int, Sight> sights = sightsOf(data, rig);
  Information information(rig.columns);
  for (const auto& [image, sight] : sights) information.add(informationOf(rig, sight));
  const Knowledge knowledge(information);
  quality.board_distance_m = boardDistance(sights, rig);
  quality.correlations = correlationsOf(rig.columns, knowledge.shared);
  clock.record("covariance");
  addProjection(rig, knowledge, quality.board_distance_m, quality.cameras);
  clock.record("projection");
  quality.split_half = splitHalf(data, settings, result, grids);
  clock.record("split_half");
  FurtherViewOptions options;
  options.board_distance_m = quality.board_distance_m;
  quality.further_views = furtherViews(rig, information, fullestView(data), grids, options);
  clock.record("further_views");
  return quality;
}

}  // namespace slom::app::calib
