#include "slom/analyze/clustered.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <ostream>

#include "analyze/clustered/clustered_state.hpp"
#include "base/classic_numbers.hpp"
#include "base/index.hpp"
#include "base/words.hpp"
#include "slom/analyze/chi_square.hpp"
#include "slom/analyze/student.hpp"

namespace slom {

namespace {
constexpr double kSaidShare = 0.01;   // fraction of the stated variance from which on a note reports it
constexpr double kWorthLittle = 10;   // number of independent groups below which a note is given
constexpr double kAloneShare = 1e-6;  // fraction of a stated variance determined by one group alone

/// Sentences about variables whose variance is partly taken as stated, or too small.
class VariableNotes {
 public:
  void add(Clustered::State& state, int variable, const Clustered::State::Covariance& covariance) {
    const Problem& problem = state.problem().problem();
    const std::vector<std::string> components = problem.componentNames(variable);
    const std::string name = problem.variableName(variable);
    for (Eigen::Index i = 0; i < covariance.stated_share.size(); ++i) {
      const double share = covariance.stated_share[i];
      if (share > kSaidShare)
        stated_.push_back(components[static_cast<std::size_t>(i)] + " " + number(100 * share, 2) + " %");
    }
    for (std::size_t i = 0; i < covariance.carriers.size(); ++i) {
      if (!covariance.carriers[i].empty())
        carried_.push_back(components[i] + " (" + covariance.carriers[i] + ")");
    }
    if (covariance.was_indefinite) indefinite_.push_back(name);
    if (covariance.was_smaller) smaller_.push_back(name);
    if (!state.isSeries()) return;
    addWorth(state, components, state.choice(variable).correlation);
    if (!state.choice(variable).levels_off)
      growing_.push_back(name + " with blocks of " + std::to_string(1 << state.choice(variable).level) +
                         " groups");
  }
  /// Returns `notes`, followed by the notes on variables.
  std::vector<std::string> after(std::vector<std::string> notes) const {
    const auto say = [&](const char* sentence, const std::vector<std::string>& of) {
      if (!of.empty()) notes.push_back(sentence + listed(of, 8));
    };
    say("a part of the variance comes from one group alone, or from measurements without a group; this part "
        "is taken as stated: ",
        stated_);
    say("one group (in brackets) determines most of a value, whose standard deviation is therefore by cr3: ",
        carried_);
    say("the covariance by several groupings had negative eigenvalues, which count as 0: ", indefinite_);
    say("one grouping alone gave a larger variance than all groupings together, and is taken: ", smaller_);
    say("the variance still grows at the longest blocks of which there are enough; errors are shared over "
        "longer series, for example by a drift, and the variance is extrapolated from the growth, which is rough: ",
        growing_);
    say("successive groups are so alike that together they count as fewer than 10 independent groups, and "
        "intervals hold less often than stated: ",
        alike_);
    return notes;
  }

 private:
  /// Reports components whose groups are worth few independent ones, because neighbours are correlated.
  void addWorth(const Clustered::State& state, const std::vector<std::string>& components,
                const Eigen::VectorXd& correlation) {
    for (Eigen::Index i = 0; i < correlation.size(); ++i) {
      const double rho = correlation[i], worth = state.ways[0].count() * (1 - rho) / (1 + rho);
      if (!(rho > 0 && worth < kWorthLittle)) continue;
      alike_.push_back(components[static_cast<std::size_t>(i)] + " (correlation " + number(rho, 2) + ")");
    }
  }

