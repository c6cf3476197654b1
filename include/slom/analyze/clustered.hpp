/// Clustered: covariances for measurements that share errors. Errors within a group of measurements may depend on each
/// other in any way. Errors of different groups are independent.
///
///     est.insertMeasurement(f, pose, lens, slom::measured(z), slom::group("image", i));
///     ...
///     const slom::Clustered c = slom::clustered(est, {.by = {"image"}});
///     std::cout << c.standardDeviation(lens).transpose() << "\n";
///
/// The covariance is the sandwich H^-1 (sum_g s_g s_g^T) H^-1 with H = J^T J and the whitened scores s_g = J_g^T A_g
/// r_g of the groups. docs/decisions/clustered_uncertainty.md has the formulas.
///   source   Liang and Zeger, "Longitudinal data analysis using generalized linear models", 1986; Bell and McCaffrey,
///            "Bias reduction in standard errors for linear regression with multi-stage samples", 2002; Cameron and
///            Miller, "A practitioner's guide to cluster-robust inference", 2015
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "slom/analyze/uncertainty.hpp"
#include "slom/model/any_var_id.hpp"
#include "slom/problem/problem.hpp"

namespace slom {

class Estimator;
struct Summary;

namespace detail {
struct AnalysisAccess;
}

/// Correction of the residuals r_g of a group, which are smaller than its errors. H_gg = J_g H^-1 J_g^T is the leverage
/// of the group.
enum class ClusterCorrection : std::uint8_t {
  cr0,  ///< no correction: variances are too small with few groups
  cr1,  ///< factor G / (G - 1) (N - 1) / (N - K) on all variances: G groups, N residuals, K unknowns
  cr2,  ///< (I - H_gg)^(-1/2) r_g: unbiased if the stated uncertainties are right
  /// sqrt((G - 1) / G) (I - H_gg)^-1 r_g: the jackknife, leaving out one group at a time. Variances tend to be too
  /// large, not too small.
  cr3,
  /// cr2, or cr3 if it makes the standard deviation of a component more than 20 % larger (50 % for ordered groups), or is
  /// expected to, because single groups dominate that component.
  by_leverage,
};

/// A measurement for functions that form groups.
class ClusterItem {
 public:
  /// Refers to measurement i of a pool. Only the library creates such items.
  ClusterItem(const Problem& problem, const MeasurementPool& pool, int i)
      : problem_(problem), pool_(pool), i_(i) {}

  /// Returns the name, such as `Gravity #12`.
  std::string name() const { return pool_.measurementName(i_); }
  /// Returns the label given by slom::named; empty if there is none.
  const std::string& label() const { return pool_.label(); }
  /// Returns the measurement's key in a dimension, if that is a number.
  std::optional<std::int64_t> key(std::string_view dimension = {}) const;
  /// Returns whether the measurement depends on the variable.
  bool dependsOn(const VariableHandle& id) const;

 private:
  const Problem& problem_;
  const MeasurementPool& pool_;
  int i_;
};

/// A way of grouping measurements.
class ClusterBy {
 public:
  /// Groups measurements by the keys of slom::group("image", key).
  ClusterBy(const char* dimension) : name_(dimension) {}             // NOLINT(google-explicit-constructor)
  ClusterBy(std::string dimension) : name_(std::move(dimension)) {}  // NOLINT(google-explicit-constructor)

