#include "calibrate/output/json.hpp"

#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include <slom/solve/instruction_set.hpp>

#include "calibrate/output/notes.hpp"
#include "calibrate/output/quality_json.hpp"

namespace slom::app::calib {
namespace {

using Json = nlohmann::ordered_json;

Json list(const Eigen::Ref<const Eigen::VectorXd>& v) { return std::vector<double>(v.begin(), v.end()); }

Json rowMajor(const SO3& R) {
  Json numbers = Json::array();
  const Eigen::Matrix3d matrix = R.toRotationMatrix();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) numbers.push_back(matrix(i, j));
  }
  return numbers;
}

Json poseJson(const SE3& T) { return {{"rotation", rowMajor(T.orient)}, {"translation", list(T.pos)}}; }

Json clusteredJson(const ClusteredUncertainty& clustered) {
  const std::size_t n = std::size_t(std::lround(std::sqrt(double(clustered.covariance.size()))));
  Json covariance = Json::array();
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = clustered.covariance.begin() + std::ptrdiff_t(i * n);
    covariance.push_back(std::vector<double>(row, row + std::ptrdiff_t(n)));
  }
  return {{"images", clustered.images},
          {"board_points", clustered.board_points},
          {"block_length", clustered.block_length},
          {"blocks", clustered.blocks},
          {"levels_off", clustered.levels_off},
          {"extrapolation", clustered.extrapolation},
          {"ratio_by_image", clustered.ratio_by_image},
          {"ratio_by_block", clustered.ratio_by_block},
          {"ratio", clustered.ratio},
          {"is_reliable", clustered.isReliable()},
          {"notes", sentencesOf(clustered)},
          {"covariance", std::move(covariance)}};
}

Json noiseJson(const CornerNoise& noise) {
  return {{"by", toString(noise.by)},
          {"typical", noise.typical},
          {"growth", noise.growth},
          {"factor", noise.factor},
          {"lower_quarter", noise.lower_quarter},
          {"upper_quarter", noise.upper_quarter}};
}

Json readoutJson(const Readout& readout) {
  return {{"value", readout.value}, {"std", readout.std}, {"std_clustered", readout.std_clustered}};
}

Json readoutJson(const Result& result) {
  Json cameras = Json::object();
  for (std::size_t c = 0; c < result.readout_comparison.size(); ++c) {
    const auto& trial = result.readout_comparison[c];
    Json& camera = cameras[result.cameras[c].name];
    if (!trial) continue;
    camera = readoutJson(trial->readout);
    camera["probability"] = trial->probability;
    camera["is_found"] = trial->isFound();
  }
  return cameras;
}

Json cameraJson(const CameraResult& camera, const std::string& reference) {
  Json parameters;
  Json unused = Json::array();
  for (const UnusedPhoto& photo : camera.unused) {
    unused.push_back({{"image", photo.image ? Json(*photo.image) : Json()},
                      {"file", photo.file},
                      {"reason", photo.reason}});
  }
  Json copies = Json::array();
  for (const Copy& copy : camera.copies) {
    copies.push_back({{"image", copy.image},
                      {"repeats", copy.original},
                      {"file", copy.photo},
                      {"repeated_file", copy.original_photo},
                      {"corners", copy.corners},
                      {"equal_corners", copy.equal_corners},
                      {"difference_px", copy.difference_px}});
  }
  Json excluded = Json::array();
  for (const Exclusion& one : camera.excluded)
    excluded.push_back({{"image", one.image}, {"corner", one.corner ? Json(*one.corner) : Json()}});
  for (const Parameter& p : camera.parameters) {
    parameters[p.name] = {
        {"value", p.value}, {"std", p.std}, {"std_clustered", p.std_clustered}, {"dof", p.dof}};
  }
  Json from_reference = poseJson(camera.left2camera);
  Eigen::VectorXd std(6);
  std << camera.translation_std, camera.rotation_std;
  from_reference["std"] = list(std);
  std << camera.translation_clustered.std, camera.rotation_clustered.std;
  from_reference["std_clustered"] = list(std);
  std << camera.translation_clustered.dof, camera.rotation_clustered.dof;
  from_reference["dof"] = list(std);
  return {
      {"model", camera.model},
      {"file", camera.file},
      {"images", camera.images},
      {"corners", camera.corners},
      {"image_size", camera.image_size ? Json{camera.image_size->width, camera.image_size->height} : Json()},
      {"unused", std::move(unused)},
      {"copies", std::move(copies)},
      {"excluded", std::move(excluded)},
      {"noise", noiseJson(camera.noise)},
      {"readout", camera.readout ? readoutJson(*camera.readout) : Json()},
      {"parameters", std::move(parameters)},
      {"pose_from_" + reference, from_reference},
      {"rms_px_alone", camera.rms_px_single}};
}

