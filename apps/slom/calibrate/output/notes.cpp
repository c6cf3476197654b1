#include "calibrate/output/notes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibrate/library.hpp"
#include "calibrate/soundness.hpp"
#include "printable.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

constexpr double sigma_mismatch =
    1.25;  // residuals larger or smaller than stated by this factor are worth a note
constexpr double together_mismatch = 1.2;  // RMS together over RMS alone

void noteDetermination(const Result& result, std::vector<std::string>& notes) {
  if (result.undetermined.empty()) return;
  notes.push_back(
      fmt::format("Not all parameters are determined ({}), so there are no standard deviations, and the "
                  "values must not be used. Add images from other directions and distances, or choose a "
                  "model with fewer parameters by --intrinsics.",
                  result.undetermined));
}

void noteBounds(const Result& result, std::vector<std::string>& notes) {
  for (const std::string& bound : result.active_bounds) {
    notes.push_back(
        fmt::format("{}, which --bound sets; the standard deviations hold if it stays there.", bound));
  }
}

std::string imageAndPhoto(int image, const std::string& photo) {
  return photo.empty() ? fmt::format("{}", image) : fmt::format("{} ({})", image, oneLine(photo));
}

/// Returns `image 4 (b.png) repeats image 1 (a.png)`, and in how many corners if not in all.
std::string repetition(const Copy& copy) {
  const std::string part = copy.equal_corners < copy.corners
                               ? fmt::format(" in {} of {} corners", copy.equal_corners, copy.corners)
                               : "";
  return fmt::format("image {} repeats image {}{}", imageAndPhoto(copy.image, copy.photo),
                     imageAndPhoto(copy.original, copy.original_photo), part);
}

void noteCopies(const Result& result, std::vector<std::string>& notes) {
  constexpr std::size_t most = 8;  // named in a sentence
  for (const CameraResult& camera : result.cameras) {
    if (camera.copies.empty()) continue;
    std::vector<std::string> named;
    double difference = 0;
    bool has_readings = false;
    for (const Copy& copy : camera.copies) {
      difference = std::max(difference, copy.difference_px);
      has_readings = has_readings || copy.has_reading;
      if (named.size() < most) named.push_back(repetition(copy));
    }
    const std::size_t more = camera.copies.size() - named.size();
    notes.push_back(fmt::format(
        "Camera {}: {}{} to within {:.3f} px, so {} left out; a copy is not a second measurement.{}",
        camera.name, fmt::join(named, ", "), more > 0 ? fmt::format(" and {} more repeat others", more) : "",
        difference, camera.copies.size() == 1 ? "it is" : "they are",
        has_readings ? " Readings of the IMU that belong to no other image are left out, too." : ""));
  }
}

void noteDenominator(const Result& result, std::vector<std::string>& notes) {
  if (!result.sigma_denominator) return;
  const Model model(result.cameras.front().model);
  if (result.board) {
    notes.push_back(fmt::format(
        "Numerator and denominator of {} can have the same effect, and so can a board of unknown shape. "
        "{} were therefore held at 0 +- {:g} each; the standard deviations hold if they stay there.",
        model.name(), fmt::join(model.heldNearZero(), ", "), *result.sigma_denominator));
    return;
  }
  notes.push_back(fmt::format(
      "The images do not determine {}, because numerator and denominator of {} have the same effect "
      "there. These were held at 0 +- {:g} each; the standard deviations hold if they stay there. A model "
      "with fewer parameters does as well: --intrinsics opencv5{}.",
      fmt::join(model.heldNearZero(), ", "), model.name(), *result.sigma_denominator,
      result.comparison ? "" : ", or --compare"));
}

/// Notes residuals that contradict a stated sigma. `squares`: sum of squared residuals of one kind, to which
/// `unknowns` of the fit belong.
void noteSigma(const char* what, const char* option, double stated, double squares, double residuals,
               double unknowns, std::vector<std::string>& notes) {
  if (!(squares > 0) || residuals <= unknowns) return;
  const double observed = std::sqrt(squares / (residuals - unknowns));
  if (std::abs(std::log(observed / stated)) < std::log(sigma_mismatch)) return;
  const bool larger = observed > stated;
  notes.push_back(
      fmt::format("The residuals of {} are {:.1f} times {} than {} {:g} predicts; {} {} would fit them{}. "
                  "The stated standard deviations follow from the stated sigmas.",
                  what, larger ? observed / stated : stated / observed, larger ? "larger" : "smaller", option,
                  stated, option, twoDigits(observed),
                  larger ? ", unless the model is too simple or the worst images are wrong" : ""));
}