  /// Groups measurements by the label given by slom::named. Measurements without a label are in no group.
  static ClusterBy label();
  /// Groups measurements that depend on the same one of these variables. Measurements that depend on none of them are
  /// in no group. If one depends on several, using the grouping throws [slom.bad-group].
  template <class T>
  static ClusterBy variables(std::string name, const std::vector<VarID<T>>& ids) {
    return variables(std::move(name), std::vector<AnyVarID>(ids.begin(), ids.end()));
  }
  static ClusterBy variables(std::string name, std::vector<AnyVarID> ids);
  /// Groups measurements by variables of type T.
  template <class T>
  static ClusterBy variablesOf() {
    ClusterBy by(typeName<T>());
    by.kind_ = Kind::type;
    by.is_of_type_ = &detail::holdsType<T>;
    return by;
  }
  /// Groups measurements for which f returns the same number. Measurements for which f returns none are in no group.
  static ClusterBy function(std::string name,
                            std::function<std::optional<std::int64_t>(const ClusterItem&)> f);
  /// Joins `length` consecutive keys of a dimension with numbers, from multiples of `length` on. If the keys are times,
  /// the groups are windows of time.
  static ClusterBy blocks(std::string dimension, std::int64_t length);

  /// Returns the name of the grouping in reports: the given name, or the name of the dimension or type.
  const std::string& name() const { return name_; }

 private:
  friend class ClusterMaker;
  enum class Kind : std::uint8_t { dimension, label, variables, type, function };
  Kind kind_ = Kind::dimension;
  std::string name_;
  std::vector<AnyVarID> ids_;
  bool (*is_of_type_)(const VariableStoreBase*) = nullptr;
  std::function<std::optional<std::int64_t>(const ClusterItem&)> function_;
};

/// Options: which measurements share errors, and how residuals are corrected.
struct ClusterOptions {
  /// The ways of grouping, such as images and corners of the board. Errors of two measurements may be dependent if any
  /// of the ways puts them into one group. Variances are at least as large as for each way alone. Empty: the groups
  /// made by slom::group without a name or, if there are none, the groups of its only name.
  ///   source   Cameron, Gelbach and Miller, "Robust inference with multiway clustering", 2011
  std::vector<ClusterBy> by{};
  /// Correction of residuals. cr2 is too small if the fit follows a group closely, for example a group much larger than
  /// the others. The default detects that.
  ///   source   MacKinnon, Nielsen and Webb, "Cluster-robust inference: a guide to empirical practice", 2023,
  ///            sections 3 and 7
  ClusterCorrection correction = ClusterCorrection::by_leverage;
  /// If true, groups of the first way are a sequence, by number or in order of insertion, and neighbours may share
  /// errors too. From 32 groups on, blocks of 1, 2, 4, ... groups are joined until the variance no longer grows. Up to
  /// 100 groups, the contributions of the groups are also treated as an autoregressive series, and the wider interval
  /// counts.
  ///   source   Flegal and Jones, "Batch means and spectral variance estimators in Markov chain Monte Carlo", 2010;
  ///            Andrews and Monahan, "An improved heteroskedasticity and autocorrelation consistent covariance matrix
  ///            estimator", 1992
  bool ordered = false;
  /// If true, change() and influence() come from a fit without each group of the first way, started at the present
  /// values, instead of one step. So do covariances by cr3 with one way that is not ordered. This takes as many fits as
  /// there are groups; the values are restored afterwards. Step and fits differ if losses or nonlinearity matter within
  /// the influence of a group.
  bool refit = false;
  /// Maximum number of columns of H^-1 that are computed for leverages. They are needed if selected inversion lacks
  /// blocks of the unknowns that a group shares with others. Groups that need more columns are corrected as by cr1,
  /// and a note says so.
  int most_columns = 5000;
};

/// The test of a group.
struct ClusterCheck {
  std::string group;
  int measurements = 0;
  /// Pull of the group on the values. If the errors of the group are independent, as stated, it has a chi-square
  /// distribution.
  double statistic = 0;
  int dof = 0;             ///< number of combinations of the values that the group pulls at
  double probability = 1;  ///< of a statistic at least as large, for such errors
};

/// The tests of all groups, the least probable first. If groups share errors, all of them pull more than stated; then
/// each group is compared with the others.
struct ClusterOutliers {
  /// A group and its comparison with the others.
  struct Group {
    ClusterCheck check;  ///< test against the stated uncertainties
    /// p-value of the statistic: as stated or, with `is_relative`, among these groups.
    double probability = 1;
    bool is_suspect = false;
  };
  double significance = 0.01;  ///< probability that any group is a suspect if all are good
  double scale = 1;            ///< median over the groups of: statistic / median of its chi-square
  /// True if groups pull more than stated: more than half of these ratios are above 1, by a sign test at 5 %.
  bool is_relative = false;
  std::vector<Group> groups;