  std::vector<std::string> stated_, carried_, indefinite_, smaller_, growing_, alike_;
};

}  // namespace

const Problem& Clustered::problem() const { return state_->problem().problem(); }

int Clustered::groupCount() const { return state_->ways[0].count(); }

std::vector<std::string> Clustered::groups() const {
  static_cast<void>(problem());
  return state_->ways[0].names;
}

std::vector<std::string> Clustered::notes() const {
  static_cast<void>(problem());
  return state_->notes();
}

int Clustered::blockLengthOf(int variable) const {
  return state_->isSeries() ? 1 << state_->choice(variable).level : 1;
}

void Clustered::writeCovariance(const int* variables, int count, double* out) const {
  const Eigen::MatrixXd C = state_->covariance({variables, variables + count}).C;
  std::copy_n(C.data(), C.size(), out);
}

void Clustered::writePerComponent(int variable, Kind kind, double probability, double* out) const {
  Eigen::VectorXd result;
  if (kind == Kind::stated_share) {
    result = state_->covariance({variable}).stated_share;
  } else {
    result = state_->isSeries() ? state_->choice(variable).dof : state_->degreesOfFreedom(variable, 0);
  }
  if (kind == Kind::interval) {
    if (!(probability > 0 && probability < 1)) {
      throw Error("slom.bad-option",
                  "the probability of an interval is " + number(probability, 6) +
                      "; pass a number between 0 and 1, such as 0.95",
                  "probability");
    }
    const Eigen::MatrixXd C = state_->covariance({variable}).C;
    for (Eigen::Index i = 0; i < result.size(); ++i)
      result[i] = C(i, i) > 0 ? studentCritical(1 - probability, result[i]) * std::sqrt(C(i, i)) : 0;
  }
  std::copy_n(result.data(), result.size(), out);
}

void Clustered::writeInfluences(int variable, bool in_deviations, double* out) const {
  const Eigen::MatrixXd Z = state_->columns(variable);
  const ClusterScores& scores = state_->level(0).terms[0].scores;
  Eigen::MatrixXd change =
      state_->refits ? state_->refitted({variable}) : scores.effects(Z, ClusterCorrection::cr3);
  const Eigen::VectorXd stated = state_->problem().times(Z).colwise().squaredNorm();
  for (int g = 0; g < (state_->refits ? 0 : scores.count()); ++g) {
    const bool is_unknown = !scores.factors()[at(g)].has_leverage || scores.isPrivate(variable, g);
    for (Eigen::Index i = 0; i < change.cols(); ++i) {
      if (stated[i] > 0 && (is_unknown || scores.aloneIn(Z.col(i), g) > kAloneShare * stated[i]))
        change(g, i) = std::numeric_limits<double>::quiet_NaN();
    }
  }
  if (in_deviations) {
    const Eigen::MatrixXd C = state_->covariance({variable}).C;
    for (Eigen::Index i = 0; i < change.cols(); ++i)
      change.col(i) *= C(i, i) > 0 ? 1 / std::sqrt(C(i, i)) : 0;
  }
  std::copy_n(change.data(), change.size(), out);
}

std::vector<ClusterCheck> Clustered::check() const {
  static_cast<void>(state_->problem());
  const ClusterScores& scores = state_->level(0).terms[0].scores;
  std::vector<ClusterCheck> result;
  for (int g = 0; g < scores.count(); ++g) {
    const ClusterFactor& factor = scores.factors()[at(g)];
    ClusterCheck check{scores.clustering().names[at(g)], static_cast<int>(scores.measurements(g).size())};
    if (factor.has_leverage) {
      const Eigen::VectorXd f = scores.factorsOf(ClusterCorrection::cr2, g);
      for (Eigen::Index k = 0; k < f.size(); ++k) check.dof += f[k] > 0 ? 1 : 0;
      check.statistic = f.cwiseProduct(factor.residual).squaredNorm() / state_->variance_factor;
    }
    if (check.dof > 0) check.probability = chiSquareProbability(check.statistic, check.dof);
    result.push_back(std::move(check));
  }
  return result;
}

std::ostream& operator<<(std::ostream& os, const Clustered& clustered) { return os << clustered.report(); }

std::string Clustered::report(int most_unknowns) const {
  const LinearizedProblem& linearized = state_->problem();
  const Problem& all = linearized.problem();
  struct Row {
    std::string name;
    double value, stated, clustered, dof;
  };
  std::vector<Row> rows;
  VariableNotes own;
  std::size_t width = 9;
  for (int v = 0; v < linearized.structure().system.blockCount(); ++v) {
    if (static_cast<int>(rows.size()) >= most_unknowns) break;
    if (linearized.structure().system.isEmpty(v)) continue;
    const VariableRecord& record = all.variables()[at(v)];
    const std::vector<std::string> names = all.componentNames(v);
    std::vector<double> x(at(record.dof)), dof(at(record.dof));
    record.store->coordinates(record.store->valueAt(record.slot), x.data());
    const State::Covariance covariance = state_->covariance({v});
    own.add(*state_, v, covariance);
    const Eigen::VectorXd stated = linearized.times(state_->columns(v)).colwise().norm();
    writePerComponent(v, Kind::dof, 0, dof.data());
    for (int c = 0; c < record.dof; ++c) {
      if (linearized.activeSet().isFixedOrActive(v, c)) continue;
      rows.push_back({names[at(c)], x[at(c)], stated[c] * std::sqrt(state_->variance_factor),
                      std::sqrt(covariance.C(c, c)), dof[at(c)]});
      width = std::max(width, names[at(c)].size());
    }
  }
  const ClassicNumbers points;
  const auto line = [&](const Row* row) {
    char text[120];
    std::snprintf(text, sizeof text, " %14s %12s %12s %8s\n", row ? number(row->value, 8).c_str() : "value",
                  row ? number(row->stated).c_str() : "stated",
                  row ? number(row->clustered).c_str() : "clustered", row ? number(row->dof).c_str() : "dof");
    std::string name = row ? row->name : "parameter";
    name.resize(width, ' ');
    return "  " + name + text;
  };
  std::string text = line(nullptr);
  for (const Row& row : rows) text += line(&row);
  for (const std::string& note : own.after(notes())) text += "  note: " + note + "\n";
  return text;
}

std::vector<std::string> Clustered::notesOn(const std::vector<int>& variables) const {
  VariableNotes own;
  for (const int v : variables) own.add(*state_, v, state_->covariance({v}));
  return own.after(notes());
}

}  // namespace slom
