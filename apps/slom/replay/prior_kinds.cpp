#include <slom/measurements/gaussian_prior.hpp>
#include <slom/measurements/gravity.hpp>
#include <slom/measurements/intrinsics.hpp>
#include <slom/measurements/prior.hpp>

#include "replay/kinds.hpp"

namespace slom::app::replay {

namespace {

template <class... T>
void addPriors(Archive& archive) {
  (archive.measurement<Prior, VarID<T>, Measured<T>>(), ...);
}

}  // namespace

void addPriorKinds(Archive& archive) {
  using mtk::S2;
  using mtk::SO2;
  using mtk::SO3;
  using mtk::vect;
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