  /// Returns the number of suspects.
  int suspects() const;
  /// Returns a table of the worst groups with suspects marked.
  std::string text(int most_groups = 10) const;
};

std::ostream& operator<<(std::ostream& os, const ClusterOutliers& outliers);

/// Clustered covariances, computed on demand. An object is valid while its estimator lives and nothing in it changes.
/// Afterwards all functions throw [slom.stale-clustered].
class Clustered {
 public:
  /// Returns the covariance in the tangent space, dof x dof; 0 for components that are fixed or at an active bound.
  /// The contribution of measurements without a group is taken as stated. So is the contribution of directions that a
  /// single group determines alone, such as the pose of an image: see statedShare.
  template <AnyVariableHandle V>
  Eigen::MatrixXd covariance(const V& id) const {
    return jointCovariance(id);
  }
  template <AnyVariableHandle A, AnyVariableHandle B>
  Eigen::MatrixXd covariance(const A& a, const B& b) const {
    if (indexOf(a) == indexOf(b)) return jointCovariance(a);
    const Eigen::MatrixXd joint = jointCovariance(a, b);
    const int n = dofOf(indexOf(a));
    return joint.topRightCorner(n, joint.cols() - n);
  }
  /// Returns the joint covariance of several variables in the given order.
  template <AnyVariableHandle... V>
  Eigen::MatrixXd jointCovariance(const V&... ids) const {
    const int variables[] = {indexOf(ids)...};
    int n = 0;
    for (const int variable : variables) n += dofOf(variable);
    Eigen::MatrixXd C(n, n);
    writeCovariance(variables, static_cast<int>(sizeof...(V)), C.data());
    return C;
  }
  /// Returns the standard deviation of each component.
  template <AnyVariableHandle V>
  Eigen::VectorXd standardDeviation(const V& id) const {
    return detail::deviations(covariance(id));
  }
  /// Returns the correlation of component i of a with component j of b; 0 if one of them has variance 0.
  template <AnyVariableHandle A, AnyVariableHandle B>
  Eigen::MatrixXd correlation(const A& a, const B& b) const {
    const auto inverse = [](double s) { return s > 0 ? 1 / s : 0.0; };
    const Eigen::VectorXd scale_a = standardDeviation(a).unaryExpr(inverse),
                          scale_b = standardDeviation(b).unaryExpr(inverse);
    return scale_a.asDiagonal() * covariance(a, b) * scale_b.asDiagonal();
  }
  /// Returns Satterthwaite's degrees of freedom of the variance of each component, which measure its reliability. With
  /// several ways of grouping, the smallest counts. Infinite if the variance is the stated one.
  ///   source   Bell and McCaffrey 2002, section 4
  template <AnyVariableHandle V>
  Eigen::VectorXd degreesOfFreedom(const V& id) const {
    return perComponent(id, Kind::dof);
  }
  /// Returns half the width of the interval that contains each component with this probability, by Student's t.
  template <AnyVariableHandle V>
  Eigen::VectorXd interval(const V& id, double probability = 0.95) const {
    return perComponent(id, Kind::interval, probability);
  }
  /// Returns the fraction, 0 to 1, of each component's stated variance that no other group confirms. It comes from
  /// measurements without a group, or one group alone determines it. This part of the clustered variance is the stated
  /// one, and too small if those errors are dependent.
  template <AnyVariableHandle V>
  Eigen::VectorXd statedShare(const V& id) const {
    return perComponent(id, Kind::stated_share);
  }
  /// Returns the number of successive groups that are joined for this variable; 1 unless ClusterOptions::ordered.
  template <AnyVariableHandle V>
  int blockLength(const V& id) const {
    return blockLengthOf(indexOf(id));
  }
  /// Returns how much each component moves if a group of the first way is left out: groups x dof. The move is one step
  /// from the factor, which is exact for linear problems, or a fit with ClusterOptions::refit. NaN if the other groups
  /// do not determine the component.
  template <AnyVariableHandle V>
  Eigen::MatrixXd change(const V& id) const {
    return influences(id, false);
  }
  /// Returns change(), divided by the standard deviation of each component.
  template <AnyVariableHandle V>
  Eigen::MatrixXd influence(const V& id) const {
    return influences(id, true);
  }
  /// Returns the names of the groups of the first way, such as `image 17`, in the order of the rows of change().
  std::vector<std::string> groups() const;
  /// Tests for each group whether it pulls the values more than its stated uncertainties allow. Order as in groups().
  std::vector<ClusterCheck> check() const;
  /// Returns these tests as a report of suspects: groups that pull the values more than the others do. Throws
  /// [slom.bad-option].
  ClusterOutliers outliers(double significance = 0.01) const;
  /// Adds the clustered standard deviations, their degrees of freedom and the notes to the summary's parameters. Its
  /// report then has a column for them. Throws [slom.no-parameters] if the summary has no such parameters.
  void addTo(Summary& summary) const;
  /// Returns a table of the first `most_unknowns` unknowns with value, stated and clustered standard deviation and
  /// degrees of freedom, and the notes on them.
  std::string report(int most_unknowns = 40) const;
  /// Returns sentences on the limits of these numbers: few groups, measurements without a group, ...
  std::vector<std::string> notes() const;
  /// Returns the general notes and those on this variable: which part of its variance is the stated one, or too small.
  template <AnyVariableHandle V>
  std::vector<std::string> notes(const V& id) const {
    return notesOn({indexOf(id)});
  }