void noteSigmas(const Result& result, std::vector<std::string>& notes) {
  double squares = 0, corners = 0;
  for (const CameraResult& camera : result.cameras) {
    squares += camera.rms_px * camera.rms_px * double(camera.corners);
    corners += double(camera.corners);
  }
  // A loss downweights large residuals, so the noise of most corners is compared.
  if (result.downweighted)
    squares = std::pow(result.downweighted->noise_px, 2) * std::max(0.0, 2 * corners - result.unknowns);
  double of_imu = 0;  // unknowns that the readings alone determine
  if (result.imu)
    of_imu = 3 + (result.imu->acc_bias_is_fixed ? 0 : 3) + (result.imu->gravity_is_fixed ? 0 : 1);
  noteSigma("the corners", "--sigma-px", result.sigma_px, squares, 2 * corners, result.unknowns - of_imu,
            notes);
  if (!result.imu) return;
  const double readings = double(result.imu->readings);
  noteSigma("the IMU", "--sigma-acc", result.sigma_acc, std::pow(result.imu->rms_acc, 2) * readings,
            3 * readings, of_imu, notes);
}

/// Returns the name of the other one of two cameras.
const std::string& otherThan(const std::string& name, const Result& result) {
  return result.cameras.front().name == name ? result.cameras.back().name : result.cameras.front().name;
}

/// Notes cameras most of whose views contradict the others, one note for each. Returns the strays of the other
/// cameras.
std::vector<Stray> noteWrongNumbers(const Result& result, std::vector<std::string>& notes) {
  constexpr std::size_t fewest = 3;
  std::vector<Stray> rest = result.strays;
  if (result.cameras.size() < 2) return rest;
  for (const CameraResult& camera : result.cameras) {
    const auto is_own = [&](const Stray& stray) { return stray.camera == camera.name; };
    const std::size_t own = std::size_t(std::count_if(rest.begin(), rest.end(), is_own));
    if (own < fewest || 2 * own <= camera.images) continue;
    std::vector<double> errors;
    for (const Stray& stray : rest) {
      if (is_own(stray)) errors.push_back(std::isfinite(stray.error_px) ? stray.error_px : most_corner_px);
    }
    std::sort(errors.begin(), errors.end());
    const auto known = std::find_if(rest.begin(), rest.end(), [&](const Stray& stray) {
      return is_own(stray) && !stray.why.empty() && !stray.is_mirrored;
    });
    if (known != rest.end()) {
      notes.push_back(fmt::format(
          "{} of the {} images of camera {} contradict those of the other cameras: {}. Count its corners "
          "from the same end as for the other cameras, or use a board that looks different from each end.",
          own, camera.images, camera.name, known->why));
      std::erase_if(rest, is_own);
      continue;
    }
    notes.push_back(fmt::format(
        "{} of the {} images of camera {} contradict those of {}, by {} to {} px. Image numbers or time "
        "stamps of this camera do not match those of {}; correct them.",
        own, camera.images, camera.name,
        result.cameras.size() == 2 ? "camera " + otherThan(camera.name, result) : "the other cameras",
        fixedDecimals(errors.front(), 0), fixedDecimals(errors.back(), 0),
        result.cameras.size() == 2 ? "the other one" : "the others"));
    std::erase_if(rest, is_own);
  }
  return rest;
}

/// Notes a view that the fit leaves out.
void noteLeftOut(const Stray& stray, const Result& result, std::vector<std::string>& notes) {
  const std::string name = result.cameras.size() > 1 ? stray.camera + "." : "";
  if (stray.is_mirrored) {
    notes.push_back(fmt::format(
        "Image {} of camera {}{} contradicts the others: {}. The fit left it out; pass --exclude {}{} or "
        "correct it.",
        stray.image, stray.camera, stray.photo.empty() ? "" : " (" + oneLine(stray.photo) + ")", stray.why,
        name, stray.image));
    return;
  }
  notes.push_back(fmt::format(
      "Image {} of camera {}{} contradicts the others: in its best pose, corners are {} px off (RMS){}. "
      "The fit left it out; pass --exclude {}{} or correct it.",
      stray.image, stray.camera, stray.photo.empty() ? "" : " (" + oneLine(stray.photo) + ")",
      twoDigits(stray.error_px), stray.why.empty() ? "" : "; " + stray.why, name, stray.image));
}

