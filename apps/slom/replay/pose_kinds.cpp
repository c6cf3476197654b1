#include <slom/measurements/gaussian_prior.hpp>
#include <slom/measurements/gravity.hpp>
#include <slom/measurements/intrinsics.hpp>
#include <slom/measurements/landmark.hpp>
#include <slom/measurements/prior.hpp>
#include <slom/measurements/relative_pose.hpp>

#include "replay/kinds.hpp"

namespace slom::app::replay {

namespace {

template <class... T>
void addPriors(Archive& archive) {
  (archive.measurement<Prior, VarID<T>, Measured<T>>(), ...);
}

}  // namespace

void addPoseKinds(Archive& archive) {
  using mtk::S2;
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
  archive.measurement<GravityDirection, VarID<SO3<>>, S2<>, Measured<S2<>>>();
  archive.measurement<GravityDirection, VarID<Pose3>, S2<>, Measured<S2<>>>();
  archive.measurement<Accelerometer, VarID<Pose3>, S2<>, VarID<double>, VarID<vect<3>>, Measured<vect<3>>>();
  archive.measurement<Accelerometer, VarID<Pose3>, VarID<SO3<>>, S2<>, VarID<double>, VarID<vect<3>>,
                      Measured<vect<3>>>();
  addPriors<double, vect<1>, vect<2>, vect<3>, mtk::Scalar<>, SO2<>, SO3<>, S2<>, Pose2, Pose3,
            PinholeIntrinsics<>, OpenCv5Intrinsics<>, FisheyeIntrinsics<>>(archive);
  archive.measurement<GaussianPrior>();
}

}  // namespace slom::app::replay
