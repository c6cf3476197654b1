#include "calibrate/detect/find_corners.hpp"

#include <algorithm>
#include <exception>
#include <map>

#include <fmt/format.h>

#include <slom/base/threads.hpp>

#include "calibrate/detect/board_size.hpp"
#include "calibrate/detect/detector.hpp"
#include "calibrate/detect/marker_layout.hpp"
#include "calibrate/detect/progress_bar.hpp"
#include "error.hpp"
#include "fitting/fit_limits.hpp"
#include "text.hpp"

namespace slom::app::calib {
namespace {

/// The content of one photograph.
struct Seen {
  std::optional<ImageSize> size;  ///< nothing: it cannot be read
  std::vector<FoundCorner> corners;
  std::string reason;  ///< why there are no corners
};

Seen look(const Board& board, const std::string& file) {
  Seen seen;
  const auto photo = readPhotograph(file, seen.reason);
  if (!photo) return seen;
  constexpr int least_side = 16;
  if (std::min(photo->size.width, photo->size.height) < least_side) {
    seen.reason =
        fmt::format("has {} x {} pixels, too few to show a board", photo->size.width, photo->size.height);
    return seen;
  }
  try {
    seen.corners = findBoard(board, *photo);
  } catch (const UserError&) {
    throw;
  } catch (const std::exception&) {  // thrown by OpenCV, whose texts address programmers
    seen.reason = "cannot be searched for the board by OpenCV";
    return seen;
  }
  seen.size = photo->size;
  if (seen.corners.empty()) seen.reason = "shows no board";
  return seen;
}

/// Searches each photograph of each camera. The first index of the result is the camera.
std::vector<std::vector<Seen>> lookAtAll(const std::vector<CameraPhotos>& cameras, const Board& board,
                                         bool with_progress) {
  std::vector<std::vector<Seen>> seen;
  std::vector<std::pair<std::size_t, std::size_t>> jobs;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    seen.emplace_back(cameras[c].photos.size());
    for (std::size_t i = 0; i < seen[c].size(); ++i) jobs.emplace_back(c, i);
  }
  ProgressBar progress("looking for the board", jobs.size(), with_progress);
  forEachOnThreads(static_cast<int>(jobs.size()), [&](int job) {
    FitLimits::requireTime();
    const auto [c, i] = jobs[static_cast<std::size_t>(job)];
    seen[c][i] = look(board, cameras[c].photos[i].file);
    progress.step();
  });
  return seen;
}

using Sides = std::pair<int, int>;

Sides sidesOf(const ImageSize& size) { return {size.width, size.height}; }

/// Returns the size of more than half of the readable photographs.
ImageSize commonSize(const CameraPhotos& camera, const std::vector<Seen>& seen) {
  std::map<Sides, std::size_t> count;
  std::size_t all = 0;
  for (const Seen& photo : seen) {
    if (photo.size) ++count[sidesOf(*photo.size)], ++all;
  }
  const auto [common, most] = *std::max_element(
      count.begin(), count.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  for (std::size_t i = 0; i < seen.size() && 2 * most <= all; ++i) {
    if (!seen[i].size || sidesOf(*seen[i].size) == common) continue;
    throw UserError(fmt::format(
        "{}: has {} x {} pixels, but {} of camera {} {} {} x {}; most photographs of a camera must have "
        "the same size, so leave out the others, or scale no photograph",
        camera.photos[i].file, seen[i].size->width, seen[i].size->height, plural(most, "other photograph"),
        camera.name, most == 1 ? "has" : "have", common.first, common.second));
  }
  return {common.first, common.second};
}

/// Removes the corners of photographs of another size, and says why.
void leaveOutOtherSizes(const ImageSize& common, std::vector<Seen>& seen) {
  for (Seen& photo : seen) {
    if (photo.corners.empty() || sidesOf(*photo.size) == sidesOf(common)) continue;
    photo.corners.clear();
    photo.reason = fmt::format("has {} x {} pixels, but most have {} x {}", photo.size->width,
                               photo.size->height, common.width, common.height);
  }
}

View viewOf(const Photo& photo, const Board& board, const std::vector<FoundCorner>& corners) {
  View view;
  view.image = photo.image;
  view.photo = photo.file;
  view.time_ns = timeInDigits(numberInName(photo.file));
  for (const FoundCorner& corner : corners)
    view.corners.push_back({corner.index + 1, board.corner(corner.index), corner.pixel});
  return view;
}

[[noreturn]] void refuseAll(const CameraPhotos& camera, const std::vector<Seen>& seen, const Board& board) {
  std::vector<std::string> readable;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (seen[i].size) readable.push_back(camera.photos[i].file);
  }
  if (readable.empty()) {
    throw UserError(fmt::format("{}: the file {}, like all photographs of camera {}; check the pattern",
                                camera.photos.front().file, seen.front().reason, camera.name));
  }
  throw UserError(fmt::format("{}: no photograph of camera {} shows the board {}; {}", readable.front(),
                              camera.name, toString(board), adviceOnSize(board)));
}

}  // namespace

std::vector<CameraData> findCorners(const std::vector<CameraFile>& cameras,
                                    const std::vector<CameraPhotos>& photos, const Board& board,
                                    bool with_progress) {
  for (const CameraPhotos& camera : photos) {
    std::vector<std::string> files;
    for (const Photo& photo : camera.photos) files.push_back(photo.file);
    requireSizeLikely(board, files);
    requireLayoutLikely(board, files);
  }
  auto seen = lookAtAll(photos, board, with_progress);
  std::vector<CameraData> result;
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    CameraData camera;
    camera.name = cameras[c].name;
    camera.file = cameras[c].file;
    camera.board_symmetry = board.symmetry();
    if (std::any_of(seen[c].begin(), seen[c].end(),
                    [](const Seen& photo) { return photo.size.has_value(); })) {
      camera.image_size = commonSize(photos[c], seen[c]);
      leaveOutOtherSizes(*camera.image_size, seen[c]);
    }
    for (const std::string& file : photos[c].unnumbered)
      camera.unused.push_back(
          {{}, file, "has no number in its name to pair photographs taken at the same time"});
    std::vector<std::string> with_board;
    for (std::size_t i = 0; i < seen[c].size(); ++i) {
      const Photo& photo = photos[c].photos[i];
      if (seen[c][i].corners.empty()) {
        camera.unused.push_back({photo.image, photo.file, seen[c][i].reason});
      } else {
        camera.views.push_back(viewOf(photo, board, seen[c][i].corners));
        with_board.push_back(photo.file);
      }
    }
    if (camera.views.empty()) refuseAll(photos[c], seen[c], board);
    requireWholeBoard(board, with_board);
    result.push_back(std::move(camera));
  }
  return result;
}

}  // namespace slom::app::calib
