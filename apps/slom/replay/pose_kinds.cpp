#include <slom/measurements/landmark.hpp>
#include <slom/measurements/relative_pose.hpp>

#include "replay/kinds.hpp"

namespace slom::app::replay {

void addPoseKinds(Archive& archive) {
  using mtk::SO2;
  using mtk::SO3;
  using mtk::vect;
  archive.measurement<RelativePose, VarID<Pose2>, VarID<Pose2>, Measured<Pose2>>();
  archive.measurement<RelativePoseInFrameOfA, VarID<Pose2>, VarID<Pose2>, Measured<Pose2>>();
  archive.measurement<RelativePose, VarID<Pose3>, VarID<Pose3>, Measured<Pose3>>();
  archive.measurement<RelativePoseInFrameOfA, VarID<Pose3>, VarID<Pose3>, Measured<Pose3>>();
  archive.measurement<RelativeRotation, VarID<SO2<>>, VarID<SO2<>>, Measured<SO2<>>>();
  archive.measurement<RelativeRotation, VarID<SO3<>>, VarID<SO3<>>, Measured<SO3<>>>();
  archive.measurement<Landmark, VarID<Pose2>, VarID<vect<2>>, Measured<vect<2>>>();
  archive.measurement<Landmark, VarID<Pose3>, VarID<vect<3>>, Measured<vect<3>>>();
}

}  // namespace slom::app::replay
