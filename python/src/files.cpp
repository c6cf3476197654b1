#include "files.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <slom/initialize.hpp>
#include <slom/io.hpp>

namespace slom::python {

namespace nb = nanobind;
using initialize::Start;

namespace {

/// Entries of a C-contiguous array, appended row by row.
template <class T>
class Array {
 public:
  void push(T x) { entries_->push_back(x); }
  template <class R>
  void push(const mtk::trafo<R>& pose) {
    push(pose.pos);
    push(pose.orient);
  }
  void push(const mtk::SO2<>& R) { push(R.angle()); }
  void push(const mtk::SO3<>& R) {
    for (const double x : R.coeffs()) push(x);
  }
  template <int N>
  void push(const mtk::vect<N>& v) {
    for (const double x : v) push(x);
  }
  template <int N>
  void push(const io::Symmetric<N>& m) {
    for (int i = 0; i < N; ++i) {
      for (int k = 0; k < N; ++k) push(m(i, k));
    }
  }
  /// Returns the array; the size of the first dimension follows from the others.
  nb::object numpy(std::vector<std::size_t> others = {}) const {
    std::size_t size = 1;
    for (const std::size_t n : others) size *= n;
    others.insert(others.begin(), entries_->size() / size);
    auto* const owned = new std::shared_ptr<std::vector<T>>(entries_);
    const nb::capsule owner(
        owned, [](void* p) noexcept { delete static_cast<std::shared_ptr<std::vector<T>>*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, T>(entries_->data(), others.size(), others.data(), owner));
  }

 private:
  std::shared_ptr<std::vector<T>> entries_ = std::make_shared<std::vector<T>>();
};
using Numbers = Array<double>;
using Indices = Array<std::int64_t>;

/// How many numbers store a value, as in slom.Rows.
template <class T>
inline constexpr std::size_t coordinates = mtk::DOF_v<T>;
template <>
inline constexpr std::size_t coordinates<io::Pose3> = 7;

template <class Value>
nb::dict nodes(const std::vector<io::Node<Value>>& all) {
  Numbers values;
  Array<std::uint64_t> ids;
  Array<std::uint8_t> fixed;
  for (const io::Node<Value>& node : all) {
    values.push(node.value);
    ids.push(node.id);
    fixed.push(node.fixed);
  }
  nb::dict d;
  d["values"] = values.numpy({coordinates<Value>});
  d["ids"] = ids.numpy();
  d["fixed"] = fixed.numpy();
  return d;
}

/// Measurements between nodes i and j. The information in i is that of the error i^-1 j [-] measured, whose translation
/// is in the frame of node i.
template <class Datum>
nb::dict edges(const std::vector<io::Edge<Datum>>& all) {
  constexpr std::size_t m = mtk::DOF_v<Datum>;
  Indices i, j;
  Numbers measured, information, in_i;
  for (const io::Edge<Datum>& edge : all) {
    i.push(edge.from);
    j.push(edge.to);
    measured.push(edge.measured);
    information.push(edge.information);
    if constexpr (mtk::detail::is_trafo<Datum>) in_i.push(io::detail::informationFromA(edge));
  }
  nb::dict d;
  d["i"] = i.numpy();
  d["j"] = j.numpy();
  d["measured"] = measured.numpy({coordinates<Datum>});
  d["information"] = information.numpy({m, m});
  if constexpr (mtk::detail::is_trafo<Datum>) d["information_in_i"] = in_i.numpy({m, m});
  return d;
}

template <class Pose>
nb::dict posePriors(const io::PoseGraph<Pose>& graph) {
  constexpr std::size_t m = io::dof<Pose>;
  Indices i;
  Numbers offsets, measured, information, in_world;
  for (const io::PosePrior<Pose>& prior : graph.pose_priors) {
    i.push(prior.pose);
    offsets.push(graph.offsetOf(prior));
    measured.push(prior.measured);
    information.push(prior.information);
    const io::Edge<Pose> from_origin{0, prior.pose, prior.line, prior.measured, prior.information};
    in_world.push(io::detail::informationFromA(from_origin));
  }
  nb::dict d;
  d["i"] = i.numpy();
  d["offsets"] = offsets.numpy({coordinates<Pose>});
  d["measured"] = measured.numpy({coordinates<Pose>});
  d["information"] = information.numpy({m, m});
  d["information_in_world"] = in_world.numpy({m, m});
  return d;
}

template <class Pose>
nb::dict positionPriors(const io::PoseGraph<Pose>& graph) {
  constexpr std::size_t n = io::dim<Pose>;
  Indices i;
  Numbers measured, information;
  for (const io::PositionPrior<Pose>& prior : graph.position_priors) {
    i.push(prior.pose);
    measured.push(prior.measured);
    information.push(prior.information);
  }
  nb::dict d;
  d["i"] = i.numpy();
  d["measured"] = measured.numpy({n});
  d["information"] = information.numpy({n, n});
  return d;
}

constexpr std::array<std::pair<const char*, Start>, 5> starts{{{"file", Start::given},
                                                               {"odometry", Start::odometry},
                                                               {"spanning-tree", Start::spanning_tree},
                                                               {"chordal", Start::chordal},
                                                               {"build-up", Start::build_up}}};

/// Gives the graph the start values of this name; "auto": those with the lowest RSS.
template <class Pose>
void findStart(io::PoseGraph<Pose>& graph, const std::string& init) {
  const io::PoseGraphModel model;
  if (init == "file" && !graph.has_vertices) {
    throw mtk::Error("slom.bad-option",
                     "init is \"file\", but " + graph.file + " has no vertices; drop the argument", "init");
  }
  std::vector<Start> candidates;
  for (const auto& [name, start] : starts) {
    if (init == name) return initialize::findStart(graph, start, model);
    const bool is_possible = start == Start::given      ? graph.has_vertices
                             : start == Start::build_up ? !graph.sightings.empty()
                                                        : true;
    if (is_possible) candidates.push_back(start);
  }
  if (init != "auto") {
    throw mtk::Error(
        "slom.bad-option",
        "init is \"" + init +
            "\"; pass \"auto\", \"file\", \"odometry\", \"spanning-tree\", \"chordal\" or \"build-up\"",
        "init");
  }
  initialize::chooseStart(
      graph, candidates, [&](io::PoseGraph<Pose>& g, Start start) { initialize::findStart(g, start, model); },
      model);
}

template <class Pose>
nb::dict toPython(const io::PoseGraph<Pose>& graph) {
  nb::dict d;
  d["dim"] = io::dim<Pose>;
  d["poses"] = nodes(graph.poses);
  d["landmarks"] = nodes(graph.landmarks);
  d["edges"] = edges(graph.edges);
  d["sightings"] = edges(graph.sightings);
  d["bearings"] = edges(graph.bearings);
  d["pose_priors"] = posePriors(graph);
  d["position_priors"] = positionPriors(graph);
  std::vector<std::string> warnings = graph.unknown_tags.sentences();
  for (const std::uint64_t sensor : graph.missing_sensors) {
    warnings.push_back("sensor " + std::to_string(sensor) +
                       " has no line PARAMS_SE3OFFSET; it is taken to be at the origin of the robot");
  }
  d["warnings"] = warnings;
  return d;
}

nb::dict readG2o(const std::string& file, const std::optional<std::string>& init) {
  io::AnyPoseGraph any;
  {
    const nb::gil_scoped_release unlocked;
    any = io::readPoseGraph(file);
    std::visit(
        [&](auto& graph) {
          const bool has_priors = !graph.pose_priors.empty() || !graph.position_priors.empty();
          if (!graph.has_fix_lines && !has_priors) graph.poses[0].fixed = true;
          if (init || !graph.has_vertices) findStart(graph, init.value_or("auto"));
        },
        any);
  }
  return std::visit([](const auto& graph) { return toPython(graph); }, any);
}

nb::dict readBal(const std::string& file) {
  io::Scene scene;
  {
    const nb::gil_scoped_release unlocked;
    scene = io::readScene(file);
  }
  Numbers cameras, points, pixels;
  Indices i, j;
  for (const io::Camera& camera : scene.cameras) {
    cameras.push(camera.pose);
    cameras.push<3>(camera.lens);
  }
  for (const mtk::vect<3>& point : scene.points) points.push(point);
  for (const io::Observation& observation : scene.observations) {
    i.push(observation.camera);
    j.push(observation.point);
    pixels.push(observation.pixel);
  }
  nb::dict d;
  d["cameras"] = cameras.numpy({10});
  d["points"] = points.numpy({3});
  d["i"] = i.numpy();
  d["j"] = j.numpy();
  d["pixels"] = pixels.numpy({2});
  return d;
}

}  // namespace

void bindFiles(nb::module_& module) {
  module.def("_read_g2o", &readG2o);
  module.def("_read_bal", &readBal);
}

}  // namespace slom::python
