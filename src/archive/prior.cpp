/// GaussianPriors in an archive: the linearisation points of all variables, the number of rows, R row by row, b, and
/// `first_estimates` if the prior has them.
#include <istream>
#include <ostream>
#include <string>
#include <vector>

#include "base/index.hpp"
#include "model/stored_value.hpp"
#include "slom/archive.hpp"

namespace slom {

namespace {

/// The linearisation points in the order in which they are read. Without handles, only their sizes are kept.
struct Points {
  const VariableHandle* next;
  std::vector<detail::StoredValue> values;
  int dof = 0;

  static void take(void* points, const void* value, int dof) {
    Points& self = *static_cast<Points*>(points);
    self.dof += dof;
    if (self.next != nullptr) self.values.emplace_back(AnyVarID(*self.next++), value);
  }
};

constexpr const char* kFirstEstimates = "first_estimates";

/// Reads the word if there is one. Returns false for another word.
bool readFirstEstimates(std::istream& is, bool& has_first_estimates) {
  std::string word;
  has_first_estimates = static_cast<bool>(is >> word);
  if (!has_first_estimates) is.clear();
  return !has_first_estimates || word == kFirstEstimates;
}

/// Appends `count` numbers. Returns false if the stream has fewer.
bool readNumbers(std::istream& is, long count, std::vector<double>& numbers) {
  for (double x = 0; count > 0 && is >> x; --count) numbers.push_back(x);
  return count == 0;
}

}  // namespace

void StoredPrior::write(std::ostream& os, const detail::StoredArguments& arguments,
                        const MeasurementPool& pool, int i) {
  const auto& prior = static_cast<const GaussianPrior&>(*pool.runtimeMeasurement(i));
  const auto R = prior.R();
  for (int k = 0; k < arguments.count; ++k) {
    arguments.kinds[k]->write(*arguments.kinds[k], os, prior.point(k));
    os << ' ';
  }
  os << R.rows() << ' ';
  for (Eigen::Index row = 0; row < R.rows(); ++row) {
    for (Eigen::Index column = 0; column < R.cols(); ++column) os << R(row, column) << ' ';
  }
  for (Eigen::Index row = 0; row < R.rows(); ++row) os << prior.b()[row] << ' ';
  if (prior.hasFirstEstimates()) os << kFirstEstimates << ' ';
}

bool StoredPrior::read(std::istream& is, Problem* problem, const detail::StoredArguments& arguments,
                       const detail::StoredOptions& options) {
  Points points{arguments.handles, {}};
  for (int k = 0; k < arguments.count; ++k) {
    if (!arguments.kinds[k]->read_value(*arguments.kinds[k], is, &points, &Points::take)) return false;
  }
  long rows = 0;
  std::vector<double> by_rows, b;
  bool has_first_estimates = false;
  if (!(is >> rows) || rows < 0 || rows > detail::kLargestSize / std::max(1, points.dof) ||
      !readNumbers(is, rows * points.dof, by_rows) || !readNumbers(is, rows, b) ||
      !readFirstEstimates(is, has_first_estimates))
    return false;
  if (problem == nullptr) return true;
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::MatrixXd R = Eigen::Map<const ByRows>(by_rows.data(), rows, points.dof);
  std::vector<AnyVarID> ids;
  for (int k = 0; k < arguments.count; ++k) ids.emplace_back(arguments.handles[k]);
  GaussianPrior prior(std::move(ids), R.data(), {R.rows(), R.cols()}, b.data(), rows);
  for (int k = 0; k < arguments.count; ++k) prior.setPoint(k, points.values[at(k)].get());
  prior.withFirstEstimates(has_first_estimates);
  problem->insertMeasurement(std::move(prior), options.noise, options.label, options.loss);
  return true;
}

}  // namespace slom
