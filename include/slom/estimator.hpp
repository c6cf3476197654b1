/// The estimator: takes variables and measurements, finds the values that fit best, says how sure they are.
///
///     slom::Estimator est;
///     auto circle = est.insertRV(mtk::vect<3>(0, 0, 1), "circle");
///     for (const auto& p : points) est.insertMeasurement(OnCircle(circle, p), slom::StandardDeviation(0.1));
///     std::cout << est.optimize() << *circle << "\n";
///
/// It minimises the RSS, the sum of squared residuals, each whitened by its stated uncertainty. A measurement with a
/// robust loss (slom/model/loss.hpp) adds rho(|W r|^2) to it instead of |W r|^2: every RSS below is this robust cost,
/// while residual, whitenedResidual and residuals know nothing of losses. Measurement functions are called from several
/// threads at once (setThreads changes that), so they must not write to shared data.
/// Faults of the caller are exceptions (mtk::Error, with a stable id); after any exception the estimator is as it was
/// before the call, but for steps of an optimisation that had been completed.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/analyze/derivative_check.hpp"
#include "slom/analyze/diagnosis.hpp"
#include "slom/analyze/intervals.hpp"
#include "slom/analyze/outliers.hpp"
#include "slom/analyze/preflight.hpp"
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
class Clustered;
class GaussianPrior;
struct ClusterOptions;
struct VarianceComponents;
struct VarianceOptions;

namespace detail {

[[noreturn]] void raiseMovedFrom();

template <class T>
using VariableType = std::conditional_t<std::is_integral_v<T>, double, PlainValue<T>>;

}  // namespace detail

/// What Estimator::marginalize leaves.
struct MarginalizeOptions {
  /// Whether the priors keep the linearisation points of their variables for all measurements of them: first-estimate Jacobians, so that
  /// motions that no measurement sees stay free (docs/online.md, windows).
  bool first_estimates = false;
};

/// Variables, measurements and the fit of the former to the latter. Movable; copied by clone() alone.
class Estimator {
 public:
  Estimator();
  ~Estimator();
  /// What was moved from holds nothing: all its functions throw [slom.moved-from] until another estimator is assigned to it.
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  /// A deep copy: variables, measurements, what is fixed or bounded, groups, losses, noise, algorithm, solver and settings. From then on the two
  /// are independent, but for what functions of measurements hold by reference or by a pointer, std::shared_ptr included: that is
  /// shared. The copy fits as the original would; its first update() begins anew. It accepts the handles that the original had
  /// when it was copied; `*id` of them still reads the original, `*copy.own(id)` the copy. Throws [slom.not-copyable] for
  /// measurements or solvers that cannot be copied.
  Estimator clone() const;
  /// The handle of this estimator for one of the estimator that it is a clone of; its own handles as they are. Throws [slom.stale-handle] and
  /// [slom.foreign-handle].
  template <class T>
  VarID<T> own(const VarID<T>& id) const {
    return problem().own(id);
  }
  template <class M>
  MeasID<M> own(const MeasID<M>& id) const {
    return problem().own(id);
  }
  AnyMeasID own(const AnyMeasID& id) const { return problem().own(id); }

  // Variables.

  /// Adds a variable with its start value. `optimize` false: it keeps that value. `name` is for messages.
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
  /// The name that the paper's outlook gives to insertRV.
  template <class T, class... More>
  auto registerRV(const T& value, More&&... more) {
    return insertRV(value, std::forward<More>(more)...);
  }
  /// Gives a variable another value, as a new start or when it is fixed.
  template <class T>
  void reinitRV(const VarID<T>& id, const std::type_identity_t<T>& value) {
    problem().setValue(id, value);
  }
  /// Fixes a variable at its current value, or releases it.
  template <class T>
  void optimizeRV(const VarID<T>& id, bool optimize) {
    problem().setOptimized(problem().indexOf(id), optimize);
  }
  // Parts of variables. A path names a component or all below it, as messages do: "pos.z", "pos". Paths that lead nowhere
  // throw [slom.no-component], which lists those that there are.

