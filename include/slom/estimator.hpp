/// The estimator: takes variables and measurements, finds the values that fit best, and computes their uncertainty.
///
///     slom::Estimator est;
///     auto circle = est.insertRV(mtk::vect<3>(0, 0, 1), "circle");
///     for (const auto& p : points) est.insertMeasurement(OnCircle(circle, p), slom::StandardDeviation(0.1));
///     std::cout << est.optimize() << *circle << "\n";
///
/// The estimator minimises the RSS, the sum of squared residuals, each whitened by its stated uncertainty. A
/// measurement with a robust loss (slom/model/loss.hpp) adds rho(|W r|^2) to the RSS instead of |W r|^2. Every RSS
/// below is this robust cost. The functions residual, whitenedResidual and residuals ignore losses.
///
/// Analyses of a fit are functions that take the estimator, below slom/analyze: diagnose, preflight, outliers,
/// checkDerivatives, profile, intervals, clustered and varianceComponents. slom/slom.hpp includes them.
///
/// Several threads call measurement functions at once (setThreads changes that), so these must not write to shared
/// data.
///
/// Mistakes of the caller throw mtk::Error with a stable id. After any exception the estimator is as it was before the
/// call, except that completed steps of an optimisation remain.
#pragma once

#include <concepts>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/analyze/printing.hpp"
#include "slom/analyze/report.hpp"
#include "slom/analyze/uncertainty.hpp"
#include "slom/model/callable.hpp"
#include "slom/model/component_prior.hpp"
#include "slom/model/insertion.hpp"
#include "slom/model/pimpl.hpp"
#include "slom/model/prior.hpp"
#include "slom/model/runtime_measurement.hpp"
#include "slom/online/update.hpp"
#include "slom/optimize/algorithm.hpp"
#include "slom/optimize/step_record.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

class Archive;
class GaussianPrior;

namespace detail {

struct AnalysisAccess;

[[noreturn]] void raiseMovedFrom();

template <class T>
using VariableType = std::conditional_t<std::is_integral_v<T>, double, PlainValue<T>>;

}  // namespace detail

/// How Estimator::marginalize linearises from then on.
struct MarginalizeOptions {
  /// If true, the priors keep the linearisation points of their variables for all measurements of these variables
  /// (first-estimate Jacobians). Motions that no measurement observes then stay free (docs/windows.md).
  bool first_estimates = false;
};

/// Variables, measurements and the fit of the variables to the measurements. Movable; only clone() copies it.
class Estimator {
 public:
  Estimator();
  ~Estimator();
  /// A moved-from estimator is empty: all its functions throw [slom.moved-from] until another estimator is assigned to
  /// it.
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  /// Returns a deep copy: variables, measurements, what is fixed or bounded, groups, losses, noise, algorithm, solver
  /// and settings. Copy and original are then independent. They share only what measurement functions hold by
  /// reference, pointer or std::shared_ptr. The copy fits as the original would; its first update() starts from
  /// scratch. The copy accepts the handles that the original had at the time of the copy. `*id` still reads the
  /// original, `*copy.own(id)` the copy. Throws [slom.not-copyable] for measurements or solvers that cannot be copied.
  Estimator clone() const;
  /// Returns this estimator's handle for a handle of the estimator that it was cloned from. Returns its own handles
  /// unchanged. Throws [slom.stale-handle] and [slom.foreign-handle].
  template <class T>
  VarID<T> own(const VarID<T>& id) const {
    return problem().own(id);
  }
  template <class M>
  MeasID<M> own(const MeasID<M>& id) const {
    return problem().own(id);
  }
  AnyMeasID own(const AnyMeasID& id) const { return problem().own(id); }
  AnyVarID own(const AnyVarID& id) const { return problem().own(id); }

  // Variables.