  struct State;
  /// Called by slom::clustered.
  explicit Clustered(std::shared_ptr<State> state) : state_(std::move(state)) {}

 private:
  friend struct detail::AnalysisAccess;
  enum class Kind : std::uint8_t { dof, interval, stated_share };

  template <AnyVariableHandle V>
  Eigen::VectorXd perComponent(const V& id, Kind kind, double probability = 0) const {
    const int variable = indexOf(id);
    Eigen::VectorXd result(dofOf(variable));
    writePerComponent(variable, kind, probability, result.data());
    return result;
  }
  template <AnyVariableHandle V>
  Eigen::MatrixXd influences(const V& id, bool in_deviations) const {
    const int variable = indexOf(id);
    Eigen::MatrixXd result(groupCount(), dofOf(variable));
    writeInfluences(variable, in_deviations, result.data());
    return result;
  }
  template <AnyVariableHandle V>
  int indexOf(const V& id) const {
    return problem().indexOf(id);
  }
  int dofOf(int variable) const { return problem().variables()[static_cast<std::size_t>(variable)].dof; }
  // Results are plain numbers, as in Estimator: Eigen's dynamic types may be allocated otherwise in the compiled
  // library.
  const Problem& problem() const;
  int groupCount() const;
  std::vector<std::string> notesOn(const std::vector<int>& variables) const;
  int blockLengthOf(int variable) const;
  void writeCovariance(const int* variables, int count, double* out) const;
  void writePerComponent(int variable, Kind kind, double probability, double* out) const;
  void writeInfluences(int variable, bool in_deviations, double* out) const;

  std::shared_ptr<State> state_;
};

/// Prints report().
std::ostream& operator<<(std::ostream& os, const Clustered& clustered);

/// Returns covariances for errors that measurements share within groups (slom::group and other ways), at the values of
/// the fit. Throws [slom.no-groups], [slom.bad-group], [slom.too-few-groups], [slom.not-a-minimum] and as
/// Estimator::covariance does.
Clustered clustered(const Estimator& est);
Clustered clustered(const Estimator& est, const ClusterOptions& options);

}  // namespace slom
