/// PoseGraph: the content of a pose graph file (slom/io/g2o.hpp). It has poses and landmarks, in the plane or in space,
/// and relative measurements.
///
/// A pose is world_T_body. The datum of an edge from a to b is a^-1 b, that of a sighting of landmark l is a^-1 l.
/// Priors measure poses in the frame of the world. The functions of slom/initialize.hpp find start values for these
/// graphs. slom/io/pose_graph_model.hpp inserts them into an estimator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "mtk/types/so2.hpp"
#include "mtk/types/so3.hpp"
#include "mtk/types/trafo.hpp"
#include "mtk/types/vect.hpp"

namespace slom::io {

using Pose2 = mtk::trafo<mtk::SO2<>>;  ///< world_T_pose in the plane
using Pose3 = mtk::trafo<mtk::SO3<>>;  ///< world_T_pose in space

template <class Pose>
inline constexpr int dof = Pose::DOF;  ///< 3 or 6: translation, then rotation
template <class Pose>
inline constexpr int dim = Pose::DIM;  ///< 2 or 3
template <class Pose>
using Point = mtk::vect<Pose::DIM>;

template <int N>
using Symmetric = Eigen::Matrix<double, N, N, Eigen::DontAlign>;

/// A pose or a landmark.
template <class Value>
struct Node {
  std::uint64_t id = 0;  ///< name in the file
  Value value;           ///< start value [m, rad]
  /// Line of the vertex. If the file has no vertices, line of the first edge that names the node.
  int line = 0;
  bool fixed = false;  ///< keeps its value in the fit
};

/// A measurement of `to` as seen from the pose `from`. Both are indices of nodes, not ids.
template <class Datum>
struct Edge {
  int from = 0;
  int to = 0;
  int line = 0;                       ///< line of the file
  Datum measured;                     ///< [m, rad]
  Symmetric<Datum::DOF> information;  ///< as in the file: translation first, then rotation
};

/// A sensor in g2o files: its place on the robot.
template <class Pose>
struct Sensor {
  std::uint64_t id = 0;  ///< name in the file
  Pose offset;           ///< robot_T_sensor
  int line = 0;
};

/// A measurement of the pose of a robot, or of a sensor on it, in the world.
template <class Pose>
struct PosePrior {
  static constexpr int robot = -1;

  int pose = 0;   ///< an index, not an id
  int line = 0;   ///< line of the file
  Pose measured;  ///< world_T_sensor [m, rad]
  /// As in the file: translation first, then rotation, in the frame of `measured`.
  Symmetric<dof<Pose>> information;
  int sensor = robot;  ///< index in PoseGraph::sensors; robot: the pose itself
};

/// A measurement of the position of a pose in the world.
template <class Pose>
struct PositionPrior {
  int pose = 0;  ///< an index, not an id
  int line = 0;  ///< line of the file
  Point<Pose> measured;
  Symmetric<dim<Pose>> information;
};

/// The skipped lines of a file, by their first words.
struct UnknownTags {
  static constexpr std::size_t most = 5;

  std::map<std::string, int> lines;  ///< number of lines for each of the first unknown tags
  int others = 0;                    ///< number of lines with further tags

  /// Counts a line that begins with this word.
  void add(std::string_view tag);
  /// Returns a sentence for each word: `skipped 2 lines with the unknown tag VERTEX_CAM`.
  std::vector<std::string> sentences() const;
};

/// The content of a pose graph file, in the plane (Pose2) or in space (Pose3).
template <class PoseType>
struct PoseGraph {
  using Pose = PoseType;

  std::string file;
  bool has_vertices = false;  ///< if false, the values of nodes are meaningless
  bool has_fix_lines = false;
  std::vector<Node<Pose>> poses;  ///< in the order of the file; by id if the file has no vertices
  std::vector<Node<Point<Pose>>> landmarks;
  std::vector<Edge<Pose>> edges;  ///< from a pose to a pose
  /// Observations of a landmark from a pose, in the frame of the pose.
  std::vector<Edge<Point<Pose>>> sightings;
  std::vector<Edge<mtk::SO2<>>> bearings;  ///< in the plane: directions of a landmark from a pose
  std::vector<PosePrior<Pose>> pose_priors;
  std::vector<PositionPrior<Pose>> position_priors;  ///< in the plane
  std::vector<Sensor<Pose>> sensors;
  /// Sightings by a sensor that is not at the origin of the robot, by their index. They have the sensor's index as
  /// `from`, and the numbers of the file. `sightings` has the same observations in the frame of the robot.
  std::map<std::size_t, Edge<Point<Pose>>> as_sensed;
  UnknownTags unknown_tags;
  /// Ids of sensors that lines name but PARAMS_SE3OFFSET does not define. They are taken to be at the origin.
  std::set<std::uint64_t> missing_sensors;

  /// Returns robot_T_sensor of the prior's sensor.
  Pose offsetOf(const PosePrior<Pose>& prior) const {
    return prior.sensor < 0 ? Pose() : sensors[static_cast<std::size_t>(prior.sensor)].offset;
  }
};

using AnyPoseGraph = std::variant<PoseGraph<Pose2>, PoseGraph<Pose3>>;

}  // namespace slom::io
