#include "calibrate/output/report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/library.hpp"
#include "calibrate/output/notes.hpp"
#include "calibrate/soundness.hpp"
#include "fitting/progress.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

/// Returns `+- 0.81`. A fixed value has no standard deviation.
std::string plusMinus(double value, double std) {
  const ValueText text = withStd(value, std);
  return std > 0 && std::isfinite(std) ? "+- " + text.std : text.std;
}

}  // namespace

std::string valueLine(const std::string& name, double value, double std, double clustered,
                      const std::string& unit) {
  const std::string second = std > 0 && !std::isnan(clustered) ? plusMinus(value, clustered) : "";
  const std::string line = fmt::format("  {:<14}{:>12} {:<13}{:<13}{}", name, withStd(value, std).value,
                                       plusMinus(value, std), second, unit);
  return line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
}

std::string vectorLines(const std::string& name, const vec3& value, const vec3& std, const vec3& clustered,
                        const std::string& unit) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += valueLine(fmt::format("{}.{}", name, "xyz"[i]), value[i], std[i], clustered[i], unit);
  return text;
}

std::string rotationLines(const SO3& R, const vec3& std, const vec3& clustered) {
  return vectorLines("rotation", vec3(SO3::log(R) * degrees), vec3(std * degrees), vec3(clustered * degrees),
                     "deg");
}