Json precision(const ImuPrecision& p) {
  return {{"rotation", p.rotation}, {"acc_bias", p.acc_bias}, {"gravity", p.gravity}};
}

Json imuJson(const ImuResult& imu, const std::string& reference) {
  return {{"file", imu.file},
          {"readings", imu.readings},
          {"rotation_from_" + reference, rowMajor(imu.left2imu)},
          {"std", list(imu.rotation_std)},
          {"std_clustered", list(imu.rotation_clustered.std)},
          {"dof", list(imu.rotation_clustered.dof)},
          {"acc_bias", list(imu.acc_bias)},
          {"acc_bias_std", list(imu.acc_bias_std)},
          {"acc_bias_std_clustered", list(imu.acc_bias_clustered.std)},
          {"acc_bias_dof", list(imu.acc_bias_clustered.dof)},
          {"acc_bias_fixed", imu.acc_bias_is_fixed},
          {"gravity", imu.gravity},
          {"gravity_std", imu.gravity_std},
          {"gravity_std_clustered", imu.gravity_std_clustered},
          {"gravity_dof", imu.gravity_dof},
          {"gravity_fixed", imu.gravity_is_fixed},
          {"largest_std", precision(imu.precision)},
          {"largest_std_if_gravity_fixed", precision(imu.if_gravity_fixed)},
          {"largest_std_if_acc_bias_fixed", precision(imu.if_acc_bias_fixed)},
          {"tilt_spread_rad", imu.tilt_spread},
          {"sign_evidence", imu.sign_evidence}};
}

Json imageJson(const ImageResult& image, const std::vector<CameraResult>& cameras) {
  Json rms;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    if (image.rms_px[c]) rms[cameras[c].name] = *image.rms_px[c];
  }
  const WorstCorner& worst = image.worst_corner;
  Json json = {{"image", image.image},
               {"rms_px", std::move(rms)},
               {"chi2_per_measurement", image.chi2PerMeasurement()},
               {"worst_corner",
                {{"camera", cameras[worst.camera].name},
                 {"corner", worst.number},
                 {"line", worst.line > 0 ? Json(worst.line) : Json()},
                 {"place", worst.place},
                 {"error_px", worst.error_px}}},
               {cameras.front().name + "2world", poseJson(image.left2world)}};
  json["acc_error"] = image.acc_error ? Json(*image.acc_error) : Json();
  return json;
}

Json grossJson(const Result& result, const std::vector<GrossCorner>& corners) {
  Json list = Json::array();
  for (const GrossCorner& corner : corners) {
    list.push_back({{"camera", result.cameras[corner.camera].name},
                    {"image", corner.image},
                    {"corner", corner.number},
                    {"line", corner.line > 0 ? Json(corner.line) : Json()},
                    {"error_px", corner.error_px},
                    {"error_without_px", corner.error_without_px},
                    {"studentised", corner.studentised}});
  }
  return list;
}

Json boardJson(const FittedBoard& board) {
  Json corners = Json::array();
  for (const MovedCorner& corner : board.corners) {
    corners.push_back({{"corner", corner.number},
                       {"world_m", list(corner.world)},
                       {"displacement_m", list(corner.displacement)},
                       {"std_m", list(corner.std)}});
  }
  return {{"shape", toString(board.shape)},
          {"sigma_m", board.sigma},
          {"off_plane_m", board.off_plane},
          {"within_plane_m", board.within_plane},
          {"corners", std::move(corners)}};
}

Json comparisonJson(const Comparison& comparison) {
  Json trials = Json::array();
  for (std::size_t i = 0; i < comparison.trials.size(); ++i) {
    const ModelTrial& trial = comparison.trials[i];
    const bool fits = trial.failure.empty();
    trials.push_back({{"model", trial.model.name()},
                      {"board_shape", toString(trial.board_shape)},
                      {"failure", fits ? Json() : Json(trial.failure)},
                      {"unknowns", fits ? Json(trial.unknowns) : Json()},
                      {"rss", fits ? Json(trial.rss) : Json()},
                      {"rss_per_dof", fits ? Json(trial.rss / trial.redundancy) : Json()},
                      {"rms_px", fits ? Json(trial.rms_px) : Json()},
                      {"predicted_px", fits ? Json(trial.heldOutRms()) : Json()},
                      {"standard_errors_behind_best", comparison.standard_errors[i]}});
  }
  return {{"models", std::move(trials)},
          {"cut_short", comparison.cut_short.empty() ? Json() : Json(comparison.cut_short)},
          {"chosen", comparison.chosen ? Json(comparison.chosenTrial().model.name()) : Json()},
          {"chosen_board_shape",
           comparison.chosen ? Json(toString(comparison.chosenTrial().board_shape)) : Json()}};
}

