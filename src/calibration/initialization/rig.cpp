#include "calibration/initialization/rig.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "calibration/text.hpp"
#include "slom/calibration/error.hpp"

namespace slom::calibration {
namespace {

/// The pose from camera a to camera b according to one common image.
struct Vote {
  SE3 a2b;
  vec3 board;  ///< centre of the board in camera a
};

std::vector<Vote> votes(const CameraData& a, const ViewPoses& world2a, const ViewPoses& world2b) {
  std::vector<Vote> result;
  for (const View& view : a.views) {
    const auto in_b = world2b.find(view.image);
    if (in_b == world2b.end()) continue;
    vec3 centre;
    for (const Corner& corner : view.corners) centre += corner.world / double(view.corners.size());
    const SE3& to_a = world2a.at(view.image);
    result.push_back({in_b->second * to_a.inverse(), to_a * centre});
  }
  return result;
}

bool isFinite(const Vote& vote) {
  return vote.a2b.pos.allFinite() && vote.a2b.orient.coeffs().allFinite() && vote.board.allFinite();
}

/// Returns the vote that agrees best with the others: least sum of the angles between the board centres as both votes
/// place them, plus the differences in rotation. One bad pose among three does no harm. Returns nothing if no sum is
/// finite.
std::optional<SE3> consensusOf(const std::vector<Vote>& all) {
  std::optional<SE3> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Vote& candidate : all) {
    double sum = 0;
    for (const Vote& other : all) {
      if (!isFinite(other)) continue;
      sum += (candidate.a2b * other.board - other.a2b * other.board).norm() / other.board.norm() +
             SO3::log(candidate.a2b.orient.inverse() * other.a2b.orient).norm();
    }
    if (isFinite(candidate) && sum < least) best = candidate.a2b, least = sum;
  }
  return best;
}

[[noreturn]] void refusePair(const CameraData& a, const CameraData& b, std::size_t images) {
  throw DataError(
      "slom.calibration.no-pose",
      fmt::format("{}: {} that camera {} shares with camera {} {} no finite pose between the two; look for "
                  "corners and world points that are wrong",
                  nameOf(b), counted(images, "image"), b.name, a.name, images == 1 ? "gives" : "give"),
      b.name);
}

std::vector<SE3> cameraPoses(const Dataset& data, const std::vector<ViewPoses>& world2camera) {
  std::vector<std::optional<SE3>> left2camera(data.cameras.size());
  left2camera[0] = SE3();
  for (std::size_t tied = 1; tied < data.cameras.size(); ++tied) {
    std::size_t from = 0, to = 0;
    std::vector<Vote> most;
    for (std::size_t a = 0; a < data.cameras.size(); ++a) {
      for (std::size_t b = 0; b < data.cameras.size(); ++b) {
        if (!left2camera[a] || left2camera[b]) continue;
        std::vector<Vote> common = votes(data.cameras[a], world2camera[a], world2camera[b]);
        if (common.size() > most.size()) from = a, to = b, most = std::move(common);
      }
    }
    const std::optional<SE3> pose = consensusOf(most);
    if (!pose) refusePair(data.cameras[from], data.cameras[to], most.size());
    left2camera[to] = *pose * *left2camera[from];
  }
  std::vector<SE3> result;
  for (const auto& pose : left2camera) result.push_back(*pose);
  return result;
}

/// Returns the camera whose view gives the pose of an image.
std::size_t bestObserver(const Dataset& data, int image) {
  if (data.cameras.front().find(image)) return 0;
  std::size_t best = 0, most = 0;
  for (std::size_t c = 1; c < data.cameras.size(); ++c) {
    const View* view = data.cameras[c].find(image);
    if (view && view->corners.size() > most) best = c, most = view->corners.size();
  }
  return best;
}

}  // namespace

RigStart startRig(const Dataset& data, const std::vector<ViewPoses>& world2camera) {
  RigStart rig{cameraPoses(data, world2camera), {}};
  for (const int image : data.images()) {
    const std::size_t c = bestObserver(data, image);
    rig.left2world[image] = world2camera[c].at(image).inverse() * rig.left2camera[c];
  }
  return rig;
}

}  // namespace slom::calibration
