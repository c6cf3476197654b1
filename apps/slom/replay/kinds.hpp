// The measurements that `slom replay` knows: those of slom/measurements, of the types that they are used with most.
#pragma once

#include <slom/archive.hpp>

namespace slom::app::replay {

using Pose2 = mtk::trafo<mtk::SO2<>>;
using Pose3 = mtk::trafo<mtk::SO3<>>;

/// Relative poses and rotations, landmarks.
void addPoseKinds(Archive& archive);
/// Priors, gravity.
void addPriorKinds(Archive& archive);
/// Ranges, bearings, angles of theodolites.
void addObservationKinds(Archive& archive);
/// Points in images.
void addImageKinds(Archive& archive);

}  // namespace slom::app::replay
