#include "calibration/hand_eye/streams.hpp"

#include <cmath>

namespace slom::calibration {

Streams::Streams(const PoseStream& hand_stream, const PoseStream& camera_stream)
    : hand(hand_stream.poses, hand_stream.poses.front().t_s),
      camera(camera_stream.poses, camera_stream.poses.front().t_s),
      origin_hand(hand_stream.poses.front().t_s),
      origin_camera(camera_stream.poses.front().t_s),
      interpolates_hand(hand.step() <= camera.step()) {
  const std::vector<StampedPose>& slow = interpolates_hand ? camera_stream.poses : hand_stream.poses;
  const double origin = slow.front().t_s;
  for (std::size_t i = 0; i < slow.size(); ++i) {
    if (i > 0 && slow[i].t_s - origin <= rows.back().t_s) continue;
    rows.push_back({slow[i].t_s - origin, slow[i].pose, slow[i].line});
    indices.push_back(i);
  }
}

std::vector<std::size_t> Streams::covered(double shift) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (covers(rows[i], shift)) result.push_back(i);
  }
  return result;
}

double extentOf(const Streams& streams) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto n = double(streams.rows.size());
  for (const StampedPose& row : streams.rows) mean += row.pose.pos / n;
  double sum = 0;
  for (const StampedPose& row : streams.rows) sum += (row.pose.pos - mean).squaredNorm() / n;
  return std::sqrt(sum);
}

std::vector<RowPair> motionsOver(const Streams& streams, const std::vector<std::size_t>& rows,
                                 double length) {
  std::vector<RowPair> motions;
  std::size_t to = 0;
  for (const std::size_t from : rows) {
    const double start = streams.rows[from].t_s;
    while (to < rows.size() && streams.rows[rows[to]].t_s < start + length) ++to;
    if (to == rows.size()) break;
    if (streams.rows[rows[to]].t_s < start + 1.5 * length) motions.push_back({from, rows[to]});
  }
  return motions;
}

}  // namespace slom::calibration