  /// Fixes a variable, as optimizeRV(id, false) does.
  template <class T>
  void fix(const VarID<T>& id) {
    optimizeRV(id, false);
  }
  /// Fixes components at their current values. They are not unknowns and have covariance 0.
  template <class T>
  void fix(const VarID<T>& id, const std::string& path) {
    setFixed(id, path, true);
  }
  /// The same with a name that the compiler checks: `est.fix(&Camera::k3, cam)`.
  template <class M, class C, std::derived_from<C> T>
  void fix(M C::*member, const VarID<T>& id) {
    setFixed(member, id, true);
  }
  /// Releases a variable with all of its components.
  template <class T>
  void free(const VarID<T>& id) {
    const int variable = problem().indexOf(id);
    problem().setOptimized(variable, true);
    setFixed(variable, 0, problem().variables()[static_cast<std::size_t>(variable)].dof, false);
  }
  /// Releases components that were fixed.
  template <class T>
  void free(const VarID<T>& id, const std::string& path) {
    setFixed(id, path, false);
  }
  template <class M, class C, std::derived_from<C> T>
  void free(M C::*member, const VarID<T>& id) {
    setFixed(member, id, false);
  }
  /// Keeps the coordinates of components of vectors within [lower, upper]; infinite limits take the bound back. The fit holds
  /// a component that wants to go beyond at the limit (an active set: Nocedal and Wright, "Numerical optimization", 2006,
  /// section 16.7); the summary lists those, and covariances hold on the condition that they are there. Throws
  /// [slom.bad-bound], or [slom.outside-bound] when the current value is.
  template <class T>
  void bound(const VarID<T>& id, const std::string& path, double lower, double upper) {
    bound(problem().indexOf(id), path, lower, upper);
  }
  /// Bounds every component of a variable, each of which must be a coordinate of a vector.
  template <class T>
  void bound(const VarID<T>& id, double lower, double upper) {
    bound(problem().indexOf(id), "", lower, upper);
  }
  /// Adds what is known of a variable beforehand: a measurement x [-] value, with a standard deviation or another
  /// uncertainty; removeMeasurement takes it back.
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
  /// The same of a component that is a coordinate, by its path: `est.prior(pose, "pos.z", 1.2, 0.05)`; or, with a vector, of all below a
  /// path: `est.prior(pose, "pos", Eigen::Vector3d(0, 0, 1.2), 0.05)`. Throws [slom.no-component], which lists the paths that there are,
  /// and for parts of rotations and the like, which have no coordinates; [slom.wrong-length] or [slom.prior-not-finite].
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

  /// Removes a variable. Throws [slom.variable-in-use], saying by how many measurements, while there are any.
  template <class T>
  void removeRV(const VarID<T>& id) {
    problem().removeVariable(problem().indexOf(id));
  }
  /// The name given at insertion, or one made of type and running number.
  template <class T>
  std::string nameOf(const VarID<T>& id) const {
    return problem().variableName(problem().indexOf(id));
  }

  // Measurements.

