// Contents of the lines of a file, before ids become nodes.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "io/g2o/lines.hpp"
#include "slom/io/pose_graph.hpp"

namespace slom::io::g2o {

/// Ids of the vertices of an edge.
struct Ends {
  std::uint64_t from = 0;
  std::uint64_t to = 0;
};

/// A vertex named by a FIX line.
struct FixedVertex {
  std::uint64_t id = 0;
  int line = 0;
};

/// The vertex of a prior, and the sensor named in its line.
struct PriorOf {
  std::uint64_t pose = 0;
  std::uint64_t sensor = 0;
};

template <class Pose>
struct RawGraph {
  PoseGraph<Pose> graph;                        ///< its edges have no node indices yet
  std::vector<Ends> edge_ends;                  ///< ends of graph.edges
  std::vector<Ends> sighting_ends;              ///< ends of graph.sightings
  std::vector<std::uint64_t> sighting_sensors;  ///< of graph.sightings in space
  std::vector<Ends> bearing_ends;               ///< ends of graph.bearings
  std::vector<PriorOf> pose_priors_of, position_priors_of;
  std::vector<FixedVertex> fixed;

  template <class Value, class Read>
  static void readVertex(std::vector<Node<Value>>& nodes, Lines& line, Read read) {
    Node<Value> node;
    node.line = line.lineNumber();
    node.id = line.id();
    node.value = read(line);
    line.finish();
    nodes.push_back(std::move(node));
  }

  /// Reads an edge. `skip` reads what stands between the ids and the measurement.
  template <class Datum, class Read, class ReadInformation, class Skip>
  static void readEdge(std::vector<Edge<Datum>>& edges, std::vector<Ends>& ends, Lines& line, Read read,
                       ReadInformation read_information, Skip skip) {
    Edge<Datum>& edge = edges.emplace_back();
    Ends& end = ends.emplace_back();
    edge.line = line.lineNumber();
    end.from = line.id();
    end.to = line.id();
    skip(line);
    if (end.from == end.to) {
      line.fail("the edge leads from vertex " + std::to_string(end.from) + " to itself; remove it");
    }
    edge.measured = read(line);
    edge.information = read_information(line);
    line.finish();
  }
};

/// Finds the node of each id. Throws [slom.io.bad-graph] if an id has no node of the right kind.
template <class Pose>
PoseGraph<Pose> resolve(RawGraph<Pose> raw);

}  // namespace slom::io::g2o