Json noiseJson(const NoiseComparison& comparison) {
  Json trials = Json::array();
  for (const NoiseComparison::Trial& trial : comparison.trials) {
    Json noise = Json::array();
    for (const CornerNoise& one : trial.noise) noise.push_back(noiseJson(one));
    trials.push_back({{"by", toString(trial.by)},
                      {"log_gain", trial.gain},
                      {"standard_errors", trial.standard_errors},
                      {"cameras", std::move(noise)}});
  }
  return {{"trials", std::move(trials)}, {"chosen", toString(comparison.chosen)}};
}

Json downweightedJson(const Downweighted& down) {
  return {{"loss", down.loss},          {"noise_px", down.noise_px}, {"corners", down.corners},
          {"least_weight", down.least}, {"mean_weight", down.mean},  {"over_curvature", down.over_curvature}};
}

/// Returns how image numbers that are time stamps were paired.
Json stampsJson(const ImageNumbers& numbers) {
  if (!numbers.areStamps()) return {};
  return {{"paired_images", numbers.paired()},
          {"largest_difference", numbers.largestDifference()},
          {"spacing", numbers.spacing()}};
}

/// Returns a matrix of the axes, row by row, with the stated and clustered standard deviations of its entries.
Json axesJson(const Eigen::MatrixXd& values, const Eigen::MatrixXd& std, const Eigen::MatrixXd& clustered) {
  const auto rows = [](const Eigen::MatrixXd& m) {
    return list(Eigen::VectorXd(Eigen::MatrixXd(m.transpose()).reshaped()));
  };
  return {{"value", rows(values)}, {"std", rows(std)}, {"std_clustered", rows(clustered)}};
}

/// Returns the axes of an IMU as matrices, row by row.
Json imuModelJson(const ImuAxesResult& axes) {
  const auto force = [](const auto& a) {
    return (Eigen::Matrix3d() << a[0], 0, 0, a[1], a[2], 0, a[3], a[4], a[5]).finished();
  };
  const auto square = [](const auto& a) {
    return (Eigen::Matrix3d() << a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8]).finished();
  };
  const auto places = [](const auto& a) {
    return (Eigen::Matrix<double, 2, 3>() << a[0], a[1], a[2], a[3], a[4], a[5]).finished();
  };
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const double *std = axes.std.data(), *clustered = axes.std_clustered.data();
  const std::vector<double> none(30, unknown);
  if (axes.std.size() < none.size() - 6) std = none.data();
  if (axes.std_clustered.size() < axes.std.size() || axes.std_clustered.empty()) clustered = none.data();
  Json json{
      {"name", toString(axes.estimated)},
      {"accelerometer_M", axesJson(I + force(axes.model.force_axes), force(std), force(clustered))},
      {"gyroscope_M", axesJson(I + square(axes.model.gyro_axes), square(std + 6), square(clustered + 6))},
      {"gyroscope_A", axesJson(square(axes.model.gyro_by_force), square(std + 15), square(clustered + 15))}};
  if (axes.estimated == ImuAxes::scale_misalignment_size_effect)
    json["accelerometer_places"] =
        axesJson(places(axes.model.force_places), places(std + 24), places(clustered + 24));
  return json;
}

Json spikesJson(const std::vector<ImuSpike>& spikes) {
  Json all = Json::array();
  for (const ImuSpike& spike : spikes)
    all.push_back({{"t_s", spike.time},
                   {"sensor", spike.is_gyro ? "gyroscope" : "accelerometer"},
                   {"axis", std::string(1, "xyz"[spike.axis])},
                   {"jump", spike.jump}});
  return all;
}

/// Returns the jumps of biases, with times since the first reading.
Json jumpsJson(const std::vector<BiasJump>& jumps) {
  Json all = Json::array();
  for (const BiasJump& jump : jumps)
    all.push_back({{"t_s", jump.time},
                   {"sensor", jump.is_gyro ? "gyroscope" : "accelerometer"},
                   {"change", list(jump.change)}});
  return all;
}

Json grossJson(const std::vector<GrossReadings>& gross) {
  Json all = Json::array();
  for (const GrossReadings& one : gross)
    all.push_back({{"from_s", one.from}, {"to_s", one.to}, {"times", one.times}});
  return all;
}