  /// Adds a measurement declared by SLOM_BUILD_MEASUREMENT, or one of a kind that chooses its variables at run time, as
  /// GaussianPrior. Options, in any order: its uncertainty (none: unit covariance), its loss (none: least squares),
  /// slom::named("label"), and slom::group(key) for errors that measurements share (slom/model/group.hpp).
  template <class M, class... Options>
    requires(Measurement<M> || std::derived_from<M, RuntimeMeasurement>)
  MeasID<M> insertMeasurement(M measurement, const Options&... options) {
    static_assert(
        (detail::is_option<Options> && ...),
        "slom: what follows the measurement says how uncertain it is (Covariance, StandardDeviation, "
        "InvCovariance or InvStandardDeviation), which loss it has (Huber, ...) or how it is called "
        "(slom::named)");
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
  /// Adds a measurement whose residual is what `f` returns. VarID arguments become variables (f gets a const T&),
  /// everything else is data, stored by value; options as above. With slom::measured(z) among the arguments f predicts
  /// the datum, and the residual is f(Y) [-] z. Derivatives are exact where f accepts numbers of other types (`const
  /// auto&`), f's own where it has a member `jacobian`, and otherwise central differences.
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
  /// Adds a measurement over a list of variables of any number and types: `f` gets a std::span<const VariableView>, the data and
  /// options are as above. Derivatives are central differences.
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
  /// The name that the paper's outlook gives to insertMeasurement.
  template <class F, class... Args>
  auto registerMeasurement(F f, const Args&... args) {
    return insertMeasurement(std::move(f), args...);
  }
  // The functions that take a MeasurementHandle take a MeasID or an AnyMeasID. They throw [slom.stale-handle].

  /// Puts a measurement that is there already into a group, instead of one of the same dimension that it was in.
  void setGroup(const MeasurementHandle& id, const Group& group);
  /// Removes a measurement: `est.removeMeasurement(est.outliers().ranking().front().id)`.
  void removeMeasurement(const MeasurementHandle& id);
  /// The name that messages and reports give it: `Gravity #12`, its label or type and its running number there.
  std::string nameOf(const MeasurementHandle& id) const;

  /// Forgets variables without losing what their measurements say of others: these measurements, linearised at the current values, are
  /// replaced by GaussianPriors on the variables that they share with the rest of the problem, and the variables are removed. Any set of
  /// them will do; one prior for each set of variables that remains in touch. Steps of a linear problem do not notice; of others they
  /// no longer notice what has changed since, so marginalise where the fit has converged. A handle that is there twice counts once.
  /// Losses enter by their weights at the current values, fixed variables and components as known. The RSS falls by what no value
  /// of the remaining variables could explain, and the number of residuals by those that it consisted of. Throws
  /// [slom.stale-handle], [slom.foreign-handle], [slom.not-finite] or [slom.measurement-threw], with nothing changed. The priors are in a
  /// group (slom::group) where all the measurements that this call replaces are in it.
  /// With first estimates the Jacobians of all measurements of the remaining variables are from then on those at the values that these
  /// have now, as long as a prior that this leaves depends on them.
  ///   source   Sibley, Matthies, Sukhatme, "Sliding window filter with application to planetary landing", 2010
  std::vector<MeasID<GaussianPrior>> marginalize(const std::vector<AnyVarID>& ids,
                                                 const MarginalizeOptions& options = {});

  // Optimisation.

  /// One step of the algorithm. What it returns converts to the relative gain (old RSS - new RSS) / old RSS; negative when a
  /// Gauss-Newton step led uphill. Throws [slom.rank-deficient], [slom.unmeasured-variable] or [slom.not-finite] with the values
  /// unchanged.
  StepRecord optimizeStep();
  /// Steps until the fit has converged or cannot go on; the summary says what happened. Numerical failure is not an
  /// exception: look at `converged`, `stop_reason` and `message`. Where the fit has not converged the values are the best that it has
  /// seen; after `rank_deficient` they are those at which an unknown has no influence. Throws [slom.not-finite] or [slom.measurement-threw] where a
  /// measurement has a residual but no finite derivative, at the values that it was given or a step has led to, which stay.
  Summary optimize(const Options& options = {});
  /// For problems that grow while they are fitted: brings the values to the optimum after insertions, removals and other changes, in
  /// time in proportion to what these change. The optimum is that of optimize(), as long as the values do not lie in the valley of another
  /// one. May be mixed with optimizeStep() and optimize(). Throws [slom.bad-option], and [slom.not-finite] or [slom.measurement-threw] for
  /// measurements without a residual or a finite derivative at the values that they are inserted with, and without a derivative at those that a
  /// step has led to.
  UpdateSummary update(const UpdateOptions& options = {});

  /// Takes over `algorithm`: `est.changeAlgorithm(new SLOM::LevenbergMarquardt())`.
  void changeAlgorithm(Algorithm* algorithm);
  /// The same by value: `est.changeAlgorithm(slom::DogLeg())`.
  template <std::derived_from<Algorithm> A>
  void changeAlgorithm(const A& algorithm) {
    changeAlgorithm(new A(algorithm));
  }
  /// How linear systems are solved; the default is BlockSolver.
  void changeSolver(std::unique_ptr<LinearSolver> solver);
  /// Most threads that work for this estimator; 0 (default): as many as the machine has. Results do not depend on it, to
  /// the last bit.
  void setThreads(int threads);

  // Uncertainty and diagnostics.

  /// Sum of squared whitened residuals at the current values, for measurements with a loss of rho(|W r|^2).
  double getRSS() const;
  /// The RSS of all measurements of type M.
  template <class M>
    requires(Measurement<M> || std::derived_from<M, RuntimeMeasurement>)
  double getRSS() const {
    return rssOfPools(problem().template poolsOf<M>());
  }
  /// The RSS of one measurement.
  double getRSS(const MeasurementHandle& id) const;
  /// The RSS of all measurements that depend on a variable.
  template <class T>
  double getRSS(const VarID<T>& id) const {
    return rssOfVariable(problem().indexOf(id));
  }
  /// The weight that its loss gives a measurement: the factor rho'(|W r|^2) of its square, from 1 (full weight, as without a loss) down to 0.
  double weight(const MeasurementHandle& id) const;
  /// sqrt(RSS / M): near 1 when the stated uncertainties are right. 0 without measurements.
  double getRMS() const;
  /// Number of scalar residuals.
  int getM() const;
  /// Number of unknowns: degrees of freedom of all optimised variables but for fixed components. A component at a bound counts;
  /// Summary::unknowns leaves out those whose bound is active after a fit.
  int getN() const;

  /// The residual of a measurement in its own units, f(Y) [-] z.
  Eigen::VectorXd residual(const MeasurementHandle& id) const { return residualOf(id, false); }
  /// The residual in units of its standard deviation.
  Eigen::VectorXd whitenedResidual(const MeasurementHandle& id) const { return residualOf(id, true); }
  /// All whitened residuals: type by type in order of their first insertion.
  Eigen::VectorXd residuals() const {
    Eigen::VectorXd r(getM());
    writeResiduals(r.data());
    return r;
  }

  /// Covariance of a variable in its tangent space (dof x dof), or between two of them; it holds for the stated
  /// uncertainties and the linearisation at the current values, which a fit that has not converged leaves anywhere: look at
  /// Summary::converged first. With losses this is the linearisation that the fit
  /// uses, in which measurements count by their weight: near the optimum the inverse curvature of the robust cost.
  /// 0 for fixed variables. Throws [slom.free-gauge], which names the
  /// motions that are free, [slom.rank-deficient] or [slom.unmeasured-variable].
  template <class T>
  Eigen::MatrixXd covariance(const VarID<T>& id) const {
    return covariance(id, id);
  }
  template <class A, class B>
  Eigen::MatrixXd covariance(const VarID<A>& a, const VarID<B>& b) const {
    const int i = problem().indexOf(a), j = problem().indexOf(b);
    Eigen::MatrixXd block(dofOf(i), dofOf(j));
    writeCovariance(i, j, block.data());
    return block;
  }
  /// Covariance of several variables together, in their order: n x n, n the sum of their degrees of freedom. Throws as covariance does.
  template <class... T>
  Eigen::MatrixXd jointCovariance(const VarID<T>&... ids) const {
    const int variables[] = {problem().indexOf(ids)...};
    int n = 0;
    for (const int variable : variables) n += dofOf(variable);
    Eigen::MatrixXd C(n, n);
    writeJointCovariance(variables, static_cast<int>(sizeof...(T)), C.data());
    return C;
  }
  /// Standard deviation of each component.
  template <class T>
  Eigen::VectorXd standardDeviation(const VarID<T>& id) const {
    const int variable = problem().indexOf(id);
    Eigen::VectorXd result(dofOf(variable));
    writeDeviations(variable, result.data());
    return result;
  }
  /// The correlation of component i of a with component j of b, from -1 to 1; 0 where one is certain. dof_a x dof_b
  template <class A, class B>
  Eigen::MatrixXd correlation(const VarID<A>& a, const VarID<B>& b) const {
    const auto inverse = [](double s) { return s > 0 ? 1 / s : 0.0; };
    const Eigen::VectorXd scale_a = standardDeviation(a).unaryExpr(inverse),
                          scale_b = standardDeviation(b).unaryExpr(inverse);
    return scale_a.asDiagonal() * covariance(a, b) * scale_b.asDiagonal();
  }
  /// The same between updates, in time proportional to the path from the variables to the root of the elimination tree: little for new
  /// ones, however large the problem. Jacobians may be those of slightly earlier values, as they are in the factor of update(), so that
  /// it agrees with covariance() to about a hundredth. With Sigma::estimated the variance factor
  /// takes a linearisation of everything. Throws [slom.not-updated] where something has changed since the last update(),
  /// or optimize() took over in it, and [slom.rank-deficient].
  template <class T>
  Eigen::MatrixXd updatedCovariance(const VarID<T>& id) const {
    return updatedCovariance(id, id);
  }
  template <class A, class B>
  Eigen::MatrixXd updatedCovariance(const VarID<A>& a, const VarID<B>& b) const {
    const int i = problem().indexOf(a), j = problem().indexOf(b);
    Eigen::MatrixXd block(dofOf(i), dofOf(j));
    writeUpdatedCovariance(i, j, block.data());
    return block;
  }
  /// Covariances of all variables at once, by selected inversion of the factor: for many of them it is much faster than
  /// to ask for one after the other.
  Marginals marginals() const;
  /// The same between updates, from the factor of update(), like updatedCovariance(). What has certainly changed by no more than the share
  /// `tolerance` of itself since the last call is not computed again: each covariance C is returned with an error between
  /// -tolerance C and tolerance C, in the order of positive semidefinite matrices, so that no standard deviation is off by more than about
  /// tolerance / 2 of it. 0: each is computed that has changed. Throws [slom.not-updated] and [slom.rank-deficient]. Not const: it keeps parts of
  /// the inverse for the next call.
  Marginals updatedMarginals(double tolerance = 1e-3);
  /// Fills in the table of parameters of a fit with more than Options::most_parameters unknowns, so that report() and json() show all of
  /// them; without correlations. The values are the current ones, the summary that of the last fit. Does nothing where the table is
  /// there. Throws [slom.no-parameters] for a summary of another number of unknowns, and what covariance throws.
  void addParametersTo(Summary& summary) const;
  /// f(values of the variables) and its covariance to first order. f gets a const T& for each and returns a number, an
  /// Eigen vector or a manifold; its derivatives are found as those of measurements are.
  template <class F, class... T>
  auto propagate(const F& f, const VarID<T>&... ids) const {
    return propagate(f, jointCovariance(ids...), ids...);
  }
  /// The same for another joint covariance of these variables, such as that of Clustered::jointCovariance.
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
  /// Whether covariances and standard deviations trust the stated uncertainties (Sigma::known, the default) or only their
  /// ratios. Then they throw [slom.no-redundancy] without more residuals than unknowns.
  void setSigma(Sigma sigma);
  /// What setSigma has set.
  Sigma sigma() const;
  /// What fits and covariances are when a rigid motion or a scale of everything is free, or a shift of all of some numbers, as of heights:
  /// FreeGauge::inner_constraints fits a free network.
  void setFreeGauge(FreeGauge gauge);
  /// What setFreeGauge has set.
  FreeGauge freeGauge() const;

  /// The variable and measurement table: what there is, in which revision, and what has changed or moved since another one.
  const Problem& table() const { return problem(); }

  /// Names of the components, as messages give them.
  template <class T>
  std::vector<std::string> componentNames(const VarID<T>& id) const {
    return problem().componentNames(problem().indexOf(id));
  }

  /// Looks the problem over at the current values: its rank, and in the user's names what is not determined, what hardly,
  /// and what to do about it. Takes as long as 10 to 30 iterations of the fit (bench_growth) where all is determined, more where much is
  /// hardly so.
  Diagnosis diagnose() const;

  /// Before solving: evaluates every measurement once at the current values, compares derivatives of some of each group, counts
  /// residuals, and diagnoses the rest. Throws nothing for what it finds.
  Preflight preflight() const;
  /// The interval in which a component lies with this probability, by profile likelihood: at its ends the best fit of everything
  /// else is worse by the quantile of chi-square; with Sigma::estimated by the square of Student's quantile for the redundancy, times
  /// the variance factor (F(1, redundancy): Bates and Watts, "Nonlinear regression analysis", 1988, section 6.1). Where the RSS is not
  /// quadratic it says more than the standard deviation does. For coordinates of vectors; at the values of a fit, which come back afterwards. An end that is not reached within
  /// 1000 standard deviations is infinite. The interval ends at the component's bound, where the quantile is not reached before; of
  /// a component at its bound it is one-sided, from the bound inwards. A fixed component has no width. Throws [slom.not-a-minimum], [slom.bad-option], [slom.no-component] and
  /// what covariance throws.
  ///   source   Venzon and Moolgavkar, "A method for computing profile-likelihood-based confidence intervals", 1988
  template <class T>
  ProfileInterval profile(const VarID<T>& id, const std::string& path, double probability = 0.95) {
    return profile(problem().indexOf(id), path, probability, nullptr);
  }

  /// The interval of a variable with one component.
  template <class T>
  ProfileInterval profile(const VarID<T>& id, double probability = 0.95) {
    return profile(problem().indexOf(id), "", probability, nullptr);
  }
  /// The same for errors that measurements share: at the ends the best fit of everything else is worse by (t s / s_stated)^2, with the
  /// clustered standard deviation s, the stated one and Student's quantile t for the degrees of freedom of the former. Where the RSS is
  /// quadratic, that is Clustered::interval. As the values move, `clustered` answers no more afterwards, like all that was computed of them. Throws
  /// [slom.stale-clustered], [slom.no-clustered-deviation] and what profile throws.
  template <class T>
  ProfileInterval profile(const VarID<T>& id, const std::string& path, const Clustered& clustered,
                          double probability = 0.95) {
    return profile(problem().indexOf(id), path, probability, &clustered);
  }

  /// The intervals of all unknowns, each as profile gives it; of components that are no coordinates, from their standard deviations.
  /// Throws what profile throws.
  IntervalTable intervals(double probability = 0.95);
  /// The same for errors that measurements share, as profile with `clustered` gives them.
  IntervalTable intervals(const Clustered& clustered, double probability = 0.95);

  /// Tests each measurement against all others, at the values of the fit: studentised residual, redundancy, the probability of
  /// such a residual, and how far the fit would move without it. Throws as covariance does.
  OutlierReport outliers(const OutlierOptions& options = {}) const;

  /// Covariances for errors that measurements share within groups (slom::group, and other ways), at the values of the fit;
  /// slom/analyze/clustered.hpp. Throws [slom.no-groups], [slom.bad-group], [slom.too-few-groups], [slom.not-a-minimum] and what covariance throws.
  Clustered clustered() const;
  Clustered clustered(const ClusterOptions& options) const;

  /// How large the errors of each kind of measurement are, over what is stated, and those that groups of them share; at the values of the
  /// fit, which stay. slom/analyze/variance_components.hpp. Throws [slom.not-a-minimum], [slom.no-component], [slom.components-with-loss],
  /// [slom.no-groups], [slom.bad-group], [slom.bad-option] and what covariance throws.
  VarianceComponents varianceComponents() const;
  VarianceComponents varianceComponents(const VarianceOptions& options) const;
  /// Multiplies the stated standard deviations of each kind by its factor, for what is computed from here on; optimize() afterwards. Shared errors
  /// are left alone: a variable for each group, with a prior, takes them into the fit. Throws [slom.stale-components].
  void apply(const VarianceComponents& components);

  /// Compares the derivatives of all measurements, at the current values, with differences: for each group the worst
  /// entry by name, and a guess at the cause where it is wrong. Slow: for development.
  DerivativeCheck checkDerivatives() const;

  /// Optimised variables that no measurement depends on, a sentence for each.
  std::vector<std::string> warnings() const;

 private:
  friend class Archive;

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
    using M = CallableMeasurement<F, detail::PlainValue<decltype(detail::valueAt<I>(args))>...>;
    return problem().insertMeasurement(M(std::move(f), detail::valueAt<I>(args)...), noise, label, loss);
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

  template <class T>
  void setFixed(const VarID<T>& id, const std::string& path, bool is_fixed) {
    const int variable = problem().indexOf(id);
    problem().setFixed(variable, problem().componentsAt(variable, path), is_fixed);
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
  using HalfWidth = std::function<double(int component)>;
  HalfWidth halfWidth(int variable, double probability, const Clustered* clustered);
  ProfileInterval profile(int variable, int component, HalfWidth half_width);
  ProfileInterval profile(int variable, const std::string& path, double probability,
                          const Clustered* clustered);
  IntervalTable intervals(double probability, const Clustered* clustered);
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
  // Results pass the boundary of the compiled library as plain numbers: what Eigen's dynamic types allocate depends on the
  // compiler's options, which may be others there.
  void writeResidual(MeasurementPool& pool, int i, bool whitened, double* r) const;
  void writeResiduals(double* r) const;
  void writeJacobian(double* J) const;
  void writeUpdatedCovariance(int variable_a, int variable_b, double* block) const;
  /// The joint covariance of these variables.
  void writeJointCovariance(const int* variables, int count, double* out) const;
  void writeCovariance(int variable_a, int variable_b, double* block) const;
  void writeDeviations(int variable, double* deviations) const;

  struct State;
  detail::Pimpl<State, &detail::raiseMovedFrom> state_;
};

}  // namespace slom