  /// Adds a variable with its start value. If `optimize` is false, the variable keeps that value. `name` is for
  /// messages. Returns a VarID; for a RuntimeValue an AnyVarID. A RuntimeValue throws [slom.bad-type] if it has no type,
  /// and as RuntimeType::normalized.
  template <class T>
  auto insertRV(const T& value) {
    return insertVariable(value, true, {});
  }
  template <class T, std::same_as<bool> Flag>
  auto insertRV(const T& value, Flag optimize, std::string_view name = {}) {
    return insertVariable(value, optimize, name);
  }
  template <class T>
  auto insertRV(const T& value, std::string_view name) {
    return insertVariable(value, true, name);
  }
  /// Calls insertRV; the paper's outlook uses this name.
  template <class T, class... More>
  auto registerRV(const T& value, More&&... more) {
    return insertRV(value, std::forward<More>(more)...);
  }
  /// Sets the value of a variable: a new start value or, if the variable is fixed, its constant.
  template <class T>
  void reinitRV(const VarID<T>& id, const std::type_identity_t<T>& value) {
    problem().setValue(id, value);
  }
  /// Throws [slom.wrong-type] if the variable is not of the type of the value.
  void reinitRV(const AnyVarID& id, const RuntimeValue& value);
  /// Fixes a variable at its current value, or releases it.
  template <AnyVariableHandle V>
  void optimizeRV(const V& id, bool optimize) {
    problem().setOptimized(problem().indexOf(id), optimize);
  }
  // Parts of variables. A path names a component or all components below it, as messages do: "pos.z", "pos". An unknown
  // path throws [slom.no-component], which lists the valid ones.

  /// Fixes a variable, like optimizeRV(id, false).
  template <AnyVariableHandle V>
  void fix(const V& id) {
    optimizeRV(id, false);
  }
  /// Fixes components at their current values. Fixed components are not unknowns and have covariance 0.
  template <AnyVariableHandle V>
  void fix(const V& id, const std::string& path) {
    setFixed(id, path, true);
  }
  /// Fixes the components of a member, whose name the compiler checks: `est.fix(&Camera::k3, cam)`.
  template <class M, class C, std::derived_from<C> T>
  void fix(M C::*member, const VarID<T>& id) {
    setFixed(member, id, true);
  }
  /// Releases a variable and all its components.
  template <AnyVariableHandle V>
  void free(const V& id) {
    const int variable = problem().indexOf(id);
    problem().setOptimized(variable, true);
    setFixed(variable, 0, problem().variables()[static_cast<std::size_t>(variable)].dof, false);
  }
  /// Releases fixed components.
  template <AnyVariableHandle V>
  void free(const V& id, const std::string& path) {
    setFixed(id, path, false);
  }
  template <class M, class C, std::derived_from<C> T>
  void free(M C::*member, const VarID<T>& id) {
    setFixed(member, id, false);
  }
  /// Keeps the coordinates of components of vectors within [lower, upper]. Infinite limits remove the bound. The fit
  /// holds a component at a limit if it would go beyond (active set method: Nocedal and Wright, "Numerical
  /// optimization", 2006, section 16.7). The summary lists these components, and covariances are conditional on their
  /// values. Throws [slom.bad-bound], or [slom.outside-bound] if the current value is outside.
  template <AnyVariableHandle V>
  void bound(const V& id, const std::string& path, double lower, double upper) {
    bound(problem().indexOf(id), path, lower, upper);
  }
  /// Bounds every component of a variable. Each must be a coordinate of a vector.
  template <AnyVariableHandle V>
  void bound(const V& id, double lower, double upper) {
    bound(problem().indexOf(id), "", lower, upper);
  }
  /// Adds prior knowledge of a variable: a measurement x [-] value, with a standard deviation or another uncertainty.
  /// removeMeasurement removes it.
  template <class T, class Noise>
  auto prior(const VarID<T>& id, const std::type_identity_t<T>& value, const Noise& uncertainty) {
    const auto insert = [&](const auto& noise) {
      return insertMeasurement(Prior(), id, measured(value), noise, named("prior"));
    };
    if constexpr (detail::is_option<Noise>) {
      return insert(uncertainty);
    } else {
      return insert(StandardDeviation(uncertainty));
    }
  }
  /// Adds a prior on one coordinate by its path: `est.prior(pose, "pos.z", 1.2, 0.05)`. With a vector, the prior is on
  /// all coordinates below the path: `est.prior(pose, "pos", Eigen::Vector3d(0, 0, 1.2), 0.05)`. Throws
  /// [slom.no-component], which lists the valid paths, for an unknown path and for parts without coordinates, such as
  /// rotations. Throws [slom.wrong-length] or [slom.prior-not-finite].
  template <class T, class Noise>
  MeasID<ComponentPrior<T>> prior(const VarID<T>& id, const std::string& path, double value,
                                  const Noise& uncertainty) {
    return insertComponentPrior(id, path, &value, 1, uncertainty);
  }
  template <class T, class Noise>
  MeasID<ComponentPrior<T>> prior(const VarID<T>& id, const std::string& path, const Eigen::VectorXd& values,
                                  const Noise& uncertainty) {
    return insertComponentPrior(id, path, values.data(), static_cast<int>(values.size()), uncertainty);
  }