/// Returns a pose with its stated and clustered standard deviations, of an IMU or a camera: translation, then rotation.
template <class Sensor>
Json poseJson(const SE3& pose, const Sensor& of) {
  Json json = poseJson(pose);
  Eigen::VectorXd std(6);
  std << of.translation_std, of.rotation_std;
  json["std"] = list(std);
  std << of.translation_clustered, of.rotation_clustered;
  json["std_clustered"] = list(std);
  return json;
}

Json differenceJson(const ImuAgreement& imu) {
  return {{"translation", list(imu.translation)}, {"translation_std", list(imu.translation_std)},
          {"rotation", list(imu.rotation)},       {"rotation_std", list(imu.rotation_std)},
          {"time_offset_s", imu.time_offset},     {"time_offset_std", imu.time_offset_std}};
}

Json imuStreamJson(const ImuStreamResult& imu, const std::string& reference) {
  Json json{{"file", imu.file},
            {"samples", imu.samples},
            {"left_out_readings", spikesJson(imu.spikes)},
            {"left_out_intervals", grossJson(imu.gross)},
            {"intervals", imu.intervals},
            {"rate_hz", imu.rate},
            {"pose_from_" + reference, poseJson(imu.left2imu, imu)},
            {"time_offset_s",
             {{"value", imu.time_offset},
              {"std", imu.time_offset_std},
              {"std_clustered", imu.time_offset_clustered}}},
            {"excitation", {{"gyro", list(imu.excitation.turns)}, {"acc", list(imu.excitation.forces)}}},
            {"gyro_bias", list(imu.gyro_bias)},
            {"gyro_bias_std", list(imu.gyro_bias_std)},
            {"gyro_bias_std_clustered", list(imu.gyro_bias_clustered)},
            {"acc_bias", list(imu.force_bias)},
            {"acc_bias_std", list(imu.force_bias_std)},
            {"acc_bias_std_clustered", list(imu.force_bias_clustered)},
            {"bias_jumps", jumpsJson(imu.jumps)},
            {"rms_gyro", imu.rms_gyro},
            {"rms_acc", imu.rms_force},
            {"noise",
             {{"gyroscope_noise_density", imu.noise.gyro},
              {"gyroscope_random_walk", imu.noise.gyro_walk},
              {"accelerometer_noise_density", imu.noise.force},
              {"accelerometer_random_walk", imu.noise.force_walk},
              {"is_given", imu.noise_is_given},
              {"gyroscope_ratio", imu.gyro_ratio},
              {"accelerometer_ratio", imu.force_ratio}}}};
  if (imu.halves) json["halves"] = differenceJson(*imu.halves);
  if (imu.force_lag) json["acc_lag_s"] = {{"value", imu.force_lag->value}, {"std", imu.force_lag->std}};
  if (imu.axes.estimated != ImuAxes::calibrated) json["model"] = imuModelJson(imu.axes);
  return json;
}

/// Returns the clocks and shutters of the cameras, and their poses by all data.
Json timingsJson(const std::vector<CameraStreamResult>& cameras) {
  const auto number = [](const std::optional<StreamNumber>& one) -> Json {
    if (!one) return {};
    return {{"value", one->value}, {"std", one->std}, {"std_clustered", one->std_clustered}};
  };
  Json json = Json::object();
  for (const CameraStreamResult& camera : cameras) {
    json[camera.name] = {{"time_offset_s", number(camera.time_offset)},
                         {"line_delay_s", number(camera.line_delay)}};
    if (camera.name != cameras.front().name)
      json[camera.name]["pose_from_" + cameras.front().name] = poseJson(camera.left2camera, camera);
  }
  return json;
}

/// Returns the values by splines minus those by preintegration.
Json agreementJson(const StreamAgreement& agreement) {
  Json imus = Json::object();
  for (const ImuAgreement& imu : agreement.imus) imus[imu.name] = differenceJson(imu);
  return {{"imus", std::move(imus)},
          {"gravity_angle", agreement.gravity_angle},
          {"gravity_std", agreement.gravity_std},
          {"largest", agreement.largest},
          {"largest_name", agreement.largest_name},
          {"contradiction", agreement.contradiction.empty() ? Json() : Json(agreement.contradiction)}};
}