namespace {

std::string columnTitles(const Result& result) {
  return result.clustered ? fmt::format("  {:<26} {:<13}{}\n", "", "stated", "clustered") : "";
}

std::string unitOf(const std::string& parameter) {
  return parameter[0] == 'f' || parameter[0] == 'c' ? "px" : "";
}

std::string cameraLines(const Result& result, const CameraResult& camera) {
  const std::string& reference = result.cameras.front().name;
  std::string text = fmt::format("\ncamera {}: {}, {}, {}, RMS {} px", camera.name, camera.model,
                                 plural(camera.images, "image"), plural(camera.corners, "corner"),
                                 fixedDecimals(camera.rms_px, 4));
  text +=
      std::isfinite(camera.rms_px_single) ? fmt::format(" (alone {:.4f} px)\n", camera.rms_px_single) : "\n";
  text += columnTitles(result);
  for (const Parameter& p : camera.parameters)
    text += valueLine(p.name, p.value, p.std, p.std_clustered, unitOf(p.name));
  if (camera.noise.growth > 0) {
    text += fmt::format(
        "  sigma of the corners, by {}: {} and {} times the stated one in the lower and upper quarter of images\n",
        toString(camera.noise.by), fixedDecimals(camera.noise.lower_quarter, 2),
        fixedDecimals(camera.noise.upper_quarter, 2));
  }
  if (camera.noise.by != SigmaBy::constant && camera.noise.growth == 0)
    text += fmt::format("  sigma of the corners: does not grow with {}\n", toString(camera.noise.by));
  if (camera.readout) {
    text += valueLine("readout", camera.readout->value, camera.readout->std, camera.readout->std_clustered,
                      "intervals between image numbers, first to last row");
  }
  if (camera.name == reference) return text;
  text += fmt::format("  from {0} to {1}, p_{1} = R p_{0} + t:\n", reference, camera.name);
  text += vectorLines("translation", camera.left2camera.pos, camera.translation_std,
                      camera.translation_clustered.std, "m");
  return text + rotationLines(camera.left2camera.orient, camera.rotation_vector_std,
                              camera.rotation_vector_clustered.std);
}

/// Returns a table with the largest standard deviations of the axes, now and with gravity or acc_bias fixed.
std::string precisionTable(const ImuResult& imu) {
  const auto row = [&](const char* name, const char* unit, double scale, double ImuPrecision::*what) {
    std::string text = fmt::format("    {:<10}{:<8}", name, unit);
    for (const ImuPrecision* p : {&imu.precision, &imu.if_gravity_fixed, &imu.if_acc_bias_fixed}) {
      text += fmt::format("{:>16}", p->*what > 0 ? twoDigits(scale * (p->*what)) : "fixed");
    }
    return text + "\n";
  };
  return fmt::format("  largest std {:>22}{:>16}{:>16}\n", "now", "gravity fixed", "acc_bias fixed") +
         row("rotation", "deg", degrees, &ImuPrecision::rotation) +
         row("acc_bias", "m/s^2", 1, &ImuPrecision::acc_bias) +
         row("gravity", "m/s^2", 1, &ImuPrecision::gravity);
}

std::string imuLines(const Result& result, const ImuResult& imu) {
  std::string text = fmt::format("\nimu: {}, RMS {} m/s^2\n", plural(imu.readings, "reading"),
                                 fixedDecimals(imu.rms_acc, 4));
  text += columnTitles(result);
  text += vectorLines("acc_bias", imu.acc_bias, imu.acc_bias_std, imu.acc_bias_clustered.std, "m/s^2");
  text += valueLine("gravity", imu.gravity, imu.gravity_std, imu.gravity_std_clustered, "m/s^2");
  text += fmt::format("  from {} to imu:\n", result.cameras.front().name);
  text += rotationLines(imu.left2imu, imu.rotation_vector_std, imu.rotation_vector_clustered.std);
  const bool is_open = std::isfinite(imu.gravity_std) && !(imu.acc_bias_is_fixed && imu.gravity_is_fixed);
  return is_open ? text + precisionTable(imu) : text;
}

std::string boardLines(const FittedBoard& board) {
  constexpr double mm = 1000;
  const auto largest = std::max_element(board.corners.begin(), board.corners.end(),
                                        [](const MovedCorner& a, const MovedCorner& b) {
                                          return a.displacement.norm() < b.displacement.norm();
                                        });
  std::string text = fmt::format("\nboard: {}, {}, RMS from their stated positions: {} mm off the plane",
                                 toString(board.shape), plural(board.corners.size(), "corner"),
                                 twoDigits(mm * board.off_plane));
  if (board.shape == BoardShape::free)
    text += fmt::format(", {} mm within it along each axis", twoDigits(mm * board.within_plane));
  return text + fmt::format("\n  the farthest is corner {}, by {} mm, known to {} mm in each coordinate\n",
                            largest->number, twoDigits(mm * largest->displacement.norm()),
                            twoDigits(mm * largest->std.maxCoeff()));
}

std::string downweightedLines(const Downweighted& down) {
  return fmt::format("\nrobust loss {}: {} with less than half the weight, the least {}; noise {} px\n",
                     down.loss, plural(down.corners, "corner"), twoDigits(down.least),
                     twoDigits(down.noise_px));
}

Outcome outcomeOf(const Result& r) {
  return {r.converged, r.iterations, r.stop_reason, r.message, r.measurements, r.unknowns, r.rss};
}

std::string worstLines(const Result& result) {
  std::string text = "\nworst images, by chi2 per measurement\n  image    chi2/m";
  for (const CameraResult& camera : result.cameras) text += fmt::format("{:>12}", camera.name + " px");
  if (result.imu) text += "   imu m/s^2";
  text += "   worst corner\n";
  for (const ImageResult* image : result.worstImages(5)) {
    text += fmt::format("{:>7} {:>9.3f}", image->image, image->chi2PerMeasurement());
    for (const auto& rms : image->rms_px)
      text += rms ? fmt::format("{:>12.3f}", *rms) : fmt::format("{:>12}", "-");
    if (result.imu)
      text += image->acc_error ? fmt::format("{:>12.3f}", *image->acc_error) : fmt::format("{:>12}", "-");
    const WorstCorner& worst = image->worst_corner;
    text += fmt::format("   {:.2f} px, corner {} ({})\n", worst.error_px, worst.number, oneLine(worst.place));
  }
  return text;
}

/// Returns the first of `names`, and the number of the others.
std::string abridged(std::vector<std::string> names) {
  constexpr std::size_t most = 12;  // names in a line
  const std::size_t more = names.size() - std::min(most, names.size());
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more", more) : "");
}

/// Returns the photographs and copies that were left out, by reason.
std::string unusedText(const CameraData& camera) {
  std::map<std::string, std::vector<std::string>> files;
  for (const UnusedPhoto& photo : camera.unused)
    files["because it " + photo.reason].push_back(oneLine(photo.file));
  for (const Copy& copy : camera.copies)
    files["because it repeats another image"].push_back(
        copy.photo.empty() ? fmt::format("image {}", copy.image) : oneLine(copy.photo));
  for (const Exclusion& one : camera.excluded)
    files["by --exclude"].push_back(one.corner ? fmt::format("corner {} of image {}", *one.corner, one.image)
                                               : fmt::format("image {}", one.image));
  std::string text;
  for (auto& [reason, names] : files)
    text += fmt::format("  {}: left out, {}: {}\n", camera.name, reason, abridged(std::move(names)));
  return text;
}

/// Returns the images that no other camera has. They do not help to place the cameras.
std::string aloneText(const Dataset& data, const CameraData& camera) {
  std::vector<std::string> images;
  for (const View& view : camera.views) {
    const bool is_alone = std::none_of(
        data.cameras.begin(), data.cameras.end(),
        [&](const CameraData& other) { return &other != &camera && other.find(view.image) != nullptr; });
    if (is_alone) images.push_back(std::to_string(view.image));
  }
  if (data.cameras.size() < 2 || images.empty()) return "";
  return fmt::format("  {}: in no other camera: {} {}\n", camera.name,
                     images.size() == 1 ? "image" : "images", abridged(std::move(images)));
}

/// Returns the size of the board. With a wrong unit, all distances would be wrong, but a single camera would come out
/// the same.
std::string boardText(const Dataset& data) {
  const auto less = [](const vec3& a, const vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::set<vec3, decltype(less)> points(less);
  for (const CameraData& camera : data.cameras) {
    for (const View& view : camera.views) {
      for (const Corner& corner : view.corners) points.insert(corner.world);
    }
  }
  if (points.empty()) return "";
  const auto farthestFrom = [&](const vec3& origin) {
    return *std::max_element(points.begin(), points.end(), [&](const vec3& a, const vec3& b) {
      return (a - origin).squaredNorm() < (b - origin).squaredNorm();
    });
  };
  const vec3 one = farthestFrom(*points.begin());  // at one end of the board, for any axes
  return fmt::format("  {:<10}{:>5} points{:20}{:.3g} m across\n", "board", points.size(), "",
                     (farthestFrom(one) - one).norm());
}

/// Returns the verdict on a usable result. If the result is not usable, the command ends with a reason instead.
std::string verdictLines(const Result& result, const char* heading) {
  if (!result.quality || !result.success() || !unsoundnessOf(result).isNone()) return "";
  return verdictText(heading, verdictOf(result));
}

}  // namespace

std::string verdictText(const char* heading, const Verdict& verdict) {
  std::string text = fmt::format("\n{}: {}\n", heading, toString(verdict.level)) + bulleted(verdict.sentence);
  for (std::size_t i = 1; i < verdict.doubts.size(); ++i)  // the sentence has the first
    text += bulleted(capitalised(verdict.doubts[i]) + ".");
  return text;
}

std::string dataText(const Dataset& data) {
  std::string text = "data\n";
  for (const CameraData& camera : data.cameras) {
    text += fmt::format("  {:<10}{:>5} images {:>7} corners    {}\n", camera.name, camera.views.size(),
                        camera.cornerCount(), oneLine(camera.file));
  }
  for (const CameraData& camera : data.cameras) text += unusedText(camera) + aloneText(data, camera);
  text += boardText(data);
  if (data.imu)
    text += fmt::format("  {:<10}{:>5} readings{:18}{}\n", "imu", data.imu->readings.size(), "",
                        oneLine(data.imu->file));
  return text;
}

std::string aloneHeader(const CommandSettings& settings) {
  return fmt::format("\neach camera alone, model {}\n", settings.model.name());
}

std::string singleCameraText(const SingleCameraReport& alone) {
  const std::string outcome = alone.converged ? fmt::format("RMS {:.4f} px after {}", alone.rms_px,
                                                            plural(alone.iterations, "iteration"))
                                              : "no fit alone, start values are used";
  return fmt::format("  {:<10}{}; start: {}\n", alone.camera->name, outcome, alone.start);
}

std::string reportText(const Result& result, const char* heading_of_verdict) {
  std::string text = outcomeText(outcomeOf(result));
  for (const CameraResult& camera : result.cameras) text += cameraLines(result, camera);
  if (result.imu) text += imuLines(result, *result.imu);
  if (result.board) text += boardLines(*result.board);
  if (result.downweighted) text += downweightedLines(*result.downweighted);
  text += worstLines(result);
  const std::vector<std::string> sentences = notes(result);
  if (!sentences.empty()) text += "\nnotes\n";
  for (const std::string& sentence : sentences) text += bulleted(sentence);
  return text + verdictLines(result, heading_of_verdict);
}

}  // namespace slom::app::calib
