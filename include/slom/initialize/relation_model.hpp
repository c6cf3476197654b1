/// RelationModel: conversion of a graph to measurements of an estimator.
#pragma once

#include "slom/estimator.hpp"
#include "slom/measurements/landmark.hpp"
#include "slom/measurements/relative_pose.hpp"

namespace slom::initialize {

/// Inserts edges as slom::RelativePose and sightings as slom::Landmark. For pose types without `orient` and `pos`, the
/// residuals are a^-1 b [-] z and a^-1 l - z. The functions of slom/initialize.hpp accept any class with these members.
struct RelationModel {
  Loss loss;

  /// Called once before the first insertion, for variables that the model's measurements share.
  void prepare(Estimator&) const {}
  /// Inserts the measurement of an edge between two poses.
  template <class Pose>
  void insertEdge(Estimator& est, const VarID<Pose>& a, const VarID<Pose>& b, const auto& edge) const {
    if constexpr (requires { edge.measured.orient, edge.measured.pos; }) {
      est.insertMeasurement(RelativePose(), a, b, measured(edge.measured), InvCovariance(edge.information),
                            loss, named("edge"));
    } else {
      est.insertMeasurement(RelativePoseInFrameOfA(), a, b, measured(edge.measured),
                            InvCovariance(edge.information), loss, named("edge"));
    }
  }
  /// Inserts the measurement of a landmark from a pose.
  template <class Pose, class Point>
  void insertSighting(Estimator& est, const VarID<Pose>& a, const VarID<Point>& l,
                      const auto& sighting) const {
    if constexpr (requires { a->orient, a->pos; }) {
      est.insertMeasurement(Landmark(), a, l, measured(sighting.measured),
                            InvCovariance(sighting.information), loss, named("sighting"));
    } else {
      est.insertMeasurement(
          [](const Pose& pose, const Point& point) { return Point(pose.inverse() * point); }, a, l,
          measured(sighting.measured), InvCovariance(sighting.information), loss, named("sighting"));
    }
  }
};

}  // namespace slom::initialize
