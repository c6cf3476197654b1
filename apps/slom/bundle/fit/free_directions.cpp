#include "bundle/fit/free_directions.hpp"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>

#include <slom/analyze/diagnosis.hpp>
#include <slom/estimator.hpp>

#include "bundle/fit/parts.hpp"

namespace slom::app::bundle {

namespace {

constexpr int camera_unknowns = 9, point_unknowns = 3;
/// Number of cameras above which a part is not diagnosed: its reduced system may be dense, and takes cameras^3.
constexpr std::size_t most_cameras = 600, few_cameras = 60;
/// Number of directions above which a part may have more than the diagnosis finds.
constexpr int most_found = 150;

/// Returns the direction along which a point can move without changing its images. If its rays are not parallel,
/// returns 0.
mtk::vect<3> freeDirectionOf(const Scene& scene, int point, const std::vector<int>& cameras) {
  constexpr double parallel = 1e-10;  // sine of the largest angle between two rays
  const auto ray = [&](int camera) {
    const mtk::vect<3> way =
        scene.points[std::size_t(point)] - scene.cameras[std::size_t(camera)].pose.inverse().pos;
    return mtk::vect<3>(way / way.norm());
  };
  const mtk::vect<3> first = ray(cameras.front());
  const bool is_free = std::all_of(cameras.begin(), cameras.end(),
                                   [&](int camera) { return first.cross(ray(camera)).norm() < parallel; });
  return is_free ? first : mtk::vect<3>(0, 0, 0);
}

class Count {
 public:
  Count(const Scene& scene, int threads, bool may_take_long)
      : scene_(scene), sightings_(scene), threads_(threads), may_take_long_(may_take_long) {}

  FreeDirections run() {
    takeAwayWhatIsSeenOnce();
    for (const Part& part : sightings_.parts()) diagnose(part);
    const int least = camera_unknowns * int(scene_.cameras.size()) +
                      point_unknowns * int(scene_.points.size()) - 2 * int(scene_.observations.size());
    if (!result_.is_exact) result_.count = std::max(result_.count, least);
    return std::move(result_);
  }

 private:
  /// Removes points seen by one camera, and cameras with few points. The two equations of such a point determine two of
  /// its unknowns and nothing else; the same holds for the equations of such a camera. After removal, others may have
  /// few observations in turn.
  void takeAwayWhatIsSeenOnce() {
    for (std::size_t p = 0; p < scene_.points.size(); ++p) waiting_points_.push_back(int(p));
    for (std::size_t c = 0; c < scene_.cameras.size(); ++c) waiting_cameras_.push_back(int(c));
    std::vector<char> is_camera_done(scene_.cameras.size()), is_point_done(scene_.points.size());
    while (!waiting_points_.empty() || !waiting_cameras_.empty()) {
      if (!waiting_points_.empty()) {
        const int p = waiting_points_.back();
        waiting_points_.pop_back();
        if (sightings_.camerasOf(p).size() > 1 || is_point_done[std::size_t(p)] != 0) continue;
        is_point_done[std::size_t(p)] = 1;
        takeAwayPoint(p);
      } else {
        const int c = waiting_cameras_.back();
        waiting_cameras_.pop_back();
        if (is_camera_done[std::size_t(c)] != 0 || !canTakeAwayCamera(c)) continue;
        is_camera_done[std::size_t(c)] = 1;
        takeAwayCamera(c);
      }
    }
  }
  void takeAwayPoint(int p) {
    const std::vector<int> cameras = sightings_.camerasOf(p);
    result_.count += point_unknowns - 2 * int(cameras.size());
    for (const int c : cameras) sightings_.remove(c, p);
    waiting_cameras_.insert(waiting_cameras_.end(), cameras.begin(), cameras.end());
  }
  void takeAwayCamera(int c) {
    const std::vector<int> points = sightings_.pointsOf(c);
    result_.count += camera_unknowns - 2 * int(points.size());
    for (const int p : points) sightings_.remove(c, p);
    waiting_points_.insert(waiting_points_.end(), points.begin(), points.end());
  }
  /// Returns whether the images of the camera are independent equations for its 9 unknowns.
  bool canTakeAwayCamera(int c) const {
    const std::vector<int>& points = sightings_.pointsOf(c);
    if (points.size() > few_points) return false;
    if (points.size() < 2) return true;
    Estimator est;
    const auto camera = est.insertRV(scene_.cameras[std::size_t(c)]);
    for (const int p : points) {
      est.insertMeasurement(io::CameraProjection(), camera,
                            est.insertRV(scene_.points[std::size_t(p)], false), measured(mtk::vect<2>(0, 0)));
    }
    return slom::diagnose(est).rank == 2 * int(points.size());
  }

  void diagnose(const Part& part) {
    const bool is_affordable = part.cameras.size() <= (may_take_long_ ? most_cameras : few_cameras);
    int fixed = 0;
    Diagnosis found;
    if (is_affordable) found = diagnosisOf(part, fixed);
    const int count = found.unknowns - found.rank + fixed;
    if (!is_affordable || found.unknowns - found.rank > most_found) result_.is_exact = false;
    result_.count += std::max(count, similarity);
    if (count <= similarity) return;
    result_.further += count - similarity;
    for (const Finding& finding : found.findings) {
      if (finding.is_fault && finding.kind != Finding::Kind::gauge && !finding.names.empty())
        result_.names.push_back(finding.names.front());
    }
  }

  /// Diagnoses a part. `fixed` receives the number of points that can move along parallel rays. One coordinate of each
  /// is fixed, which leaves the rank unchanged.
  Diagnosis diagnosisOf(const Part& part, int& fixed) {
    Estimator est;
    est.setThreads(threads_);
    std::vector<VarID<Camera>> cameras(scene_.cameras.size());
    for (const int c : part.cameras)
      cameras[std::size_t(c)] = est.insertRV(scene_.cameras[std::size_t(c)], "camera " + std::to_string(c));
    for (const int p : part.points) {
      const auto point = est.insertRV(scene_.points[std::size_t(p)], "point " + std::to_string(p));
      const mtk::vect<3> direction = freeDirectionOf(scene_, p, sightings_.camerasOf(p));
      if (!direction.isZero(0)) {
        int most = 0;
        direction.cwiseAbs().maxCoeff(&most);
        est.fix(point, std::string(1, "xyz"[most]));
        result_.names.push_back(est.nameOf(point));
        ++fixed;
      }
      for (const int c : sightings_.camerasOf(p))
        est.insertMeasurement(io::CameraProjection(), cameras[std::size_t(c)], point,
                              measured(mtk::vect<2>(0, 0)));
    }
    return slom::diagnose(est);
  }

  const Scene& scene_;
  Sightings sightings_;
  int threads_;
  bool may_take_long_;
  FreeDirections result_;
  std::vector<int> waiting_points_, waiting_cameras_;
};

}  // namespace

FreeDirections countFreeDirections(const Scene& scene, int threads, bool may_take_long) {
  return Count(scene, threads, may_take_long).run();
}

}  // namespace slom::app::bundle
