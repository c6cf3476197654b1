#include <slom/measurements/bearing.hpp>
#include <slom/measurements/range.hpp>
#include <slom/measurements/surveying.hpp>

#include "replay/kinds.hpp"

namespace slom::app::replay {

namespace {

using mtk::SO2;

/// Adds measurements between two points, the first of which may be a pose.
template <class Pose, class Point>
void addBetween(Archive& archive) {
  archive.measurement<Range, VarID<Point>, VarID<Point>, Measured<double>>();
  archive.measurement<Range, VarID<Pose>, VarID<Point>, Measured<double>>();
  archive.measurement<Range, VarID<Pose>, VarID<Pose>, Measured<double>>();
  archive.measurement<Range, VarID<Point>, VarID<Point>, VarID<double>, Measured<double>>();
  archive.measurement<Azimuth, VarID<Point>, VarID<Point>, Measured<SO2<>>>();
  archive.measurement<HorizontalDirection, VarID<Point>, VarID<Point>, VarID<SO2<>>, Measured<SO2<>>>();
}

}  // namespace

void addObservationKinds(Archive& archive) {
  using Point2 = mtk::vect<2>;
  using Point3 = mtk::vect<3>;
  addBetween<Pose2, Point2>(archive);
  addBetween<Pose3, Point3>(archive);
  archive.measurement<ZenithAngle, VarID<Point3>, VarID<Point3>, Measured<SO2<>>>();
  archive.measurement<Bearing, VarID<Pose2>, VarID<Point2>, Measured<SO2<>>>();
  archive.measurement<Bearing, VarID<Pose3>, VarID<Point3>, Measured<mtk::S2<>>>();
}

}  // namespace slom::app::replay
