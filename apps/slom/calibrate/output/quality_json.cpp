#include "calibrate/output/quality_json.hpp"

#include <utility>

#include "calibrate/library.hpp"

namespace slom::app::calib {
namespace {

using Json = nlohmann::ordered_json;

Json projectionJson(const ProjectionUncertainty& map) {
  return {{"distance_m", map.distance_m},  // null: at infinity
          {"middle_px", map.middle_px},
          {"median_px", map.median_px},
          {"worst_px", map.worst_px},
          {"std_px", map.std_px}};
}

Json cameraJson(const CameraQuality& camera) {
  const ImageBox& box = camera.grid.box;
  Json projection = Json::array();
  for (const ProjectionUncertainty& map : camera.projection) projection.push_back(projectionJson(map));
  Json stated = Json::array();
  for (const ProjectionUncertainty& map : camera.projection_stated) stated.push_back(projectionJson(map));
  return {
      {"image_size", {box.width, box.height}},
      {"image_size_is_assumed", box.is_assumed},
      {"grid", {{"columns", camera.grid.columns}, {"rows", camera.grid.rows}}},
      {"projection", std::move(projection)},
      {"projection_stated", std::move(stated)},
      {"by_distance",
       {{"distance_m", camera.distances_m}, {"middle_px", camera.middle_px}, {"worst_px", camera.worst_px}}},
      {"focal_std", camera.focal_std},
      {"centre_std_px", camera.centre_std_px},
      {"tilt_spread_rad", camera.tilt_spread}};
}

Json splitHalfJson(const Result& result) {
  const SplitHalf& split = result.quality->split_half;
  if (!split.why_not.empty()) return {{"why_not", split.why_not}};
  Json json;
  for (std::size_t c = 0; c < split.cameras.size(); ++c) {
    const SplitHalfCamera& camera = split.cameras[c];
    json[result.cameras[c].name] = {{"rms_px", camera.rms_px},
                                    {"expected_rms_px", camera.expected_rms_px},
                                    {"largest_px", camera.largest_px},
                                    {"chi2", camera.chi2},
                                    {"parameters", camera.dof},
                                    {"probability", camera.probability},
                                    {"difference_px", camera.difference_px}};
  }
  return json;
}

Json qualityCorrelationsJson(const Correlations& correlations) {
  Json matrix = Json::array(), strong = Json::array();
  for (std::size_t i = 0; i < correlations.size(); ++i) {
    const auto row = correlations.matrix.begin() + std::ptrdiff_t(i * correlations.size());
    matrix.push_back(std::vector<double>(row, row + std::ptrdiff_t(correlations.size())));
  }
  for (const auto& pair : correlations.strong)
    strong.push_back({{"a", pair.a}, {"b", pair.b}, {"coefficient", pair.coefficient}});
  return {{"names", correlations.names}, {"strong", std::move(strong)}, {"matrix", std::move(matrix)}};
}

Json worstJson(const Result& result) {
  Json list = Json::array();
  for (const WorstResidual& worst : result.quality->worst) {
    const CornerResidual& corner = worst.corner;
    list.push_back({{"camera", result.cameras[worst.camera].name},
                    {"image", corner.image},
                    {"corner", corner.corner},
                    {"line", corner.line > 0 ? Json(corner.line) : Json()},
                    {"place", worst.place},
                    {"error_px", worst.error_px},
                    {"pixel", {corner.pixel.x(), corner.pixel.y()}},
                    {"residual_px", {corner.residual.x(), corner.residual.y()}}});
  }
  return list;
}

Json furtherViewsJson(const Result& result) {
  Json list = Json::array();
  for (const FurtherView& view : result.quality->further_views) {
    list.push_back({{"camera", result.cameras[view.camera].name},
                    {"pixel", {view.pixel.x(), view.pixel.y()}},
                    {"tilt_deg", view.tilt_deg},
                    {"edge_away", view.edge_away},
                    {"distance_m", view.distance_m},
                    {"before_px", view.before_px},
                    {"after_px", view.after_px},
                    {"of_distance_m", view.of_distance_m},  // null: at infinity
                    {"sentence", sentenceOf(view, result)}});
  }
  return list;
}

std::vector<double> numbersOf(const vec3& v) { return {v.x(), v.y(), v.z()}; }

Json patternsJson(const Result& result) {
  Json list = Json::array();
  for (const ResidualPattern& pattern : result.quality->patterns) {
    Json json = {{"kind", toString(pattern.kind)},
                 {"camera", result.cameras[pattern.camera].name},
                 {"is_found", pattern.isFound()},
                 {"value", pattern.value},
                 {"share", pattern.share},  // null: this pattern compares sizes of residuals
                 {"probability", pattern.probability},
                 {"blocks", pattern.blocks},
                 {"sentence", sentenceOf(pattern, result)}};
    if (pattern.kind == ResidualPattern::Kind::board_shape) {
      json["within_plane"] = pattern.second;
      json["corners"] = Json::array();
      for (const MovedCorner& corner : pattern.corners) {
        json["corners"].push_back({{"corner", corner.number},
                                   {"world_m", numbersOf(corner.world)},
                                   {"displacement_m", numbersOf(corner.displacement)}});
      }
    }
    if (pattern.kind == ResidualPattern::Kind::drift) json["parameter"] = pattern.parameter;
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace

Json verdictJson(const Verdict& verdict) {
  return {{"level", toString(verdict.level)}, {"sentence", verdict.sentence}, {"doubts", verdict.doubts}};
}

Json qualityJson(const Result& result) {
  const Quality& quality = *result.quality;
  Json cameras, seconds;
  for (std::size_t c = 0; c < quality.cameras.size(); ++c)
    cameras[result.cameras[c].name] = cameraJson(quality.cameras[c]);
  for (const PhaseTime& time : quality.times) seconds[time.phase] = time.seconds;
  Json json = {{"verdict", verdictJson(verdictOf(result))},
               {"cameras", std::move(cameras)},
               {"worst_corners", worstJson(result)},
               {"seconds", std::move(seconds)},
               {"cut_short", quality.cut_short.empty() ? Json() : Json(quality.cut_short)}};
  if (!result.success() || !quality.hasProjection()) return json;
  json["is_clustered"] = quality.is_clustered;
  json["board_distance_m"] = quality.board_distance_m;
  json["patterns"] = patternsJson(result);
  json["split_half"] = splitHalfJson(result);
  json["correlations"] = qualityCorrelationsJson(quality.correlations);
  json["further_views"] = furtherViewsJson(result);
  return json;
}

}  // namespace slom::app::calib