/// Adds IMUs in motion, gravity, and how their fit ended.
void addStreams(const FittedStreams& fitted, const std::string& reference, Json& json) {
  const StreamResult& streams = fitted.result;
  if (!fitted.refusal.empty()) {
    json["imus"] = Json::object();
    json["streams"] = {{"refused", fitted.refusal}, {"verdict", verdictJson(fitted.verdict)}};
    return;
  }
  Json imus = Json::object();
  for (const ImuStreamResult& imu : streams.imus) imus[imu.name] = imuStreamJson(imu, reference);
  json["imus"] = std::move(imus);
  json["gravity"] = list(streams.gravity);
  json["gravity_direction_std"] = streams.gravity_direction_std;
  json["gravity_direction_std_clustered"] = streams.gravity_direction_clustered;
  json["streams"] = {{"refused", Json()},
                     {"path", toString(streams.path)},
                     {"converged", streams.converged},
                     {"stop_reason", streams.stop_reason},
                     {"message", streams.message},
                     {"undetermined", streams.undetermined.empty() ? Json() : Json(streams.undetermined)},
                     {"iterations", streams.iterations},
                     {"measurements", streams.measurements},
                     {"unknowns", streams.unknowns},
                     {"sigma_px", streams.sigma_px},
                     {"largest_camera_change", streams.largest_camera_change},
                     {"most_changed", streams.most_changed},
                     {"verdict", verdictJson(fitted.verdict)},
                     {"notes", streams.notes}};
  if (!streams.cameras.empty()) json["streams"]["cameras"] = timingsJson(streams.cameras);
  if (fitted.agreement) json["streams"]["agreement"] = agreementJson(*fitted.agreement);
}

}  // namespace

std::string toJson(const Result& result, const ImageNumbers& numbers,
                   const std::optional<FittedStreams>& streams) {
  const std::string& reference = result.cameras.front().name;
  Json rms, cameras, images = Json::array(), worst = Json::array(), strays = Json::array();
  for (const CameraResult& camera : result.cameras) {
    rms[camera.name] = camera.rms_px;
    cameras[camera.name] = cameraJson(camera, reference);
  }
  for (const ImageResult& image : result.images) images.push_back(imageJson(image, result.cameras));
  for (const Stray& stray : result.strays) {
    strays.push_back({{"camera", stray.camera},
                      {"image", stray.image},
                      {"error_px", stray.error_px},
                      {"is_left_out", stray.is_left_out},
                      {"size", stray.size},
                      {"why", stray.why}});
  }
  for (const ImageResult* image : result.worstImages(5)) worst.push_back(image->image);
  Json json = {
      {"kernels", slom::instructionSet()},
      {"converged", result.converged},
      {"stop_reason", result.stop_reason},
      {"message", result.message},
      {"iterations", result.iterations},
      {"measurements", result.measurements},
      {"unknowns", result.unknowns},
      {"redundancy", result.redundancy},
      {"rss", result.rss},
      {"active_bounds", result.active_bounds},
      {"chi2_per_dof", result.chi2PerDof()},
      {"sigma_px", result.sigma_px},
      {"sigma_acc", result.sigma_acc},
      {"rms_px", std::move(rms)},
      {"rms_acc", result.imu ? Json(result.imu->rms_acc) : Json()},
      {"undetermined", result.undetermined.empty() ? Json() : Json(result.undetermined)},
      {"reference", reference},
      {"time_stamps", stampsJson(numbers)},
      {"cameras", std::move(cameras)},
      {"imu", result.imu ? imuJson(*result.imu, reference) : Json()},
      {"board", result.board ? boardJson(*result.board) : Json()},
      {"clustered", result.clustered ? clusteredJson(*result.clustered) : Json()},
      {"downweighted", result.downweighted ? downweightedJson(*result.downweighted) : Json()},
      {"noise_comparison", result.noise_comparison ? noiseJson(*result.noise_comparison) : Json()},
      {"readout_comparison", result.readout_comparison.empty() ? Json() : readoutJson(result)},
      {"comparison", result.comparison ? comparisonJson(*result.comparison) : Json()},
      {"board_comparison", result.board_comparison ? comparisonJson(*result.board_comparison) : Json()},
      {"worst_images", std::move(worst)},
      {"strays", std::move(strays)},
      {"causes", result.causes},
      {"better_model", result.better_model ? Json{{"name", result.better_model->name},
                                                  {"rms_px", result.better_model->rms_px}}
                                           : Json()},
      {"rejected_corners", grossJson(result, result.rejected)},
      {"gross_corners", grossJson(result, result.gross)},
      {"notes", notes(result)},
      {"images", std::move(images)},
      {"quality", result.quality ? qualityJson(result) : Json()}};
  if (streams) addStreams(*streams, reference, json);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";  // names need not be UTF-8
}

}  // namespace slom::app::calib
