#include "calibrate/html/page_data.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "calibrate/detect/photo_patch.hpp"
#include "calibrate/html/motion_data.hpp"
#include "calibrate/html/page_numbers.hpp"
#include "calibrate/library.hpp"
#include "calibrate/output/notes.hpp"
#include "calibrate/output/quality_json.hpp"
#include "script_text.hpp"

namespace slom::app::calib {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_corners = 4000;  // drawn for each camera
constexpr std::size_t most_boards = 200;    // in the view of the boards in space
constexpr std::size_t most_images = 500;    // in tables
constexpr std::size_t most_correlated = 120;

/// Returns the numbers with three digits each; null for a number that is not finite.
Json threeDigits(const std::vector<double>& numbers) {
  Json list = Json::array();
  for (const double x : numbers) {
    if (!std::isfinite(x))
      list.push_back(nullptr);
    else
      list.push_back(x == 0 ? 0 : rounded(x, 2 - int(std::floor(std::log10(std::abs(x))))));
  }
  return list;
}

Json pose(const SE3& T) {
  Json numbers = Json::array();
  const Eigen::Matrix3d R = T.orient.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) numbers.push_back(rounded(R(i, j), 5));
  }
  for (int i = 0; i < 3; ++i) numbers.push_back(rounded(T.pos[i], 5));
  return numbers;
}

/// Returns the number of corners in each cell of an image.
Json coverage(const CameraQuality& camera) {
  constexpr int columns = 12, most_rows = 4 * columns;
  const ImageBox& box = camera.grid.box;
  const int rows =
      int(std::clamp(std::round(double(columns) * box.height / box.width), 1.0, double(most_rows)));
  std::vector<int> counts(std::size_t(columns * rows));
  for (const CornerResidual& corner : camera.residuals) {
    const int column = int(columns * corner.pixel.x() / box.width),
              line = int(rows * corner.pixel.y() / box.height);
    if (column >= 0 && column < columns && line >= 0 && line < rows)
      ++counts[std::size_t(line * columns + column)];
  }
  return {{"columns", columns}, {"rows", rows}, {"counts", counts}};
}

/// Returns evenly chosen residuals: u, v, and found minus predicted pixel.
Json residuals(const CameraQuality& camera) {
  const std::size_t total = camera.residuals.size(), every = (total + most_corners - 1) / most_corners;
  Json numbers = Json::array();
  for (std::size_t i = 0; i < total; i += every) {
    const CornerResidual& corner = camera.residuals[i];
    for (const double x : corner.pixel) numbers.push_back(rounded(x, 1));
    for (const double x : corner.residual) numbers.push_back(rounded(x, 3));
  }
  return {{"total", total}, {"every", every}, {"numbers", numbers}};
}

Json projection(const CameraQuality& camera) {
  Json list = Json::array();
  for (const ProjectionUncertainty& map : camera.projection) {
    list.push_back({{"distance", std::isfinite(map.distance_m) ? Json(map.distance_m) : Json()},
                    {"std", threeDigits(map.std_px)},
                    {"middle", map.middle_px},
                    {"median", map.median_px},
                    {"worst", map.worst_px}});
  }
  return list;
}

Json splitHalf(const SplitHalfCamera& camera) {
  return {{"difference", threeDigits(camera.difference_px)},
          {"rms", camera.rms_px},
          {"largest", camera.largest_px},
          {"expected", camera.expected_rms_px},
          {"chi2", camera.chi2},
          {"dof", camera.dof},
          {"probability", camera.probability}};
}

Json parameters(const CameraResult& camera) {
  Json rows = Json::array();
  for (const Parameter& p : camera.parameters) {
    rows.push_back(
        valueRow(p.name, p.value, p.std, p.std_clustered, p.name[0] == 'f' || p.name[0] == 'c' ? "px" : ""));
  }
  return rows;
}

Json placement(const CameraResult& camera) {
  Json rows = Json::array();
  addVector(rows, "translation", camera.left2camera.pos, camera.translation_std,
            camera.translation_clustered.std, "m");
  addVector(rows, "rotation", vec3(SO3::log(camera.left2camera.orient) * degrees),
            vec3(camera.rotation_vector_std * degrees), vec3(camera.rotation_vector_clustered.std * degrees),
            "deg");
  return rows;
}

