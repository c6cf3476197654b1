/// What a Clustered computes with: the linearised problem, the groups, and what has been computed already.
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
  static constexpr int kFewestInSeries = 6;              // groups, to see whether neighbours share errors

  /// Throws [slom.no-groups], [slom.bad-group], [slom.too-few-groups] or [slom.bad-option].
  State(const std::shared_ptr<const LinearizedProblem>& linearized, FreeGauge gauge, double variance_factor,
        ClusterOptions options);
  /// The first way of grouping. Throws as the constructor.
  static Clustering firstWay(const Problem& problem, const ClusterOptions& options);

  /// One summand of the inclusion and exclusion over several ways.
  struct Term {
    ClusterScores scores;
    double sign;
    bool is_single;  // one way by itself
  };
  /// Scores with 2^level successive groups of the first way in one.
  struct Level {
    std::vector<Term> terms;  // that of the first way first
  };
  /// How many groups are taken together for a variable.
  struct Choice {
    int level = 0;
    Eigen::VectorXd deviation, dof;  // where they are ordered
    Eigen::VectorXd correlation;     // of successive groups
    bool levels_off = true;
  };
  struct Covariance {
    Eigen::MatrixXd C;
    Eigen::VectorXd stated_share;
    bool was_indefinite = false;
    bool was_smaller = false;  // than that by one way alone, which takes its place
    std::vector<std::string>
        carriers;  // by component: the group that carries it, where cr3 took the place of cr2; else empty
  };

  /// The problem; throws [slom.stale-clustered].
  const LinearizedProblem& problem() const;
  const Level& level(int l);
  int levelCount() const;
  void chooseBlocks(int variable, Choice& choice);
  void chooseAutoregression(int variable, Choice& choice);
  /// Columns of H^-1, or of what a robust cost has in its place; 0 for what is fixed or at an active bound. Unknowns x dof.
  Eigen::MatrixXd columns(int variable);
  Covariance covarianceAt(int l, const std::vector<int>& variables);
  /// The scores that the correction of term k at level l is chosen by.
  const ClusterScores& scoresOfGroups(int l, std::size_t k);
  /// The correction of columns Z together: cr2, or cr3 if the standard deviation of one of them is larger by more than a fifth; of a
  /// single matrix, so that what holds between its entries, as in a free network, stays. `carriers` gets the group that contributes most
  /// to each such column. What the user has chosen, if that is not by_leverage.
  ClusterCorrection correctionFor(const ClusterScores& scores, const Eigen::MatrixXd& Z,
                                  std::vector<std::string>* carriers) const;
  Covariance covariance(const std::vector<int>& variables);
  /// The columns of GroupRefits::change of these variables.
  Eigen::MatrixXd refitted(const std::vector<int>& variables) const;
  /// Whether groups follow each other, and are enough to see whether neighbours share errors.
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
  std::map<int, Choice> choices;                        // of ordered groups, by variable
  std::vector<std::pair<int, Eigen::MatrixXd>> recent;  // columns of the variables that were asked for last
  std::optional<RobustCurvature> curvature;
  std::optional<GroupRefits> refits;  // of the first way
  bool is_convex = true;
};

}  // namespace slom
