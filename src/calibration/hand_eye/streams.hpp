// The two streams as a fit takes them: rows of the slower one, a track through the faster one.
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/hand_eye/track.hpp"

namespace slom::calibration {

/// Both poses at one moment.
struct BothPoses {
  SE3 hand, camera;
};

/// Rows and track. Times of each stream count from its first pose. The offset between them is the shift
/// t_hand - t_camera in these times.
struct Streams {
  Streams(const PoseStream& hand, const PoseStream& camera);

  std::vector<StampedPose> rows;     ///< of the slower stream
  std::vector<std::size_t> indices;  ///< of the rows in their stream
  Track hand, camera;
  double origin_hand = 0, origin_camera = 0;  ///< times of the first poses
  bool interpolates_hand = true;              ///< the camera is the slower one

  /// Returns the shift for a time offset t_hand - t_camera of the clocks.
  double shiftOf(double offset) const { return offset + origin_camera - origin_hand; }
  double offsetOf(double shift) const { return shift - origin_camera + origin_hand; }
  /// Returns the time of a row in the other stream.
  double otherTime(const StampedPose& row, double shift) const {
    return interpolates_hand ? row.t_s + shift : row.t_s - shift;
  }
  bool covers(const StampedPose& row, double shift) const {
    return (interpolates_hand ? hand : camera).covers(otherTime(row, shift));
  }
  BothPoses at(const StampedPose& row, double shift) const {
    const auto other = (interpolates_hand ? hand : camera).at(otherTime(row, shift));
    const SE3 pose(other.orient, vec3(other.pos));
    return interpolates_hand ? BothPoses{pose, row.pose} : BothPoses{row.pose, pose};
  }
  /// Returns the indices of the rows that have a pose of the other stream at their time.
  std::vector<std::size_t> covered(double shift) const;
};

/// Returns the root mean square distance of the positions of the rows from their mean [m].
double extentOf(const Streams& streams);

/// What a hand-eye calibration estimates.
struct HandEyeValues {
  SE3 hand_T_camera, base_T_target;
  double shift = 0, scale = 1;
};

/// Two rows of a motion.
struct RowPair {
  std::size_t from = 0, to = 0;
};

/// Returns, for each of the rows (indices, rising), the first one at least `length` later, if there is none but a gap
/// between, nothing.
std::vector<RowPair> motionsOver(const Streams& streams, const std::vector<std::size_t>& rows, double length);

}  // namespace slom::calibration
