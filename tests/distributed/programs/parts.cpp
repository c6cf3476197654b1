// A user's program on several processes: each inserts its own part of a problem, with global names for what it shares.
//   parts PROBLEM ALGORITHM METHOD               fits, and prints the RSS and all values; alone with standard deviations
//   parts PROBLEM ALGORITHM METHOD covariances   fits, and prints covariances of some variables
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <mtk/mtk.hpp>
#include <slom/distributed.hpp>
#include <slom/measurements.hpp>
#include <slom/optimize/named.hpp>
#include <slom/slom.hpp>

namespace {

using Pose = mtk::trafo<mtk::SO3<>>;
using Point = mtk::vect<3>;
using slom::distributed::PetscMethod;
using slom::distributed::PetscSolver;
using slom::distributed::PetscSolverOptions;
using slom::distributed::Processes;
using slom::distributed::SharedVariables;

std::mt19937_64 random_numbers(7);
int own_rank = 0;

double normal(double sigma) { return sigma * std::normal_distribution<double>()(random_numbers); }
Point noise(double sigma) { return Point(normal(sigma), normal(sigma), normal(sigma)); }
Pose moved(const Pose& pose, double position, double rotation) {
  const Point by = noise(position);
  return pose * Pose(mtk::SO3<>::exp(noise(rotation)), by);
}

/// A variable of the whole problem, and its home.
template <class T>
struct Global {
  T start;
  int home = 0;
};

/// The variables that this process has inserted.
template <class T>
class Inserted {
 public:
  Inserted(slom::Estimator& est, SharedVariables& shared, int rank, std::uint64_t first_name,
           const std::vector<Global<T>>& all)
      : est_(est), shared_(shared), rank_(rank), first_name_(first_name), all_(all) {}

  slom::VarID<T> get(int i, bool optimize = true) {
    const auto found = ids.find(i);
    if (found != ids.end()) return found->second;
    const Global<T>& global = all_[std::size_t(i)];
    const std::string name = (first_name_ == 0 ? "pose " : "point ") + std::to_string(i);
    const slom::VarID<T> id = est_.insertRV(global.start, optimize, name);
    // A point belongs to one process, so it needs no name.
    if (first_name_ == 0) shared_.share(est_, id, std::uint64_t(i), global.home == rank_);
    return ids.emplace(i, id).first->second;
  }
  std::map<int, slom::VarID<T>> ids;

