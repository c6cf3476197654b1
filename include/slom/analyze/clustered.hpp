/// How sure values are where measurements share errors: covariances whose errors may be dependent in any way within groups of
/// measurements, and are independent between groups.
///
///     est.insertMeasurement(f, pose, lens, slom::measured(z), slom::group("image", i));
///     ...
///     const slom::Clustered c = est.clustered({.by = {"image"}});
///     std::cout << c.standardDeviation(lens).transpose() << "\n";
///
/// The covariance is the sandwich H^-1 (sum_g s_g s_g^T) H^-1 with the scores s_g = J_g^T A_g r_g of the groups, whitened, and H = J^T J.
///   source   Liang and Zeger, "Longitudinal data analysis using generalized linear models", 1986; Bell and McCaffrey, "Bias reduction in
///            standard errors for linear regression with multi-stage samples", 2002; Cameron and Miller, "A practitioner's guide to
///            cluster-robust inference", 2015
/// docs/decisions/clustered_uncertainty.md has the formulas.
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

struct Summary;

/// How the residuals r_g of a group, which are smaller than the errors, are corrected; H_gg = J_g H^-1 J_g^T is the group's leverage.
enum class ClusterCorrection : std::uint8_t {
  cr0,  ///< not: variances are too small with few groups
  cr1,  ///< by the factor G / (G - 1) (N - 1) / (N - K) of all variances: G groups, N residuals, K unknowns
  cr2,  ///< (I - H_gg)^(-1/2) r_g: unbiased where the stated uncertainties hold after all
  cr3,  ///< sqrt((G - 1) / G) (I - H_gg)^-1 r_g: the jackknife, leaving out one group at a time; variances are too large rather than too small
  by_leverage,  ///< cr2, or cr3 if a component's standard deviation by cr3 is larger by more than a fifth, or is expected to be, as single groups
  ///< carry it
};

/// A measurement, as functions that form groups see it.
class ClusterItem {
 public:
  /// Measurement i of a pool. Made by the library.
  ClusterItem(const Problem& problem, const MeasurementPool& pool, int i)
      : problem_(problem), pool_(pool), i_(i) {}

  /// `Gravity #12`
  std::string name() const { return pool_.measurementName(i_); }
  /// What slom::named gave it; empty: nothing.
  const std::string& label() const { return pool_.label(); }
  /// Its key in a dimension, where that is a number.
  std::optional<std::int64_t> key(std::string_view dimension = {}) const;
  /// Whether the variable is one of the measurement's.
  bool dependsOn(const VariableHandle& id) const;

 private:
  const Problem& problem_;
  const MeasurementPool& pool_;
  int i_;
};

/// A way of grouping measurements.
class ClusterBy {
 public:
  /// The groups that slom::group("image", key) made.
  ClusterBy(const char* dimension) : name_(dimension) {}             // NOLINT(google-explicit-constructor)
  ClusterBy(std::string dimension) : name_(std::move(dimension)) {}  // NOLINT(google-explicit-constructor)

  /// What slom::named gave them; those without are in no group.
  static ClusterBy label();
  /// Measurements that depend on the same one of these variables; those that depend on none are in no group. Throws
  /// [slom.bad-group] at use, where one depends on several.
  template <class T>
  static ClusterBy variables(std::string name, const std::vector<VarID<T>>& ids) {
    return variables(std::move(name), std::vector<AnyVarID>(ids.begin(), ids.end()));
  }
  static ClusterBy variables(std::string name, std::vector<AnyVarID> ids);
  /// The same of all variables of type T.
  template <class T>
  static ClusterBy variablesOf() {
    ClusterBy by(typeName<T>());
    by.kind_ = Kind::type;
    by.is_of_type_ = &detail::holdsType<T>;
    return by;
  }
  /// Measurements for which f returns the same number; those without one are in no group.
  static ClusterBy function(std::string name,
                            std::function<std::optional<std::int64_t>(const ClusterItem&)> f);
  /// `length` keys of a dimension with numbers together, from multiples of it on: with keys that are times, windows of time.
  static ClusterBy blocks(std::string dimension, std::int64_t length);

