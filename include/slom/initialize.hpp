/// Start values of maps: poses and landmarks from relative measurements.
///
///     slom::initialize::PoseGraph<Pose, mtk::vect<2>> graph;
///     ...                                                     // addPose, addEdge, addLandmark, addSighting
///     slom::initialize::findBestStart(graph);
///     for (std::size_t i = 0; i < ids.size(); ++i) est.reinitRV(ids[i], graph.poses[i].value);
#pragma once

#include "slom/initialize/build_up.hpp"
#include "slom/initialize/choose.hpp"
#include "slom/initialize/chordal.hpp"
#include "slom/initialize/growing_map.hpp"
#include "slom/initialize/pose_graph.hpp"
#include "slom/initialize/relation_model.hpp"
#include "slom/initialize/spanning_tree.hpp"
#include "slom/initialize/start.hpp"