  /// Removes a variable. Throws [slom.variable-in-use], with the number of measurements, if any depend on the variable.
  template <AnyVariableHandle V>
  void removeRV(const V& id) {
    problem().removeVariable(problem().indexOf(id));
  }
  /// Returns the name given at insertion, or one made of type and running number.
  template <AnyVariableHandle V>
  std::string nameOf(const V& id) const {
    return problem().variableName(problem().indexOf(id));
  }

  // Measurements.

  /// Adds a measurement whose type is declared by SLOM_BUILD_MEASUREMENT or chooses its variables at run time, such as
  /// GaussianPrior. Options, in any order:
  ///   uncertainty            none: unit covariance
  ///   loss                   none: least squares
  ///   slom::named("label")
  ///   slom::group(key)       for errors that measurements share (slom/model/group.hpp)
  template <class M, class... Options>
    requires(Measurement<M> || std::derived_from<M, RuntimeMeasurement>)
  MeasID<M> insertMeasurement(M measurement, const Options&... options) {
    static_assert(
        (detail::is_option<Options> && ...),
        "slom: an argument after the measurement must be its uncertainty (Covariance, StandardDeviation, "
        "InvCovariance or InvStandardDeviation), its loss (Huber, ...), its label (slom::named) or a "
        "group (slom::group)");
    const detail::Values<const Options&...> all{{options}...};
    if constexpr (detail::group_count<Options...> > 0) {
      const auto groups = detail::groupsAmong<Options...>(all);
      return inGroups(problem().insertMeasurement(std::move(measurement), detail::noiseAmong<Options...>(all),
                                                  detail::labelAmong<Options...>(all),
                                                  detail::lossAmong<Options...>(all)),
                      groups.all.data(), groups.count);
    } else {
      return problem().insertMeasurement(std::move(measurement), detail::noiseAmong<Options...>(all),
                                         detail::labelAmong<Options...>(all),
                                         detail::lossAmong<Options...>(all));
    }
  }
  /// Adds a measurement whose residual is the value of `f`. VarID arguments become variables (f gets a const T&); all
  /// other arguments are data, stored by value. Options as above. If slom::measured(z) is among the arguments, f
  /// predicts the datum z, and the residual is f(Y) [-] z. Derivatives:
  ///   f accepts other number types (`const auto&`)   exact
  ///   f has a member `jacobian`                      as that member gives them
  ///   otherwise                                      central differences
  template <class F, class... Args>
    requires(!Measurement<F> && !std::derived_from<F, RuntimeMeasurement> && sizeof...(Args) > 0)
  auto insertMeasurement(F f, const Args&... args) {
    const detail::Values<const Args&...> all{{args}...};
    if constexpr (detail::group_count<Args...> > 0) {
      const auto groups = detail::groupsAmong<Args...>(all);
      return inGroups(
          insertCallable(std::move(f), all, detail::DataIndices<Args...>{}, detail::noiseAmong<Args...>(all),
                         detail::labelAmong<Args...>(all), detail::lossAmong<Args...>(all)),
          groups.all.data(), groups.count);
    } else {
      return insertCallable(std::move(f), all, detail::DataIndices<Args...>{},
                            detail::noiseAmong<Args...>(all), detail::labelAmong<Args...>(all),
                            detail::lossAmong<Args...>(all));
    }
  }
  /// Adds a measurement over a list of variables of any number and types. `f` gets a std::span<const VariableView>;
  /// data and options are as above. Derivatives are central differences.
  template <class F, class... Args>
  auto insertMeasurement(F f, const std::vector<AnyVarID>& variables, const Args&... args) {
    const detail::Values<const Args&...> all{{args}...};
    if constexpr (detail::group_count<Args...> > 0) {
      const auto groups = detail::groupsAmong<Args...>(all);
      return inGroups(insertList(std::move(f), variables, all, detail::DataIndices<Args...>{},
                                 detail::noiseAmong<Args...>(all), detail::labelAmong<Args...>(all),
                                 detail::lossAmong<Args...>(all)),
                      groups.all.data(), groups.count);
    } else {
      return insertList(std::move(f), variables, all, detail::DataIndices<Args...>{},
                        detail::noiseAmong<Args...>(all), detail::labelAmong<Args...>(all),
                        detail::lossAmong<Args...>(all));
    }
  }
  /// Calls insertMeasurement; the paper's outlook uses this name.
  template <class F, class... Args>
  auto registerMeasurement(F f, const Args&... args) {
    return insertMeasurement(std::move(f), args...);
  }
  // Functions that take a MeasurementHandle accept a MeasID or an AnyMeasID. They throw [slom.stale-handle].