void noteStrays(const Result& result, std::vector<std::string>& notes) {
  constexpr std::size_t most = 4;  // named one by one
  std::vector<Stray> strays = noteWrongNumbers(result, notes);
  for (const Stray& stray : strays) {
    if (stray.is_left_out) noteLeftOut(stray, result, notes);
  }
  std::erase_if(strays, [](const Stray& stray) { return stray.is_left_out; });
  for (const Stray& stray : strays) {
    if (std::size_t(&stray - strays.data()) == most) {
      std::vector<std::string> more;
      for (std::size_t i = most; i < strays.size(); ++i)
        more.push_back(fmt::format("{}.{}", strays[i].camera, strays[i].image));
      notes.push_back(fmt::format(
          "{} the others in the same way: {}.",
          more.size() == 1 ? "1 more view contradicts" : fmt::format("{} more views contradict", more.size()),
          fmt::join(more, ", ")));
      break;
    }
    const bool is_alone = result.cameras.size() == 1;
    const std::string question =
        is_alone ? fmt::format("Leave it out (--exclude {}), or check", stray.image)
                 : fmt::format(
                       "Was it taken at the same time as image {} of {}? If not, leave it out (--exclude "
                       "{}.{}) or correct its number. Otherwise check",
                       stray.image,
                       result.cameras.size() == 2 ? "camera " + otherThan(stray.camera, result)
                                                  : "the other cameras",
                       stray.camera, stray.image);
    notes.push_back(fmt::format(
        "Image {} of camera {}{} contradicts the others by {} px. {} whether its corners were taken for "
        "their neighbours, a row or column further{}.",
        stray.image, stray.camera, stray.photo.empty() ? "" : " (" + oneLine(stray.photo) + ")",
        fixedDecimals(stray.error_px, 0), question,
        result.cameras.front().board_symmetry > 1
            ? ", or counted from another end: this board looks the same when it is turned"
            : ""));
  }
}

/// Notes the likely causes of a failed or bad fit.
void noteCauses(const Result& result, std::vector<std::string>& notes) {
  const bool is_said = !result.causes.empty() && result.causes.front() == result.undetermined;
  if (result.better_model || (!result.causes.empty() && !is_said))
    notes.push_back(capitalised(causeText(result)) + ".");
}

/// Notes single corners that lie much farther off than the worst ones of most images.
void noteCorners(const Result& result, std::vector<std::string>& notes) {
  constexpr std::size_t least_images = 4;
  constexpr double much = 4;
  if (result.images.size() < least_images) return;
  std::vector<double> worst;
  for (const ImageResult& image : result.images) worst.push_back(image.worst_corner.error_px);
  const auto middle = worst.begin() + std::ptrdiff_t(worst.size() / 2);
  std::nth_element(worst.begin(), middle, worst.end());
  for (const ImageResult& image : result.images) {
    const WorstCorner& corner = image.worst_corner;
    if (!(corner.error_px > much * *middle)) continue;
    notes.push_back(fmt::format(
        "Corner {} of image {} of camera {} ({}) is {:.1f} px from where the fit puts it; the worst "
        "corners of most images are {:.1f} px off. The corner was found wrongly: correct it or pass "
        "--exclude {}{}:{}.",
        corner.number, image.image, result.cameras[corner.camera].name, oneLine(corner.place),
        corner.error_px, *middle, result.cameras.size() > 1 ? result.cameras[corner.camera].name + "." : "",
        image.image, corner.number));
  }
}

/// Notes corners that the fit leaves out.
void noteRejected(const Result& result, std::vector<std::string>& notes) {
  constexpr std::size_t most = 5;  // named one by one
  if (result.rejected.empty()) return;
  std::vector<std::string> named;
  for (const GrossCorner& corner : result.rejected) {
    if (named.size() == most) break;
    named.push_back(fmt::format("corner {} of image {} of camera {} ({}) by {:.1f} px", corner.number,
                                corner.image, result.cameras[corner.camera].name, oneLine(corner.place),
                                corner.error_without_px));
  }
  const std::size_t more = result.rejected.size() - named.size();
  notes.push_back(fmt::format(
      "{} left out of the fit, because the others contradict {}: {}{}. --robust none keeps {}.",
      result.rejected.size() == 1 ? "One corner was" : fmt::format("{} corners were", result.rejected.size()),
      result.rejected.size() == 1 ? "it" : "them", fmt::join(named, ", "),
      more > 0 ? fmt::format(", and {} more", more) : "", result.rejected.size() == 1 ? "it" : "them"));
}

/// Notes corners that the fit follows, so that their residuals hide how wrong they are.
void noteLeverage(const Result& result, std::vector<std::string>& notes) {
  constexpr std::size_t most = 5;  // named one by one
  constexpr double hidden = 1.5;   // error without the corner over its residual
  std::size_t count = 0;
  for (const GrossCorner& corner : result.gross) {
    if (!(corner.error_without_px > hidden * corner.error_px) || ++count > most) continue;
    const std::string& camera = result.cameras[corner.camera].name;
    notes.push_back(fmt::format(
        "Corner {0} of image {1} of camera {2} ({3}) pulls the fit towards it: it is {4:.1f} px off, and "
        "{5:.1f} px in a fit without it. Check it or pass --exclude {6}{1}:{0}.",
        corner.number, corner.image, camera, oneLine(corner.place), corner.error_px, corner.error_without_px,
        result.cameras.size() > 1 ? camera + "." : ""));
  }
  if (count > most)
    notes.push_back(
        fmt::format("{} more corners pull the fit towards them; the JSON lists them.", count - most));
}