Json cameraJson(const Result& result, std::size_t c) {
  const CameraResult& camera = result.cameras[c];
  const CameraQuality& quality = result.quality->cameras[c];
  const ImageBox& box = quality.grid.box;
  const Eigen::Matrix3d& K = camera.camera_matrix;
  Json json = {{"name", camera.name},
               {"model", camera.model},
               {"file", camera.file},
               {"images", camera.images},
               {"corners", camera.corners},
               {"rms", camera.rms_px},
               {"rms_alone", camera.rms_px_single},
               {"parameters", parameters(camera)},
               {"placement", c == 0 ? Json() : placement(camera)},
               {"pose", pose(camera.left2camera)},
               {"pinhole", {K(0, 0), K(1, 1), K(0, 2), K(1, 2)}},
               {"width", box.width},
               {"height", box.height},
               {"size_is_assumed", box.is_assumed},
               {"residuals", residuals(quality)},
               {"coverage", coverage(quality)},
               {"grid", {quality.grid.columns, quality.grid.rows}},
               {"projection", projection(quality)},
               {"distances", threeDigits(quality.distances_m)},
               {"middle", threeDigits(quality.middle_px)},
               {"worst", threeDigits(quality.worst_px)}};
  const auto& split = result.quality->split_half.cameras;
  json["split"] = c < split.size() ? splitHalf(split[c]) : Json();
  return json;
}

Json imuJson(const ImuResult& imu) {
  Json rows = Json::array();
  addVector(rows, "acc_bias", imu.acc_bias, imu.acc_bias_std, imu.acc_bias_clustered.std, "m/s²");
  rows.push_back(valueRow("gravity", imu.gravity, imu.gravity_std, imu.gravity_std_clustered, "m/s²"));
  addVector(rows, "rotation", vec3(SO3::log(imu.left2imu) * degrees), vec3(imu.rotation_vector_std * degrees),
            vec3(imu.rotation_vector_clustered.std * degrees), "deg");
  return {{"readings", imu.readings},
          {"rms", imu.rms_acc},
          {"parameters", rows},
          {"pose", pose(SE3(imu.left2imu))}};
}

Json imagesJson(const Result& result) {
  const std::size_t every = (result.images.size() + most_boards - 1) / most_boards;
  Json images = Json::array();
  for (std::size_t i = 0; i < result.images.size(); ++i) {
    const ImageResult& image = result.images[i];
    Json rms = Json::array();
    for (const auto& value : image.rms_px) rms.push_back(value ? Json(rounded(*value, 4)) : Json());
    images.push_back(
        {{"image", image.image}, {"rms", rms}, {"chi2", rounded(image.chi2PerMeasurement(), 4)}});
    if (i % every == 0) images.back()["pose"] = pose(image.left2world);
  }
  return {{"list", images}, {"boards_every", every}, {"rows", most_images}};
}

/// Returns the rectangle around all corners of the board, in the world.
Json boardJson(const Dataset& data) {
  const BoardOutline board = outlineOf(fullestView(data));
  Json points = Json::array();
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
    for (const double coordinate : board.board2world* vec3(x * board.width / 2, y * board.height / 2, 0.)) {
      points.push_back(rounded(coordinate, 5));
    }
  }
  return points;
}

Json worstJson(const Dataset& data, const Result& result) {
  Json list = Json::array();
  for (const WorstResidual& worst : result.quality->worst) {
    const View* view = data.cameras[worst.camera].find(worst.corner.image);
    // Only photographs named by --images are shown. What a corner file calls a photograph may be any file.
    const bool is_given = view && !view->photo.empty() && worst.corner.line == 0;
    const std::string patch = is_given ? photoPatch(view->photo, worst.corner.pixel) : "";
    list.push_back({{"camera", worst.camera},
                    {"image", worst.corner.image},
                    {"corner", worst.corner.corner},
                    {"line", view && !view->file.empty() ? Json(worst.place) : Json(worst.corner.line)},
                    {"u", rounded(worst.corner.pixel.x(), 2)},
                    {"v", rounded(worst.corner.pixel.y(), 2)},
                    {"error", rounded(worst.error_px, 3)},
                    {"du", rounded(worst.corner.residual.x(), 3)},
                    {"dv", rounded(worst.corner.residual.y(), 3)},
                    {"photo", patch}});
  }
  return list;
}