  /// Puts an existing measurement into a group, in place of its group of the same dimension, if any.
  void setGroup(const MeasurementHandle& id, const Group& group);
  /// Removes a measurement: `est.removeMeasurement(slom::outliers(est).ranking().front().id)`.
  void removeMeasurement(const MeasurementHandle& id);
  /// Returns the name used in messages and reports, such as `Gravity #12`: the label or type, and the running number
  /// among measurements of that label or type.
  std::string nameOf(const MeasurementHandle& id) const;

  /// Removes variables and keeps what their measurements say about other variables. The measurements of `ids` are
  /// linearised at the current values. GaussianPriors on the remaining variables of these measurements replace them,
  /// one prior for each set of variables that the elimination couples. `ids` may be any set of variables; duplicates
  /// count once.
  ///
  /// In a linear problem later steps are the same as without marginalisation. In a nonlinear one they no longer follow
  /// changes of the removed measurements, so marginalise after the fit has converged. Losses enter by their weights at
  /// the current values. Fixed variables and components enter as known. The RSS loses the part that no value of the
  /// remaining variables could explain. The number of residuals falls by the number of residuals in that part.
  ///
  /// If all replaced measurements of this call are in a group (slom::group), the priors are in that group too. With
  /// first estimates, the Jacobians of all measurements of the remaining variables are from then on taken at their
  /// present values. This ends when no prior from this call depends on the variable. Throws [slom.stale-handle],
  /// [slom.foreign-handle], [slom.not-finite] or [slom.measurement-threw]; nothing is changed.
  ///   source   Sibley, Matthies, Sukhatme, "Sliding window filter with application to planetary landing", 2010
  std::vector<MeasID<GaussianPrior>> marginalize(const std::vector<AnyVarID>& ids,
                                                 const MarginalizeOptions& options = {});

  // Optimisation.

