#include "measurements/kind.hpp"

#include <Eigen/Dense>

namespace slom::testing {
namespace {

/// Makes a residual continuous. Its last `count` rows are a rotation vector, which may jump at half a turn. If the
/// other vector of the same rotation is closer to that of `base`, takes that one.
void continueRotation(LongVector& residual, const LongVector& base, int count) {
  const LongVector v = residual.tail(count);
  const Real angle = v.norm(), turn = 2 * std::acos(Real(-1));
  if (angle < turn / 4) return;
  const LongVector other = v * (1 - turn / angle);
  if ((other - base.tail(count)).norm() < (v - base.tail(count)).norm()) residual.tail(count) = other;
}

/// Returns derivatives of the formula, whose value is `base`, by central differences of order 6: column i for unknown
/// i.
Eigen::MatrixXd differences(const FormulaAt& formula, const LongVector& base, int unknowns, Real step,
                            int angles) {
  Eigen::MatrixXd J(base.size(), unknowns);
  for (int i = 0; i < unknowns; ++i) {
    const auto moved = [&](int steps) {
      LongVector residual = formula(i, steps * step);
      continueRotation(residual, base, angles);
      return residual;
    };
    const LongVector column =
        (45 * (moved(1) - moved(-1)) - 9 * (moved(2) - moved(-2)) + (moved(3) - moved(-3))) / (60 * step);
    J.col(i) = column.cast<double>();
  }
  return J;
}

Eigen::Map<const Eigen::VectorXd> vector(const std::vector<double>& x) {
  return {x.data(), static_cast<Eigen::Index>(x.size())};
}

}  // namespace

void expectFormula(Alone& measurement, const FormulaAt& formula, const std::vector<double>& sizes_of_datum,
                   const std::vector<double>& sizes_of_unknowns, int angles, Real step) {
  const Eigen::VectorXd& r = measurement.r;
  const Eigen::MatrixXd& J = measurement.J;
  const double size = std::max({vector(sizes_of_datum).maxCoeff(), r.cwiseAbs().maxCoeff(),
                                (J.cwiseAbs() * vector(sizes_of_unknowns)).maxCoeff()});
  measurement.size = size;
  EXPECT_LE((r - measurement.r_without_derivatives).norm(), 1e-14 * size);

  const LongVector base = formula(-1, 0);
  const Eigen::VectorXd expected = base.cast<double>();
  ASSERT_EQ(r.size(), expected.size());
  EXPECT_LE((r - expected).norm(), 1e-14 * size) << r.transpose() << " in place of " << expected.transpose();

  const auto unknowns = static_cast<int>(sizes_of_unknowns.size());
  const Eigen::MatrixXd derivatives = differences(formula, base, unknowns, step, angles);
  EXPECT_LE((J - derivatives).norm(), 1e-9 * derivatives.norm()) << J << "\nin place of\n" << derivatives;
}

void expectTheSameInPacks(const std::vector<Alone>& measurements,
                          const std::function<void(int count, double* r, double* J)>& evaluateMany) {
  for (int count = 1; count <= static_cast<int>(measurements.size()); ++count) {
    const auto rows = measurements[0].J.rows(), columns = measurements[0].J.cols();
    const double unused = 12345;
    std::vector<double> r(static_cast<std::size_t>(count * rows + 1), unused), r_without_derivatives = r;
    std::vector<double> J(static_cast<std::size_t>(count * rows * columns + 1), unused);
    evaluateMany(count, r.data(), J.data());
    evaluateMany(count, r_without_derivatives.data(), nullptr);
    EXPECT_EQ(r.back(), unused);
    EXPECT_EQ(r_without_derivatives.back(), unused);
    EXPECT_EQ(J.back(), unused);
    for (int i = 0; i < count; ++i) {
      const Alone& alone = measurements[static_cast<std::size_t>(i)];
      const Eigen::Map<const Eigen::VectorXd> ri(r.data() + i * rows, rows),
          without(r_without_derivatives.data() + i * rows, rows);
      const Eigen::Map<const Eigen::MatrixXd> Ji(J.data() + i * rows * columns, rows, columns);
      EXPECT_LE((ri - alone.r).norm(), 1e-14 * alone.size) << i << " of " << count;
      EXPECT_LE((without - alone.r).norm(), 1e-14 * alone.size) << i << " of " << count;
      EXPECT_LE((Ji - alone.J).norm(), 1e-14 * alone.J.norm()) << i << " of " << count << "\n"
                                                               << Ji << "\nin place of\n"
                                                               << alone.J;
    }
  }
}

}  // namespace slom::testing
