/// Measurements of an online fit at the current values: costs, gradients, Jacobians, and their rounding errors.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <Eigen/Core>

#include "base/index.hpp"
#include "online/online_fit.hpp"

namespace slom {

namespace {

constexpr double kRoundingSteps = 4;  // units in the last place
constexpr double kMostPeak = 1e6;  // largest sum of costs since full summation, relative to the current one

/// A guard that graduates the losses of the estimator's linearizer during its lifetime.
class Graduated {
 public:
  Graduated(Linearizer& linearizer, double mu) : linearizer_(linearizer) {
    linearizer_.setLossGraduation(mu);
  }
  Graduated(const Graduated&) = delete;
  Graduated& operator=(const Graduated&) = delete;
  ~Graduated() { linearizer_.setLossGraduation(1); }

 private:
  Linearizer& linearizer_;
};

/// Computes g := J^T r.
template <int Rows>
void writeGradientOf(int rows, const double* J, const double* r, std::vector<double>& g) {
  const int n = Rows > 0 ? Rows : rows;
  for (double& sum : g) {
    sum = 0;
    for (int k = 0; k < n; ++k) sum += J[k] * r[k];
    J += n;
  }
}
void writeGradient(int rows, const double* J, const double* r, std::vector<double>& g) {
  switch (rows) {
    case 2:
      return writeGradientOf<2>(rows, J, r, g);
    case 3:
      return writeGradientOf<3>(rows, J, r, g);
    case 6:
      return writeGradientOf<6>(rows, J, r, g);
    default:
      return writeGradientOf<0>(rows, J, r, g);
  }
}

}  // namespace

/// Linearises `count` measurements at the current values. The factor gets the new Jacobian if it differs from the old
/// one by more than `most_difference`.
void OnlineFit::linearize(Place first, int count, double most_difference) {
  const MeasurementPool& pool = *problem_.pools()[at(first.first)];
  const bool has_losses = pool.lossCount() > 0;  // if so, costs are not those of the residuals
  const int each = has_losses ? 1 : count;
  for (int i = first.second; i < first.second + count; i += each) {
    double cost = 0;
    const Graduated graduated(linearizer_, has_losses ? recordOf({first.first, i}).graduation : 1);
    const JacobianBatch batch =
        linearizer_.linearizeSome(problem_, problem_.activeSet(), first.first, i, i + each, &cost);
    const double *r = batch.r, *J = batch.J;
    const int* dof = batch.dof;
    for (int m = 0; m < each; ++m) {
      const int rows = batch.rows[m];
      if (!has_losses) {
        cost = 0;
        for (int k = 0; k < rows; ++k) cost += r[k] * r[k];
      }
      take({first.first, i + m}, r, J, dof, cost, most_difference);
      r += rows;
      for (int k = 0; k < pool.arity(); ++k) J += rows * *dof++;
    }
  }
}

void OnlineFit::take(Place place, const double* r, const double* J, const int* dof, double cost,
                     double most_difference) {
  Record& record = recordOf(place);
  if (record.element == kPending) return;
  ++linearized_;
  addToRss(-record.cost);  // separately, because a difference of the two would be rounded
  addToRss(cost);
  record.cost = cost;
  if (record.element == kNone) return;
  const std::span<const double> before = factor_.A(record.element);
  const int rows = factor_.rowsOf(record.element);
  if (!record.is_plain) {
    merge(place, J, dof);
    J = A_.data();
  }
  const auto entries = static_cast<Eigen::Index>(before.size());
  const double difference = (Eigen::Map<const Eigen::VectorXd>(J, entries) -
                             Eigen::Map<const Eigen::VectorXd>(before.data(), entries))
                                .squaredNorm();
  g_.resize(before.size() / at(rows));
  writeGradient(rows, J, r, g_);
  flops_ += 2.0 * static_cast<double>(before.size());
  factor_.setGradient(record.element, g_);
  if (difference > most_difference * most_difference * factor_.squaredNormOfA(record.element))
    factor_.setA(record.element, {J, before.size()});
}

/// Computes the Jacobian of an element from those of its measurement, if the measurement has a variable without a
/// block, or a variable twice.
void OnlineFit::merge(Place place, const double* J, const int* dof) {
  const int element = recordOf(place).element, rows = factor_.rowsOf(element);
  const MeasurementPool& pool = *problem_.pools()[at(place.first)];
  const int* const variables = pool.variables(place.second);
  A_.assign(factor_.A(element).size(), 0.0);
  for (int k = 0; k < pool.arity(); ++k) {
    const int entries = rows * dof[k];
    std::size_t start = 0;
    for (const int b : factor_.blocksOf(element)) {
      if (b == variables[k]) {
        for (int e = 0; e < entries; ++e) A_[start + at(e)] += J[e];
        break;
      }
      start += at(rows * factor_.dof(b));
    }
    J += entries;
  }
}

void OnlineFit::linearizeTouched(double most_difference) {
  constexpr std::size_t most = 64;
  for (std::size_t first = 0; first < touched_.size();) {
    std::size_t last = first + 1;
    while (last < touched_.size() && last - first < most && touched_[last].first == touched_[first].first &&
           touched_[last].second == touched_[last - 1].second + 1)
      ++last;
    linearize(touched_[first], static_cast<int>(last - first), most_difference);
    first = last;
  }
}

/// Estimates the effect of the last digits of the variables' values on the measurement.
void OnlineFit::roundAgain(Record& record) {
  if (record.element < 0) return;
  const int rows = factor_.rowsOf(record.element);
  const double* a = factor_.A(record.element).data();
  double residual = 0;
  std::vector<double> sizes;
  for (const int v : factor_.blocksOf(record.element)) {
    const VariableRecord& variable = problem_.variables()[at(v)];
    sizes.resize(at(variable.dof));
    variable.store->typicalSizes(variable.slot, sizes.data());
    for (const double size : sizes) {
      double length = 0;
      for (int k = 0; k < rows; ++k, ++a) length += *a * *a;
      residual += std::sqrt(length) * size;
    }
  }
  residual *= kRoundingSteps * std::numeric_limits<double>::epsilon();
  rounding_ += residual * residual - record.rounding;
  record.rounding = residual * residual;
}

void OnlineFit::addToRss(double change) {
  // Neumaier's sum: adding and later subtracting a number leaves nothing.
  const double sum = rss_ + change;
  rss_rest_ += std::abs(rss_) >= std::abs(change) ? (rss_ - sum) + change : (change - sum) + rss_;
  rss_ = sum;
  peak_ = std::max(peak_, std::abs(sum));
}

/// Adds up all measurements again if the sum was so much larger meanwhile that its remaining digits cannot be trusted.
/// Each time, this takes time proportional to all measurements.
void OnlineFit::sumAgain() {
  if (peak_ <= kMostPeak * std::abs(rss())) return;
  rss_ = rss_rest_ = 0;
  for (const std::vector<Record>& records : records_) {
    for (const Record& record : records) addToRss(record.cost);
  }
  peak_ = std::abs(rss());
}

}  // namespace slom