  /// Takes one step of the algorithm. The result converts to the relative gain (old RSS - new RSS) / old RSS, which is
  /// negative if a Gauss-Newton step led uphill. Throws [slom.rank-deficient], [slom.unmeasured-variable] or
  /// [slom.not-finite], with the values unchanged.
  StepRecord optimizeStep();
  /// Takes steps until the fit has converged or cannot continue. A numerical failure is not an exception: check
  /// `converged`, `stop_reason` and `message` of the summary. If the fit has not converged, the values are the best
  /// found. After `rank_deficient` they are the values at which an unknown has no influence. Throws [slom.not-finite]
  /// or [slom.measurement-threw] if a measurement has a residual but no finite derivative. The estimator then keeps the
  /// values where that happened: the start values or those after a step.
  Summary optimize(const Options& options = {});
  /// Brings the values to the optimum after insertions, removals and other changes, for problems that grow while they
  /// are fitted. The time is proportional to what the changes affect. The optimum is that of optimize(), unless the
  /// values lie in the basin of another local minimum. May be mixed with optimizeStep() and optimize(). Throws
  /// [slom.bad-option]. Throws [slom.not-finite] or [slom.measurement-threw] if a new measurement has no residual or no
  /// finite derivative at the values of its insertion, or if a measurement has no derivative at the values after a
  /// step.
  UpdateSummary update(const UpdateOptions& options = {});

  /// Sets the algorithm and takes ownership: `est.changeAlgorithm(new SLOM::LevenbergMarquardt())`.
  void changeAlgorithm(Algorithm* algorithm);
  /// Sets the algorithm by value: `est.changeAlgorithm(slom::DogLeg())`.
  template <std::derived_from<Algorithm> A>
  void changeAlgorithm(const A& algorithm) {
    changeAlgorithm(new A(algorithm));
  }
  /// Sets the solver of the linear systems; the default is BlockSolver.
  void changeSolver(std::unique_ptr<LinearSolver> solver);
  /// Sets the maximum number of threads; 0 (default): all of the machine. Any number gives the same bits.
  void setThreads(int threads);

  // Residuals and uncertainty.

  /// Returns the sum of squared whitened residuals at the current values. A measurement with a loss adds rho(|W r|^2).
  double getRSS() const;
  /// Returns the RSS of all measurements of type M.
  template <class M>
    requires(Measurement<M> || std::derived_from<M, RuntimeMeasurement>)
  double getRSS() const {
    return rssOfPools(problem().template poolsOf<M>());
  }
  /// Returns the RSS of one measurement.
  double getRSS(const MeasurementHandle& id) const;
  /// Returns the RSS of all measurements that depend on a variable.
  template <AnyVariableHandle V>
  double getRSS(const V& id) const {
    return rssOfVariable(problem().indexOf(id));
  }
  /// Returns the weight that a measurement has from its loss: the factor rho'(|W r|^2) of its square, between 1 (full
  /// weight, also without a loss) and 0.
  double weight(const MeasurementHandle& id) const;
  /// Returns sqrt(RSS / M), near 1 if the stated uncertainties are right; 0 without measurements.
  double getRMS() const;
  /// Returns M, the number of scalar residuals.
  int getM() const;
  /// Returns N, the number of unknowns: degrees of freedom of all optimised variables, without fixed components.
  /// Components at a bound count here. Summary::unknowns excludes components whose bound is active after a fit.
  int getN() const;

  /// Returns the residual of a measurement in its own units, f(Y) [-] z.
  Eigen::VectorXd residual(const MeasurementHandle& id) const { return residualOf(id, false); }
  /// Returns the residual in units of its standard deviation.
  Eigen::VectorXd whitenedResidual(const MeasurementHandle& id) const { return residualOf(id, true); }
  /// Returns all whitened residuals, type by type in the order of first insertion.
  Eigen::VectorXd residuals() const {
    Eigen::VectorXd r(getM());
    writeResiduals(r.data());
    return r;
  }