Json pageCorrelationsJson(const Correlations& correlations) {
  Json strong = Json::array(), matrix = Json::array();
  for (const auto& pair : correlations.strong) {
    strong.push_back({pair.a, pair.b, rounded(pair.coefficient, 4)});
    if (strong.size() == 15) break;
  }
  const bool is_drawn = correlations.size() <= most_correlated;
  for (std::size_t i = 0; is_drawn && i < correlations.size(); ++i) {
    for (std::size_t j = 0; j <= i; ++j) matrix.push_back(rounded(correlations.coefficient(i, j), 3));
  }
  return {{"names", is_drawn ? Json(correlations.names) : Json::array()},
          {"count", correlations.names.size()},
          {"matrix", matrix},
          {"strong_count", correlations.strong.size()},
          {"strong", strong}};
}

Json viewsJson(const Result& result) {
  Json list = Json::array();
  for (const FurtherView& view : result.quality->further_views) {
    list.push_back({{"sentence", sentenceOf(view, result)},
                    {"before", view.before_px},
                    {"after", view.after_px},
                    {"far", !std::isfinite(view.of_distance_m)}});
  }
  return list;
}

/// Returns the fitted board as seen from the side of the first image [mm]: positions in the plane from one of its
/// corners, displacements and their standard deviations. The third displacement points towards the camera.
Json fittedBoardJson(const Dataset& data, const Result& result) {
  if (!result.board) return {};
  constexpr double mm = 1000;
  const BoardOutline outline = outlineOf(fullestView(data));
  const SE3 world2board = outline.board2world.inverse();
  const bool is_behind = (world2board * result.images.front().left2world.pos).z() < 0;
  const double towards = is_behind ? -1 : 1;
  Json corners = Json::array();
  for (const MovedCorner& corner : result.board->corners) {
    const vec3 at = world2board * corner.world, moved = world2board.orient * corner.displacement;
    corners.push_back({corner.number, rounded(mm * (at.x() + outline.width / 2), 4),
                       rounded(mm * (at.y() + outline.height / 2), 4), rounded(mm * moved.x(), 3),
                       rounded(mm * moved.y(), 3), rounded(towards * mm * moved.z(), 3),
                       rounded(mm * corner.std.maxCoeff(), 2)});
  }
  return {{"shape", toString(result.board->shape)},
          {"width", mm * outline.width},
          {"height", mm * outline.height},
          {"off_plane", mm * result.board->off_plane},
          {"within_plane", mm * result.board->within_plane},
          {"corners", std::move(corners)}};
}

}  // namespace

std::string pageData(const Dataset& data, const Result& result, const std::optional<FittedStreams>& streams) {
  const Quality& quality = *result.quality;
  Json cameras = Json::array(), times = Json::array();
  for (std::size_t c = 0; c < result.cameras.size(); ++c) cameras.push_back(cameraJson(result, c));
  for (const PhaseTime& time : quality.times) times.push_back({time.phase, rounded(time.seconds, 4)});
  return scriptText({{"verdict", verdictJson(verdictOf(result))},
                     {"success", result.success()},
                     {"is_assessed", result.success() && quality.hasProjection()},
                     {"is_clustered", quality.is_clustered},
                     {"cut_short", quality.cut_short},
                     {"notes", notes(result)},
                     {"iterations", result.iterations},
                     {"stop_reason", result.stop_reason},
                     {"measurements", result.measurements},
                     {"unknowns", result.unknowns},
                     {"redundancy", result.redundancy},
                     {"chi2_per_dof", result.chi2PerDof()},
                     {"sigma_px", result.sigma_px},
                     {"sigma_acc", result.sigma_acc},
                     {"rms", rmsOfAll(result)},
                     {"cameras", cameras},
                     {"imu", result.imu ? imuJson(*result.imu) : Json()},
                     {"streams", streams ? motionJson(*streams) : Json()},
                     {"images", imagesJson(result)},
                     {"board", boardJson(data)},
                     {"fitted_board", fittedBoardJson(data, result)},
                     {"board_distance", quality.board_distance_m},
                     {"split_why_not", quality.split_half.why_not},
                     {"worst", worstJson(data, result)},
                     {"correlations", pageCorrelationsJson(quality.correlations)},
                     {"views", viewsJson(result)},
                     {"times", times}});
}

}  // namespace slom::app::calib