 private:
  slom::Estimator& est_;
  SharedVariables& shared_;
  int rank_;
  std::uint64_t first_name_;
  const std::vector<Global<T>>& all_;
};

struct Distance {
  auto operator()(const auto& pose, const auto& point) const { return (pose.pos - point).norm(); }
};

struct Throws {
  double operator()(const Pose& pose) const {
    if (pose.pos[0] == pose.pos[0]) throw std::runtime_error("the sensor is off");
    return 0;
  }
};

void printComponents(std::string& text, const std::string& name, const double* values, const double* sigmas,
                     int n) {
  char line[200];
  for (int i = 0; i < n; ++i) {
    std::snprintf(line, sizeof line, "%s.%d %.17g %.17g\n", name.c_str(), i, values[i],
                  sigmas == nullptr ? 0.0 : sigmas[i]);
    text += line;
  }
}

/// Returns a line with the numbers of a covariance.
std::string line(const std::string& name, const Eigen::MatrixXd& C) {
  std::string text = name;
  char number[40];
  for (Eigen::Index i = 0; i < C.size(); ++i) {
    std::snprintf(number, sizeof number, " %.17g", C.data()[i]);
    text += number;
  }
  return text + "\n";
}

/// Returns covariances of some poses and points that belong to this process, and of points with their first pose.
std::string covariances(const slom::Estimator& est, PetscSolver* solver,
                        const std::map<int, slom::VarID<Pose>>& poses,
                        const std::map<int, slom::VarID<Point>>& points) {
  std::vector<slom::AnyVarID> ids;
  std::vector<std::pair<int, int>> chosen;  // point, and the pose that saw it first
  for (const auto& [k, id] : points) {
    const int pose = (k * 3) % 40;
    if (k % 47 != 0 || (solver != nullptr && !solver->isOwn(poses.at(pose)))) continue;
    chosen.emplace_back(k, pose);
    ids.insert(ids.end(), {id, poses.at(pose)});
  }
  if (points.empty()) ids.push_back(poses.begin()->second);  // without landmarks
  const auto texts = [&](const auto& by) {
    std::string text;
    for (const auto& [k, i] : chosen) {
      const std::string point = "point" + std::to_string(k), pose = "pose" + std::to_string(i);
      text += line(point, by.covariance(points.at(k)));
      text += line(pose, by.covariance(poses.at(i)));
      text += line(point + "-" + pose, by.covariance(points.at(k), poses.at(i)));
    }
    return text;
  };
  if (solver == nullptr) return texts(est);
  return texts(slom::distributed::Covariances(est, *solver, ids));
}

int run(const std::string& problem, const std::string& algorithm, const std::string& method,
        bool with_covariances) {
  const Processes processes;
  const int P = processes.size(), rank = processes.rank();
  own_rank = rank;
  constexpr int pose_count = 40, point_count = 300;
  std::vector<Pose> truth;
  std::vector<Global<Pose>> poses;
  for (int i = 0; i < pose_count; ++i) {
    const double angle = 2 * M_PI * i / pose_count;
    truth.push_back({mtk::SO3<>::exp(noise(1)), Point(8 * std::cos(angle), 8 * std::sin(angle), normal(1))});
    poses.push_back({moved(truth.back(), 0.1, 0.05), i * P / pose_count});
  }
  std::vector<Point> true_points;
  std::vector<Global<Point>> points;
  for (int i = 0; i < point_count; ++i) {
    true_points.push_back(noise(3));
    points.push_back({true_points.back() + noise(0.2), i * P / point_count});
  }
  slom::Estimator est;
  SharedVariables shared;
  Inserted<Pose> own_poses(est, shared, rank, 0, poses);
  Inserted<Point> own_points(est, shared, rank, 1000, points);
  const bool is_free = problem == "free";
  const slom::Loss loss = problem == "losses" ? slom::Loss(slom::Huber(1.5)) : slom::Loss();
  const auto pose = [&](int i) { return own_poses.get(i, i != 0 || is_free); };
  for (int i = 0; i < pose_count; ++i) {
    for (const int step : {1, 2, 7}) {
      const int j = (i + step) % pose_count;
      const double gross = step == 7 && i % 5 == 0 ? 30 : 1;
      const Pose measured =
          moved(truth[std::size_t(i)].inverse() * truth[std::size_t(j)], 0.01 * gross, 0.002 * gross);
      if (poses[std::size_t(i)].home != rank) continue;
      est.insertMeasurement(
          slom::RelativePose(), pose(i), pose(j), slom::measured(measured),
          slom::StandardDeviation(Eigen::Matrix<double, 6, 1>(
              (Eigen::Matrix<double, 6, 1>() << 0.01, 0.01, 0.01, 0.002, 0.002, 0.002).finished())),
          loss, slom::named("edge"));
    }
  }
  for (int k = 0; problem != "free" && k < point_count; ++k) {
    // A point belongs to one process: that of its first pose.
    const int first = (k * 3) % pose_count;
    for (int m = 0; m < 5; ++m) {
      const int i = (first + m) % pose_count;
      const Point seen = truth[std::size_t(i)].inverse() * true_points[std::size_t(k)] + noise(0.02);
      const double distance = (truth[std::size_t(i)].pos - true_points[std::size_t(k)]).norm() + normal(0.05);
      if (poses[std::size_t(first)].home != rank) continue;
      est.insertMeasurement(slom::Landmark(), pose(i), own_points.get(k), slom::measured(seen),
                            slom::StandardDeviation(0.02), loss, slom::named("sighting"));
      est.insertMeasurement(Distance(), pose(i), own_points.get(k), slom::measured(distance),
                            slom::StandardDeviation(0.05), loss, slom::named("distance"));
    }
  }
  if (problem == "fixed") {  // a rotation about z is held, in all processes that have the pose
    for (const auto& [i, id] : own_poses.ids) {
      if (i == 9) est.fix(id, "orient.z");
    }
  }
  if (problem == "throws" && rank == P - 1)
    est.insertMeasurement(Throws(), pose(pose_count - 1), slom::measured(0.0), slom::StandardDeviation(1.0));
  if (problem == "disagree") {
    for (const auto& [i, id] : own_poses.ids) {
      if (i == pose_count / 2 && rank == 0) est.optimizeRV(id, false);
    }
  }
  PetscSolver* petsc = nullptr;
  if (method != "own") {
    PetscSolverOptions options;
    const std::map<std::string, PetscMethod> methods{
        {"auto", PetscMethod::automatic},         {"cholesky", PetscMethod::cholesky},
        {"jacobi", PetscMethod::jacobi},          {"block_jacobi", PetscMethod::block_jacobi},
        {"schwarz", PetscMethod::schwarz},        {"multigrid", PetscMethod::multigrid},
        {"matrix_free", PetscMethod::matrix_free}};
    options.method = methods.at(method);
    options.tolerance = 1e-13;
    auto solver = std::make_unique<PetscSolver>(est, shared, options);
    petsc = solver.get();
    est.changeSolver(std::move(solver));
  }
  slom::Estimator* const fitted = &est;
  if (algorithm == "lm") fitted->changeAlgorithm(slom::LevenbergMarquardt());
  if (algorithm == "dogleg") fitted->changeAlgorithm(slom::DogLeg());
  if (problem == "estimated") est.setSigma(slom::Sigma::estimated);
  const slom::Summary summary = est.optimize();
  if (with_covariances) {
    std::string all;
    for (const std::string& part : processes.gather(covariances(est, petsc, own_poses.ids, own_points.ids)))
      all += part;
    if (rank == 0) std::fputs(all.c_str(), stdout);
    return 0;
  }
  std::string text;
  const auto isOwn = [&](const auto& id) { return petsc == nullptr || petsc->isOwn(id); };
  for (const auto& [i, id] : own_poses.ids) {
    if (!isOwn(id) || (petsc != nullptr && !petsc->hasUnknowns(id))) continue;
    Eigen::Matrix<double, 6, 1> x;
    x << id->pos, mtk::SO3<>::log(id->orient);
    const Eigen::VectorXd sigma = petsc == nullptr && i > 0 ? est.standardDeviation(id) : Eigen::VectorXd();
    printComponents(text, "pose" + std::to_string(i), x.data(), sigma.size() == 0 ? nullptr : sigma.data(),
                    6);
  }
  for (const auto& [i, id] : own_points.ids) {
    if (!isOwn(id)) continue;
    const Eigen::VectorXd sigma = petsc == nullptr ? est.standardDeviation(id) : Eigen::VectorXd();
    printComponents(text, "point" + std::to_string(i), id->data(), sigma.size() == 0 ? nullptr : sigma.data(),
                    3);
  }
  std::string all;
  for (const std::string& part : processes.gather(text)) all += part;
  if (rank > 0) return summary.converged ? 0 : 1;
  std::printf("rss %.17g\nconverged %d\nmeasurements %d\nunknowns %d\nmessage %s\nsolver %s\n%s",
              summary.final_rss, int(summary.converged), summary.measurements, summary.unknowns,
              summary.message.c_str(), summary.solver.c_str(), all.c_str());
  for (const slom::GroupSummary& group : summary.groups)
    std::printf("group %s %d %.10g\n", group.name.c_str(), group.measurements, group.final_rss);
  return summary.converged ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  try {
    const slom::distributed::Session session;
    try {
      return run(argv[1], argv[2], argv[3], argc > 4);
    } catch (const slom::Error& error) {
      if (!Processes::haveAgreedOnError()) throw;
      // Within the session: mpirun ends all processes as soon as one has ended with an error. One write for each line:
      // mpirun mixes the writes of the processes.
      if (Processes::processOfError() == own_rank) std::cerr << std::string(error.what()) + "\n";
      std::cerr << "caught\n";
      return 3;
    }
  } catch (const slom::Error&) {
    std::cerr << "caught\n";
    return 3;
  }
}