/// Returns whether the images of a camera seem to have another time than those of the first one.
bool hasOtherTimes(const Result& result) {
  if (!result.quality) return false;
  const auto& patterns = result.quality->patterns;
  return std::any_of(patterns.begin(), patterns.end(), [](const ResidualPattern& pattern) {
    return pattern.kind == ResidualPattern::Kind::time_offset && pattern.isFound();
  });
}

void noteTogether(const Result& result, std::vector<std::string>& notes) {
  if (hasOtherTimes(result)) return;  // which says why
  for (const CameraResult& camera : result.cameras) {
    if (!(camera.rms_px > together_mismatch * camera.rms_px_single)) continue;
    notes.push_back(
        fmt::format("Camera {} fits its images to {:.3f} px alone, but to {:.3f} px together with the "
                    "rest: look for images that were not taken at the same time, image numbers that do not "
                    "belong together, or a part that moved.",
                    camera.name, camera.rms_px_single, camera.rms_px));
  }
}

void noteImu(const Result& result, std::vector<std::string>& notes) {
  for (const ImuFinding& finding : imuFindings(result)) {
    const std::string remedy =
        finding.kind == ImuFinding::Kind::weak
            ? "The table of the imu shows the gain from --fix gravity=9.81 or --fix acc_bias=X,Y,Z; "
              "images with more tilt, about both axes, help without such assumptions"
            : capitalised(remedyOf(finding, result));
    notes.push_back(fmt::format("{}. {}.", capitalised(finding.fault), remedy));
  }
}

/// Notes by how much shared errors enlarge the clustered standard deviations, and the limits of these.
void noteClustered(const Result& result, std::vector<std::string>& notes) {
  constexpr double worth_a_note = 1.5;
  if (!result.clustered) return;
  const ClusteredUncertainty& clustered = *result.clustered;
  if (clustered.isReliable() && clustered.ratio > worth_a_note) {
    notes.push_back(fmt::format(
        "Errors are not independent: over all parameters, the clustered standard deviations are {} times "
        "the stated ones. Errors shared within an image give a factor of {}{}{}. If the clustered ones "
        "are larger, trust them.",
        fixedDecimals(clustered.ratio, 1), fixedDecimals(clustered.ratio_by_image, 1),
        clustered.block_length > 1 ? fmt::format(", with errors shared by successive images {}",
                                                 fixedDecimals(clustered.ratio_by_block, 1))
                                   : "",
        clustered.board_points > 0 ? fmt::format(", with errors at the same corner of the board {}",
                                                 fixedDecimals(clustered.ratio, 1))
                                   : ""));
  }
  for (std::string& sentence : sentencesOf(clustered)) notes.push_back(std::move(sentence));
}

/// Returns whether a pattern says that an image or its rows have another time than stated.
bool isOfTimes(const ResidualPattern& pattern) {
  return pattern.kind == ResidualPattern::Kind::time_offset ||
         pattern.kind == ResidualPattern::Kind::row_readout;
}

/// Notes why errors are not independent, as far as residuals show it: because of wrong times, or for other reasons.
void notePatterns(const Result& result, bool of_times, std::vector<std::string>& notes) {
  if (!result.quality) return;
  for (const ResidualPattern& pattern : result.quality->patterns) {
    if (!pattern.isFound() || isExplained(pattern, result) || isOfTimes(pattern) != of_times) continue;
    notes.push_back(capitalised(sentenceOf(pattern, result)) + ".");
  }
}

}  // namespace

std::vector<std::string> notes(const Result& result) {
  std::vector<std::string> notes;
  noteDetermination(result, notes);
  noteBounds(result, notes);
  noteCopies(result, notes);
  noteDenominator(result, notes);
  noteStrays(result, notes);
  noteCauses(result, notes);
  if (result.success()) notePatterns(result, true, notes);
  noteRejected(result, notes);
  if (result.strays.empty()) noteCorners(result, notes);
  if (result.strays.empty()) noteLeverage(result, notes);
  if (result.strays.empty()) noteTogether(result, notes);
  if (result.success() && result.strays.empty()) noteSigmas(result, notes);
  noteClustered(result, notes);
  if (result.success()) notePatterns(result, false, notes);
  noteImu(result, notes);
  return notes;
}

}  // namespace slom::app::calib
