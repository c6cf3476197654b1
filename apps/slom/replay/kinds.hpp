// The measurements that `slom replay` knows: those of slom/measurements, for the types that are used most with them.
#pragma once

#include <slom/archive.hpp>

namespace slom::app::replay {

using Pose2 = mtk::trafo<mtk::SO2<>>;
using Pose3 = mtk::trafo<mtk::SO3<>>;

/// Adds relative poses and rotations, and landmarks.
void addPoseKinds(Archive& archive);
/// Adds priors and gravity.
void addPriorKinds(Archive& archive);
/// Adds ranges, bearings, and angles of theodolites.
void addObservationKinds(Archive& archive);
/// Adds points in images.
void addImageKinds(Archive& archive);

}  // namespace slom::app::replay
