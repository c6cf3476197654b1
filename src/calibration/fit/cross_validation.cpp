#include "calibration/fit/cross_validation.hpp"

#include <algorithm>
#include <map>

#include "calibration/data/fitted_board.hpp"
#include "calibration/fit/measurements.hpp"
#include "calibration/fit/rig.hpp"
#include "calibration/fit/single_camera.hpp"
#include "calibration/limits.hpp"

namespace slom::calibration {
namespace {

constexpr int most_folds = 5;

/// Fits the pose of the rig in one image to the corners whose index in their view has the parity `fitted`. Returns
/// the sum of squared distances between the other corners and their predictions [px^2].
double predictedSquare(const Dataset& data, const std::vector<Lens>& cameras, const RigStart& rig, int image,
                       std::size_t fitted) {
  Estimator est;
  est.changeAlgorithm(LevenbergMarquardt());
  const auto pose = est.insertRV(rig.left2world.at(image), true, "left2world");
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const View* view = data.cameras[c].find(image);
    if (view) est.insertMeasurement(ViewOfOther(*view, fitted, 2), cameras[c], rig.left2camera[c], pose);
  }
  Options options;
  options.most_parameters = 0;
  options.deviation_tolerance = enough_deviations;
  est.optimize(options);
  double sum = 0;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const View* view = data.cameras[c].find(image);
    if (!view) continue;
    for (std::size_t i = 1 - fitted; i < view->corners.size(); i += 2) {
      const Corner& corner = view->corners[i];
      sum +=
          (CornerInOther()(cameras[c], rig.left2camera[c], *pose, corner.world) - corner.pixel).squaredNorm();
    }
  }
  return sum;
}

}  // namespace

std::vector<double> heldOutSquares(const Dataset& data, const Settings& settings,
                                   const std::vector<Lens>& cameras, const RigStart& rig,
                                   const std::optional<FittedBoard>& board) {
  const std::vector<int> images = data.images();
  std::map<int, double> squares;
  const std::size_t folds = std::min<std::size_t>(most_folds, images.size());
  for (std::size_t fold = 0; fold < folds; ++fold) {
    requireTime(settings.limits);
    std::map<int, bool> is_held_out;
    RigStart start{rig.left2camera, {}};
    for (std::size_t i = 0; i < images.size(); ++i) {
      is_held_out[images[i]] = i % folds == fold;
      if (i % folds != fold) start.left2world[images[i]] = rig.left2world.at(images[i]);
    }
    const Dataset others = data.withImages([&](int image) { return !is_held_out[image]; });
    RigProblem problem(others, settings, cameras, start, {}, board ? &*board : nullptr);
    Options options = optionsOf(settings);
    options.most_parameters = 0;
    problem.optimize(options);
    RigStart fitted = problem.rig();
    fitted.left2world = rig.left2world;
    const DataOnBoard seen(data, problem.board());
    for (const int image : images) {
      if (!is_held_out[image]) continue;
      requireTime(settings.limits);
      std::size_t corners = 0;
      for (const CameraData& camera : data.cameras)
        corners += camera.find(image) ? camera.find(image)->corners.size() : 0;
      const std::vector<Lens> lenses = problem.cameras();
      squares[image] = (predictedSquare(*seen, lenses, fitted, image, 0) +
                        predictedSquare(*seen, lenses, fitted, image, 1)) /
                       double(corners);
    }
  }
  std::vector<double> result;
  for (const auto& [image, square] : squares) result.push_back(square);
  return result;
}

}  // namespace slom::calibration
