/// Choice of the best of several starts.
#pragma once

#include <cmath>
#include <exception>
#include <limits>
#include <utility>
#include <vector>

#include "slom/initialize/build_up.hpp"
#include "slom/initialize/start.hpp"

namespace slom::initialize {

/// Gives the graph the values of the start with the lowest RSS; of equal ones, the first. `find(graph, start)` computes
/// the values of a start. If no start can be found, throws what the last one threw.
template <class Graph, class Find, class Model>
Choice chooseStart(Graph& graph, const std::vector<Start>& candidates, const Find& find, const Model& model) {
  (void)detail::edgesOf(graph);  // checks them
  detail::WholeMap<Graph, Model> map(graph, model);
  Choice choice;
  const auto given_poses = graph.poses;
  const auto given_landmarks = graph.landmarks;
  auto poses = given_poses;
  auto landmarks = given_landmarks;
  double lowest = std::numeric_limits<double>::infinity();
  bool is_found = false;
  std::exception_ptr failure;
  for (const Start start : candidates) {
    graph.poses = given_poses;
    graph.landmarks = given_landmarks;
    double here = std::numeric_limits<double>::infinity();
    try {
      find(graph, start);
      here = map.rss();
      if (std::isnan(here)) here = std::numeric_limits<double>::infinity();
      if (!is_found || here < lowest) {
        choice.start = start;
        lowest = here;
        poses = graph.poses;
        landmarks = graph.landmarks;
      }
      is_found = true;
    } catch (const mtk::Error&) {
      failure = std::current_exception();
    }
    choice.costs.emplace_back(start, here);
  }
  graph.poses = std::move(poses);
  graph.landmarks = std::move(landmarks);
  if (!is_found && failure) std::rethrow_exception(failure);
  return choice;
}

/// Gives the graph the values of one start.
template <class Graph, class Model = RelationModel>
void findStart(Graph& graph, Start start, const Model& model = {}) {
  switch (start) {
    case Start::given:
      return;
    case Start::odometry:
      return alongOdometry(graph);
    case Start::spanning_tree:
      return alongSpanningTree(graph);
    case Start::chordal:
      return chordal(graph);
    case Start::build_up:
      return buildUp(graph, {}, model);
  }
}

/// Tries odometry, spanning tree and chordal relaxation. If there are landmarks, which may close loops that edges do
/// not close, also tries the build-up. Keeps the start with the lowest RSS. Throws Unreached.
template <class Graph, class Model = RelationModel>
Choice findBestStart(Graph& graph, const Model& model = {}) {
  std::vector<Start> candidates{Start::odometry, Start::spanning_tree, Start::chordal};
  if (!graph.sightings.empty()) candidates.push_back(Start::build_up);
  return chooseStart(
      graph, candidates, [&](Graph& g, Start start) { findStart(g, start, model); }, model);
}

}  // namespace slom::initialize
