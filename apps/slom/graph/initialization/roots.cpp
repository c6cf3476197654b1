#include "graph/initialization/roots.hpp"

#include <optional>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace slom::app::graph {

namespace {

/// The motion T of the world that minimises sum w |T a - b|^2 over pairs of places. If the pairs leave rotations free,
/// it is the smallest such motion.
///   source   Kabsch, "A solution for the best rotation to relate two sets of vectors", Acta Cryst. A, 1976
template <class Pose>
class Registration {
 public:
  using Place = Eigen::Matrix<double, dim<Pose>, 1>;
  using Matrix = Eigen::Matrix<double, dim<Pose>, dim<Pose>>;

  void add(double w, const Place& a, const Place& b) { pairs_.push_back({w, a, b}); }
  bool isEmpty() const { return pairs_.empty(); }
  Pose motion() const {
    double weight = 0, size = 0;
    Place a = Place::Zero(), b = Place::Zero();
    for (const Pair& pair : pairs_) {
      weight += pair.w;
      a += pair.w * pair.a;
      b += pair.w * pair.b;
    }
    a /= weight;
    b /= weight;
    Matrix H = Matrix::Zero();
    for (const Pair& pair : pairs_) {
      H += pair.w * (pair.b - b) * (pair.a - a).transpose();
      size += pair.w * (pair.b - b).norm() * (pair.a - a).norm();
    }
    constexpr double little = 1e-9;  // prefers no rotation if rotations are free
    H += (little * size + 1e-300) * Matrix::Identity();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Place signs = Place::Ones();
    signs[dim<Pose> - 1] = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    const Matrix R = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    return {typename Pose::Rotation(R), mtk::vect<dim<Pose>>(b - R * a)};
  }

 private:
  struct Pair {
    double w;
    Place a, b;
  };
  std::vector<Pair> pairs_;
};

/// Numbers of edges, sightings and priors at each pose.
template <class Pose>
struct AtPoses {
  explicit AtPoses(const PoseGraph<Pose>& graph)
      : edges(graph.poses.size()),
        sightings(graph.poses.size()),
        pose_priors(graph.poses.size()),
        position_priors(graph.poses.size()) {
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      edges[std::size_t(graph.edges[e].from)].push_back(e);
      edges[std::size_t(graph.edges[e].to)].push_back(e);
    }
    for (std::size_t s = 0; s < graph.sightings.size(); ++s)
      sightings[std::size_t(graph.sightings[s].from)].push_back(s);
    for (std::size_t i = 0; i < graph.pose_priors.size(); ++i)
      pose_priors[std::size_t(graph.pose_priors[i].pose)].push_back(i);
    for (std::size_t i = 0; i < graph.position_priors.size(); ++i)
      position_priors[std::size_t(graph.position_priors[i].pose)].push_back(i);
  }
  std::vector<std::vector<std::size_t>> edges, sightings, pose_priors, position_priors;
};

/// Poses connected by edges, composed from the first one on, and the motion of the world that moves them to known
/// places.
template <class Pose>
class Group {
 public:
  Group(const PoseGraph<Pose>& graph, const AtPoses<Pose>& at, std::vector<Pose>& value,
        std::vector<char>& is_reached, std::size_t first)
      : graph_(graph), at_(at), value_(value) {
    value_[first] = graph.poses[first].value;
    is_reached[first] = 1;
    poses_.push_back(first);
    for (std::size_t k = 0; k < poses_.size(); ++k) {
      const std::size_t p = poses_[k];
      has_fixed_ = has_fixed_ || graph_.poses[p].fixed;
      for (const std::size_t e : at_.edges[p]) follow(graph_.edges[e], p, is_reached);
      addPlaces(p);
    }
  }
  bool hasFixed() const { return has_fixed_; }
  bool isKnown() const { return prior_ || !registration_.isEmpty(); }
  Pose motion() const { return prior_ ? *prior_ : registration_.motion(); }

 private:
  void follow(const Edge<Pose>& edge, std::size_t p, std::vector<char>& is_reached) {
    const bool is_forward = std::size_t(edge.from) == p;
    const auto q = std::size_t(is_forward ? edge.to : edge.from);
    if (is_reached[q] != 0) return;
    is_reached[q] = 1;
    value_[q] = value_[p] * (is_forward ? edge.measured : edge.measured.inverse());
    poses_.push_back(q);
  }
  void addPlaces(std::size_t p) {
    for (const std::size_t i : at_.pose_priors[p]) {
      const auto& prior = graph_.pose_priors[i];
      if (!prior_) prior_ = prior.measured * graph_.offsetOf(prior).inverse() * value_[p].inverse();
    }
    for (const std::size_t i : at_.position_priors[p]) {
      const auto& prior = graph_.position_priors[i];
      registration_.add(prior.information.diagonal().cwiseAbs().mean(), value_[p].pos, prior.measured);
    }
    for (const std::size_t s : at_.sightings[p]) {
      const auto& sighting = graph_.sightings[s];
      const auto& landmark = graph_.landmarks[std::size_t(sighting.to)];
      if (!landmark.fixed) continue;
      registration_.add(sighting.information.diagonal().cwiseAbs().mean(), value_[p] * sighting.measured,
                        landmark.value);
    }
  }

  const PoseGraph<Pose>& graph_;
  const AtPoses<Pose>& at_;
  std::vector<Pose>& value_;
  std::vector<std::size_t> poses_;
  bool has_fixed_ = false;
  Registration<Pose> registration_;
  std::optional<Pose> prior_;  // motion given by a prior of a whole pose
};

}  // namespace

template <class Pose>
Roots<Pose>::Roots(PoseGraph<Pose>& graph) : graph_(graph) {
  const AtPoses<Pose> at(graph);
  std::vector<Pose> value(graph.poses.size());
  std::vector<char> is_reached(graph.poses.size());
  for (std::size_t first = 0; first < graph.poses.size(); ++first) {
    if (is_reached[first] != 0) continue;
    const Group<Pose> group(graph, at, value, is_reached, first);
    if (group.hasFixed() || !group.isKnown()) continue;
    before_.emplace_back(first, graph.poses[first].value);
    graph.poses[first].value = group.motion() * value[first];
    graph.poses[first].fixed = true;
  }
}

template <class Pose>
Roots<Pose>::~Roots() {
  for (const auto& [pose, value] : before_) graph_.poses[pose].fixed = false;
}

template <class Pose>
void Roots<Pose>::restore(PoseGraph<Pose>& graph) const {
  for (const auto& [pose, value] : before_) graph.poses[pose].value = value;
}

template class Roots<Pose2>;
template class Roots<Pose3>;

}  // namespace slom::app::graph