  /// Returns the covariance of a variable in its tangent space (dof x dof), or the cross-covariance of two variables
  /// (dof_a x dof_b); 0 for fixed variables. It holds for the stated uncertainties and the linearisation at the current
  /// values. Check Summary::converged first: a fit that has not converged leaves arbitrary values. With losses, the
  /// linearisation is that of the fit, in which measurements have their weights. Near the optimum the covariance is
  /// then the inverse curvature of the robust cost. Throws [slom.free-gauge], which names the free motions,
  /// [slom.rank-deficient] or [slom.unmeasured-variable].
  template <AnyVariableHandle V>
  Eigen::MatrixXd covariance(const V& id) const {
    return covariance(id, id);
  }
  template <AnyVariableHandle A, AnyVariableHandle B>
  Eigen::MatrixXd covariance(const A& a, const B& b) const {
    const int i = problem().indexOf(a), j = problem().indexOf(b);
    Eigen::MatrixXd block(dofOf(i), dofOf(j));
    writeCovariance(i, j, block.data());
    return block;
  }
  /// Returns the joint covariance of several variables in the given order: n x n, n the sum of their degrees of
  /// freedom. Throws as covariance does.
  template <AnyVariableHandle... V>
  Eigen::MatrixXd jointCovariance(const V&... ids) const {
    return jointCovarianceOf({problem().indexOf(ids)...});
  }
  Eigen::MatrixXd jointCovariance(const std::vector<AnyVarID>& ids) const {
    std::vector<int> variables;
    for (const AnyVarID& id : ids) variables.push_back(problem().indexOf(id));
    return jointCovarianceOf(variables);
  }
  /// Returns the standard deviation of each component.
  template <AnyVariableHandle V>
  Eigen::VectorXd standardDeviation(const V& id) const {
    const int variable = problem().indexOf(id);
    Eigen::VectorXd result(dofOf(variable));
    writeDeviations(variable, result.data());
    return result;
  }
  /// Returns the correlations of the components of a with those of b, each from -1 to 1; dof_a x dof_b. An entry is 0
  /// if one of the components has variance 0.
  template <AnyVariableHandle A, AnyVariableHandle B>
  Eigen::MatrixXd correlation(const A& a, const B& b) const {
    const auto inverse = [](double s) { return s > 0 ? 1 / s : 0.0; };
    const Eigen::VectorXd scale_a = standardDeviation(a).unaryExpr(inverse),
                          scale_b = standardDeviation(b).unaryExpr(inverse);
    return scale_a.asDiagonal() * covariance(a, b) * scale_b.asDiagonal();
  }
  /// Returns covariances between updates, from the factor of update(). The time is proportional to the path from the
  /// variables to the root of the elimination tree. For new variables it is short, however large the problem. Jacobians
  /// in the factor may be those of slightly earlier values, so the result agrees with covariance() to about 1 %. With
  /// Sigma::estimated, the variance factor needs a linearisation of everything. Throws [slom.rank-deficient]. Throws
  /// [slom.not-updated] if something has changed since the last update(), or if optimize() took over in that call.
  template <AnyVariableHandle V>
  Eigen::MatrixXd updatedCovariance(const V& id) const {
    return updatedCovariance(id, id);
  }
  template <AnyVariableHandle A, AnyVariableHandle B>
  Eigen::MatrixXd updatedCovariance(const A& a, const B& b) const {
    const int i = problem().indexOf(a), j = problem().indexOf(b);
    Eigen::MatrixXd block(dofOf(i), dofOf(j));
    writeUpdatedCovariance(i, j, block.data());
    return block;
  }
  /// Returns the covariances of all variables at once, by selected inversion of the factor. For many variables this is
  /// much faster than one call for each.
  Marginals marginals() const;
  /// Returns the covariances of all variables between updates, from the factor of update(), like updatedCovariance(). A
  /// covariance is computed again unless its relative change since the last call is certainly at most `tolerance`. Each
  /// returned covariance C has an error between -tolerance C and tolerance C in the order of positive semidefinite
  /// matrices. So no standard deviation is off by more than about tolerance / 2, relative to itself. With 0, every
  /// changed covariance is computed again. Throws [slom.not-updated] and [slom.rank-deficient]. Not const: it keeps
  /// parts of the inverse for the next call.
  Marginals updatedMarginals(double tolerance = 1e-3);
  /// Adds the table of parameters to the summary of a fit with more than Options::most_parameters unknowns. report()
  /// and json() then show all parameters, without correlations. The values are the current ones; the summary must be
  /// that of the last fit. Does nothing if the table is there. Throws [slom.no-parameters] for a summary with another
  /// number of unknowns, and as covariance does.
  void addParametersTo(Summary& summary) const;
  /// Returns f(values of the variables) and its covariance to first order. f gets a const T& for each variable and
  /// returns a number, an Eigen vector or a manifold. Its derivatives are found as for measurements.
  template <class F, class... T>
  auto propagate(const F& f, const VarID<T>&... ids) const {
    return propagate(f, jointCovariance(ids...), ids...);
  }
  /// Propagates another joint covariance of these variables, such as Clustered::jointCovariance.
  template <class F, class... T>
  auto propagate(const F& f, const Eigen::MatrixXd& C, const VarID<T>&... ids) const {
    auto value = detail::plainValue(f(*own(ids)...));
    using V = std::decay_t<decltype(value)>;
    Estimator scratch;
    const std::tuple copies{scratch.insertRV(*own(ids))...};
    std::apply([&](const auto&... copy) { scratch.insertMeasurement(f, copy..., measured(value)); }, copies);
    Eigen::MatrixXd J(scratch.getM(), scratch.getN());
    scratch.writeJacobian(J.data());
    detail::requireCovarianceSize(C.rows(), C.cols(), static_cast<int>(J.cols()));
    Propagated<V> result{std::move(value), Eigen::MatrixXd(J.rows(), J.rows())};
    detail::propagate(J.data(), C.data(), static_cast<int>(J.rows()), static_cast<int>(J.cols()),
                      result.covariance.data());
    return result;
  }
  /// Chooses what covariances and standard deviations trust: the stated uncertainties (Sigma::known, the default) or
  /// only their ratios (Sigma::estimated). With Sigma::estimated they throw [slom.no-redundancy] unless there are more
  /// residuals than unknowns.
  void setSigma(Sigma sigma);
  /// Returns the value set by setSigma.
  Sigma sigma() const;
  /// Chooses how fits and covariances treat a free gauge: a rigid motion or scale of everything, or a common shift of
  /// some numbers, such as heights. FreeGauge::inner_constraints fits a free network.
  void setFreeGauge(FreeGauge gauge);
  /// Returns the value set by setFreeGauge.
  FreeGauge freeGauge() const;

