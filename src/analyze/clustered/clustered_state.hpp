/// State of a Clustered: the linearised problem, the groups, and results computed so far.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "analyze/clustered/cluster_scores.hpp"
#include "analyze/clustered/group_refits.hpp"
#include "analyze/robust_curvature.hpp"

namespace slom {

struct [[gnu::visibility("hidden")]] Clustered::State {  // declared in a public header, not exported
  static constexpr int kFewestInSeries = 6;  // groups needed to see whether neighbours share errors

  /// Throws [slom.no-groups], [slom.bad-group], [slom.too-few-groups] or [slom.bad-option].
  State(const std::shared_ptr<const LinearizedProblem>& linearized, FreeGauge gauge, double variance_factor,
        ClusterOptions options);
  /// Returns the first way of grouping. Throws as the constructor does.
  static Clustering firstWay(const Problem& problem, const ClusterOptions& options);

  /// One summand of the inclusion and exclusion over several ways.
  struct Term {
    ClusterScores scores;
    double sign;
    bool is_single;  // a single way, not an intersection
  };
  /// Scores with 2^level successive groups of the first way joined.
  struct Level {
    std::vector<Term> terms;  // the term of the first way comes first
  };
  /// Number of groups joined for a variable.
  struct Choice {
    int level = 0;
    Eigen::VectorXd deviation, dof;  // if groups are ordered
    Eigen::VectorXd correlation;     // of successive groups
    bool levels_off = true;
  };
  struct Covariance {
    Eigen::MatrixXd C;
    Eigen::VectorXd stated_share;
    bool was_indefinite = false;
    bool was_smaller = false;  // than by one way alone, whose variance is taken
    // By component: the group that dominates it, if cr3 replaced cr2; otherwise empty.
    std::vector<std::string> carriers;
  };

  /// Returns the problem. Throws [slom.stale-clustered].
  const LinearizedProblem& problem() const;
  const Level& level(int l);
  int levelCount() const;
  void chooseBlocks(int variable, Choice& choice);
  void chooseAutoregression(int variable, Choice& choice);
  /// Returns columns of H^-1, or of its replacement for a robust cost, unknowns x dof. Rows of fixed components and of
  /// components at an active bound are 0.
  Eigen::MatrixXd columns(int variable);
  Covariance covarianceAt(int l, const std::vector<int>& variables);
  /// Returns the scores that choose the correction of term k at level l.
  const ClusterScores& scoresOfGroups(int l, std::size_t k);
  /// Returns one correction for all columns of Z, so that relations between entries of the covariance hold, as in a
  /// free network. If the user chose a correction, returns that one. By leverage, it is cr2, or cr3 if that makes one
  /// of the standard deviations more than 20 % larger (50 % if groups are ordered). `carriers` receives the group that
  /// contributes most to each such column.
  ClusterCorrection correctionFor(const ClusterScores& scores, const Eigen::MatrixXd& Z,
                                  std::vector<std::string>* carriers) const;
  Covariance covariance(const std::vector<int>& variables);
  /// Returns the columns of GroupRefits::change for these variables.
  Eigen::MatrixXd refitted(const std::vector<int>& variables) const;
  /// Returns whether groups are ordered and numerous enough to show whether neighbours share errors.
  bool isSeries() const;
  const Choice& choice(int variable);
  Eigen::VectorXd degreesOfFreedom(int variable, int l);
  std::vector<std::string> notes() const;

  std::weak_ptr<const LinearizedProblem> linearized;
  FreeGauge gauge;
  double variance_factor;
  ClusterOptions options;
  std::vector<Clustering> ways;
  std::vector<std::unique_ptr<Level>> levels;
  std::map<int, Choice> choices;                        // for ordered groups, by variable
  std::vector<std::pair<int, Eigen::MatrixXd>> recent;  // columns of the variables requested last
  std::optional<RobustCurvature> curvature;
  std::optional<GroupRefits> refits;  // for the first way
  bool is_convex = true;
};

}  // namespace slom
