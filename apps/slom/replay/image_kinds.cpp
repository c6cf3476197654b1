#include <slom/measurements/projection.hpp>

#include "replay/kinds.hpp"

namespace slom::app::replay {

namespace {

using Point = mtk::vect<3>;
using Pixel = Measured<mtk::vect<2>>;

/// Adds images through one kind of lens, of points with unknown positions and of points with known positions.
template <class Lens, class Camera>
void addLens(Archive& archive) {
  archive.measurement<Projection, VarID<Lens>, Point, Pixel>();
  archive.measurement<Reprojection, VarID<Pose3>, VarID<Lens>, VarID<Point>, Pixel>();
  archive.measurement<Reprojection, VarID<Pose3>, VarID<Lens>, Point, Pixel>();
  archive.measurement<Reprojection, VarID<Camera>, VarID<Point>, Pixel>();
}

}  // namespace

void addImageKinds(Archive& archive) {
  addLens<PinholeIntrinsics<>, PinholeCamera>(archive);
  addLens<OpenCv5Intrinsics<>, OpenCv5Camera>(archive);
  addLens<FisheyeIntrinsics<>, FisheyeCamera>(archive);
  archive.measurement<Reprojection, VarID<SnavelyCamera>, VarID<Point>, Pixel>();
}

}  // namespace slom::app::replay