  /// Returns the table of variables and measurements: its content, its revision, and what has changed or moved since
  /// another revision.
  const Problem& table() const { return problem(); }

  /// Returns the names of the components, as in messages.
  template <AnyVariableHandle V>
  std::vector<std::string> componentNames(const V& id) const {
    return problem().componentNames(problem().indexOf(id));
  }

  /// Returns one sentence for each optimised variable that no measurement depends on.
  std::vector<std::string> warnings() const;

 private:
  friend class Archive;
  friend struct detail::AnalysisAccess;

  template <class T>
  auto insertVariable(const T& value, bool optimize, std::string_view name) {
    using V = detail::VariableType<T>;
    static_assert((mtk::requireManifold<V>(), true));
    if constexpr (mtk::Manifold<V>) {
      return problem().template insertVariable<V>(V(value), optimize, name);
    } else {
      return VarID<V>();  // so that the message of requireManifold is the only one
    }
  }
  AnyVarID insertVariable(const RuntimeValue& value, bool optimize, std::string_view name);
  template <class T, class Noise>
  MeasID<ComponentPrior<T>> insertComponentPrior(const VarID<T>& id, const std::string& path,
                                                 const double* values, int count, const Noise& uncertainty) {
    std::vector<int> components =
        problem().coordinatesAt(problem().indexOf(id), path, values, static_cast<std::size_t>(count));
    ComponentPrior<T> prior(id, std::move(components), {values, values + count});
    if constexpr (detail::is_option<Noise>) {
      return insertMeasurement(std::move(prior), uncertainty, named("prior"));
    } else {
      return insertMeasurement(std::move(prior), StandardDeviation(uncertainty), named("prior"));
    }
  }
  template <class F, class Arguments, std::size_t... I>
  auto insertCallable(F f, const Arguments& args, std::index_sequence<I...>, const NoiseView& noise,
                      std::string_view label, const Loss& loss) {
    if constexpr (requires { typename F::Traced; }) {  // slom::traced
      return F::insert(problem(), f, noise, label, loss, detail::plainValue(detail::valueAt<I>(args))...);
    } else {
      using M = CallableMeasurement<F, detail::PlainValue<decltype(detail::valueAt<I>(args))>...>;
      return problem().insertMeasurement(M(std::move(f), detail::valueAt<I>(args)...), noise, label, loss);
    }
  }
  template <class F, class Arguments, std::size_t... I>
  auto insertList(F f, const std::vector<AnyVarID>& variables, const Arguments& args,
                  std::index_sequence<I...>, const NoiseView& noise, std::string_view label,
                  const Loss& loss) {
    using M = ListMeasurement<F, detail::PlainValue<decltype(detail::valueAt<I>(args))>...>;
    return problem().insertMeasurement(M(variables, std::move(f), detail::valueAt<I>(args)...), noise, label,
                                       loss);
  }