  /// What the way of grouping is called in reports: that of the dimension, of the type, or as given.
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

/// Which measurements share errors, and how their residuals are corrected.
struct ClusterOptions {
  /// The ways of grouping. Errors may be dependent between measurements that are in one group by any of them: images, and corners of the
  /// board. Variances are at least those of each way alone. Empty: the groups made by slom::group without a name or, where there are none, those of its only name.
  ///   source   Cameron, Gelbach and Miller, "Robust inference with multiway clustering", 2011
  std::vector<ClusterBy> by{};
  /// cr2 is too small where the fit follows a group closely, as where one is much larger than the others: the default notices.
  ///   source   MacKinnon, Nielsen and Webb, "Cluster-robust inference: a guide to empirical practice", 2023, sections 3 and 7
  ClusterCorrection correction = ClusterCorrection::by_leverage;
  /// Groups of the first way follow each other, by number or as they came, and neighbours may share errors, too. From 32 groups on, blocks of
  /// 1, 2, 4, ... groups are taken together, until the variance no longer grows; up to 100 groups, what they contribute counts as an autoregressive
  /// series, if that gives the wider interval.
  ///   source   Flegal and Jones, "Batch means and spectral variance estimators in Markov chain Monte Carlo", 2010; Andrews and Monahan, "An
  ///            improved heteroskedasticity and autocorrelation consistent covariance matrix estimator", 1992
  bool ordered = false;
  /// change() and influence() are found by a fit without each group of the first way in place of one step, from the present values, and so are
  /// covariances by cr3, one way and not ordered. It takes as many fits as there are groups; the values are as before afterwards. Where losses, or what is not
  /// linear, matter within a group's influence, the step and the fits differ.
  bool refit = false;
  /// Columns of H^-1 that are computed at most to find leverages, where groups share unknowns that do not meet in them. Groups that need
  /// more are corrected as by cr1, and a note says so.
  int most_columns = 5000;
};

/// The test of a group.
struct ClusterCheck {
  std::string group;
  int measurements = 0;
  double statistic =
      0;  ///< how far the group pulls the values: chi-square distributed where its errors are independent, as stated
  int dof = 0;             ///< number of combinations of the values that it pulls at
  double probability = 1;  ///< of such a statistic or a larger one there
};

/// The tests of all groups, the least probable first. Where groups share errors, all of them pull more than is stated; then each is
/// compared with the others.
struct ClusterOutliers {
  /// A group and how it compares with the others.
  struct Group {
    ClusterCheck check;  ///< as stated uncertainties let expect it
    double probability =
        1;  ///< of such a statistic or a larger one, as stated or, with `is_relative`, among these groups
    bool is_suspect = false;
  };
  double significance = 0.01;  ///< the probability that one of the groups is a suspect where all are good
  double scale = 1;            ///< median over the groups of statistic over the median of its chi-square
  bool is_relative =
      false;  ///< groups pull more than is stated: of their medians more than half are above 1, by a sign test at 5 %
  std::vector<Group> groups;