  template <class M>
  MeasID<M> inGroups(const MeasID<M>& id, const Group* groups, int count) {
    const auto [pool, i] = problem().locate(id);
    problem().assignGroups(*pool, i, groups, count);
    return id;
  }

  template <AnyVariableHandle V>
  void setFixed(const V& id, const std::string& path, bool is_fixed) {
    const int variable = problem().indexOf(id);
    problem().setFixed(variable, problem().componentsAt(variable, path), is_fixed);
  }
  Eigen::MatrixXd jointCovarianceOf(const std::vector<int>& variables) const {
    int n = 0;
    for (const int variable : variables) n += dofOf(variable);
    Eigen::MatrixXd C(n, n);
    writeJointCovariance(variables.data(), static_cast<int>(variables.size()), C.data());
    return C;
  }
  template <class M, class C, class T>
  void setFixed(M C::*member, const VarID<T>& id, bool is_fixed) {
    const int variable = problem().indexOf(id);
    const T& value = *own(id);
    const auto [first, count] = detail::componentsOf(value, &(value.*member), typeid(M), 0);
    if (first < 0) raiseNoMember(variable);
    setFixed(variable, first, count, is_fixed);
  }
  void bound(int variable, const std::string& path, double lower, double upper);
  void setFixed(int variable, int first, int count, bool is_fixed);
  [[noreturn]] void raiseNoMember(int variable) const;

  Problem& problem() const;
  int dofOf(int variable) const;
  double rssOfPools(const std::vector<const MeasurementPool*>& pools) const;
  double rssOfVariable(int variable) const;
  double rssOfMeasurement(MeasurementPool& pool, int i) const;
  Eigen::VectorXd residualOf(const MeasurementHandle& id, bool whitened) const {
    const auto [pool, i] = problem().locate(id);
    Eigen::VectorXd r(pool->rows(i));
    writeResidual(*pool, i, whitened, r.data());
    return r;
  }
  // Results cross the boundary of the compiled library as plain numbers. How Eigen's dynamic types allocate depends on
  // compiler options, and the library may have been compiled with others.
  void writeResidual(MeasurementPool& pool, int i, bool whitened, double* r) const;
  void writeResiduals(double* r) const;
  void writeJacobian(double* J) const;
  void writeUpdatedCovariance(int variable_a, int variable_b, double* block) const;
  /// Writes the joint covariance of these variables.
  void writeJointCovariance(const int* variables, int count, double* out) const;
  void writeCovariance(int variable_a, int variable_b, double* block) const;
  void writeDeviations(int variable, double* deviations) const;

  struct State;
  detail::Pimpl<State, &detail::raiseMovedFrom> state_;
};

}  // namespace slom