  /// Number of suspects.
  int suspects() const;
  /// A table of the worst groups, suspects marked.
  std::string text(int most_groups = 10) const;
};

std::ostream& operator<<(std::ostream& os, const ClusterOutliers& outliers);

/// Clustered covariances. It computes when it is asked, and answers as long as its estimator lives and nothing of it has changed; after that
/// all functions throw [slom.stale-clustered].
class Clustered {
 public:
  /// dof x dof, in the tangent space; 0 for what is fixed or at an active bound. What measurements without a group contribute, and
  /// what a single group determines alone, as an image its pose, is taken as stated: see statedShare.
  template <class T>
  Eigen::MatrixXd covariance(const VarID<T>& id) const {
    return jointCovariance(id);
  }
  template <class A, class B>
  Eigen::MatrixXd covariance(const VarID<A>& a, const VarID<B>& b) const {
    if (indexOf(a) == indexOf(b)) return jointCovariance(a);
    const Eigen::MatrixXd joint = jointCovariance(a, b);
    const Eigen::Index n = mtk::dof(*a);
    return joint.topRightCorner(n, joint.cols() - n);
  }
  /// Covariance of several variables together, in their order.
  template <class... T>
  Eigen::MatrixXd jointCovariance(const VarID<T>&... ids) const {
    const int variables[] = {indexOf(ids)...};
    const Eigen::Index n = (Eigen::Index{0} + ... + mtk::dof(*ids));
    Eigen::MatrixXd C(n, n);
    writeCovariance(variables, static_cast<int>(sizeof...(T)), C.data());
    return C;
  }
  /// Standard deviation of each component.
  template <class T>
  Eigen::VectorXd standardDeviation(const VarID<T>& id) const {
    return detail::deviations(covariance(id));
  }
  /// The correlation of component i of a with component j of b; 0 where one is certain.
  template <class A, class B>
  Eigen::MatrixXd correlation(const VarID<A>& a, const VarID<B>& b) const {
    const auto inverse = [](double s) { return s > 0 ? 1 / s : 0.0; };
    const Eigen::VectorXd scale_a = standardDeviation(a).unaryExpr(inverse),
                          scale_b = standardDeviation(b).unaryExpr(inverse);
    return scale_a.asDiagonal() * covariance(a, b) * scale_b.asDiagonal();
  }
  /// Satterthwaite's degrees of freedom of the variance of each component: how much it is worth. Of several ways of grouping the
  /// smallest; infinite where the variance is as stated.
  ///   source   Bell and McCaffrey 2002, section 4
  template <class T>
  Eigen::VectorXd degreesOfFreedom(const VarID<T>& id) const {
    return perComponent(id, Kind::dof);
  }
  /// Half the width of the interval that holds each component with this probability, by Student's t.
  template <class T>
  Eigen::VectorXd interval(const VarID<T>& id, double probability = 0.95) const {
    return perComponent(id, Kind::interval, probability);
  }
  /// The share of each component's stated variance, 0 to 1, for which no other group vouches: it comes from measurements without a group,
  /// or is determined by one group alone. That part of the clustered variance is the stated one, too small where those errors are
  /// dependent.
  template <class T>
  Eigen::VectorXd statedShare(const VarID<T>& id) const {
    return perComponent(id, Kind::stated_share);
  }
  /// Number of successive groups that are taken together for this variable; 1 unless ClusterOptions::ordered.
  template <class T>
  int blockLength(const VarID<T>& id) const {
    return blockLengthOf(indexOf(id));
  }
  /// By how much the fit moves each component when a group of the first way is left out, groups x dof, in one step from the factor, which
  /// is exact for linear problems, or by ClusterOptions::refit; NaN where the others do not determine it.
  template <class T>
  Eigen::MatrixXd change(const VarID<T>& id) const {
    return influences(id, false);
  }
  /// The same over the component's standard deviation.
  template <class T>
  Eigen::MatrixXd influence(const VarID<T>& id) const {
    return influences(id, true);
  }
  /// Names of the groups of the first way, `image 17`, in the order of the rows above.
  std::vector<std::string> groups() const;
  /// Whether each of them pulls the values more than its stated uncertainties allow, in the order of groups().
  std::vector<ClusterCheck> check() const;
  /// The same tests as a report that names suspects: groups that pull the values more than the others do. Throws [slom.bad-option].
  ClusterOutliers outliers(double significance = 0.01) const;
  /// Fills in the clustered standard deviations and degrees of freedom of the summary's parameters, and the notes, so that its report has a
  /// column of them. Throws [slom.no-parameters] where the summary has no such parameters.
  void addTo(Summary& summary) const;
  /// The first unknowns, as many as that: value, stated and clustered standard deviation, degrees of freedom; and the notes on them.
  std::string report(int most_unknowns = 40) const;
  /// Sentences on what limits these numbers: few groups, measurements without one, ...
  std::vector<std::string> notes() const;
  /// The same with those on this variable: what of its variance is as stated, or too small.
  template <class T>
  std::vector<std::string> notes(const VarID<T>& id) const {
    return notesOn({indexOf(id)});
  }

  struct State;
  /// Made by Estimator::clustered.
  explicit Clustered(std::shared_ptr<State> state) : state_(std::move(state)) {}

 private:
  friend class Estimator;
  enum class Kind : std::uint8_t { dof, interval, stated_share };

  template <class T>
  Eigen::VectorXd perComponent(const VarID<T>& id, Kind kind, double probability = 0) const {
    Eigen::VectorXd result(mtk::dof(*id));
    writePerComponent(indexOf(id), kind, probability, result.data());
    return result;
  }
  template <class T>
  Eigen::MatrixXd influences(const VarID<T>& id, bool in_deviations) const {
    const int variable = indexOf(id);
    Eigen::MatrixXd result(groupCount(), mtk::dof(*id));
    writeInfluences(variable, in_deviations, result.data());
    return result;
  }
  template <class T>
  int indexOf(const VarID<T>& id) const {
    return problem().indexOf(id);
  }
  // Plain numbers, as of Estimator: Eigen's dynamic types may be allocated otherwise in the compiled library.
  const Problem& problem() const;
  int groupCount() const;
  std::vector<std::string> notesOn(const std::vector<int>& variables) const;
  int blockLengthOf(int variable) const;
  void writeCovariance(const int* variables, int count, double* out) const;
  void writePerComponent(int variable, Kind kind, double probability, double* out) const;
  void writeInfluences(int variable, bool in_deviations, double* out) const;

  std::shared_ptr<State> state_;
};

}  // namespace slom
