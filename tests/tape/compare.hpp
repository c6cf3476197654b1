/// Compares a traced measurement function with its evaluation by dual numbers.
///   residual     equal to 1e-14 of the size of its terms
///   derivatives  equal to 1e-12
///   kernels      AVX2 and AVX-512 give the same bits; portable ones agree
#pragma once

#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include <slom/tape.hpp>

#include "base/processor.hpp"
#include "measurements/kind.hpp"
#include "tape/evaluate.hpp"

namespace slom::testing {

/// What a tape computes for several measurements.
struct Evaluated {
  std::vector<double> r, r_alone, J;
};

/// Evaluates the tape by these kernels.
inline Evaluated evaluated(const tape::Tape& tape, int count, const tape::Tape::Source& source,
                           InstructionSet kernels) {
  const auto n = static_cast<std::size_t>(count * tape.rows());
  Evaluated result{std::vector<double>(n), std::vector<double>(n),
                   std::vector<double>(n * static_cast<std::size_t>(tape.columns()))};
  tape::evaluateBy(tape::kernelsOf(kernels));
  tape.evaluate(count, source, result.r.data(), result.J.data());
  tape.evaluate(count, source, result.r_alone.data(), nullptr);
  tape::evaluateBy(tape::kernels());
  return result;
}

/// Compares numbers. Two NaN are equal.
inline void expectClose(const std::vector<double>& got, const std::vector<double>& expected,
                        double tolerance) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i) {
    if (std::isnan(expected[i]) && std::isnan(got[i])) continue;
    EXPECT_NEAR(got[i], expected[i], tolerance) << "entry " << i;
  }
}
inline bool haveSameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

/// `samples` are tuples of the datum and the variables.
template <class F, class Z, class... X>
void expectTraced(const F&, const std::vector<std::tuple<Z, X...>>& samples) {
  using One = CallableMeasurement<OneByOne<F>, VarID<X>..., Measured<Z>>;
  static_assert(One::derivatives == DerivativeSource::exact);
  Estimator owner;
  std::shared_ptr<const TracedKind> kind;
  std::vector<const double*> variables;
  std::vector<double> data, r, J;
  double size = 1, size_of_J = 1;
  std::vector<std::tuple<VarID<X>...>> all;
  for (const auto& sample : samples) {
    std::apply([&](const Z&, const X&... x) { all.emplace_back(owner.insertRV(x)...); }, sample);
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Z& z = std::get<0>(samples[i]);
    std::apply(
        [&](const VarID<X>&... id) {
          const auto own = detail::trace(F(), data, id..., measured(z));
          ASSERT_TRUE(kind == nullptr || kind == own);
          kind = own;
          std::size_t k = 0;
          (variables.push_back(reinterpret_cast<const double*>(reinterpret_cast<const std::byte*>(&*id) +
                                                               own->layouts[k++].front())),
           ...);
          One one(OneByOne<F>(), id..., measured(z));
          const int rows = own->tape.rows(), columns = own->tape.columns();
          std::vector<double> own_r(static_cast<std::size_t>(rows)),
              own_J(static_cast<std::size_t>(rows * columns));
          ASSERT_EQ(one.linearize(rows, own_r.data(), own_J.data()), rows);
          for (const double x : own_r) size = std::isfinite(x) ? std::max(size, std::abs(x)) : size;
          for (const double x : own_J)
            size_of_J = std::isfinite(x) ? std::max(size_of_J, std::abs(x)) : size_of_J;
          r.insert(r.end(), own_r.begin(), own_r.end());
          J.insert(J.end(), own_J.begin(), own_J.end());
          std::vector<double> sizes;
          (appendTypicalSizes(sizes, *id), ...);
          for (const double x : sizes) size = std::max(size, x);
        },
        all[i]);
  }
  const int count = static_cast<int>(samples.size());
  const tape::Tape::Source source{variables.data(), data.data()};
  std::vector<Evaluated> results;
  for (const InstructionSet kernels :
       {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (!hasInstructionSet(kernels)) continue;
    SCOPED_TRACE(static_cast<int>(kernels));
    results.push_back(evaluated(kind->tape, count, source, kernels));
    expectClose(results.back().r, r, 1e-14 * size);
    expectClose(results.back().r_alone, r, 1e-14 * size);
    expectClose(results.back().J, J, 1e-12 * size_of_J);
  }
  if (results.size() == 3) {
    EXPECT_TRUE(haveSameBits(results[1].r, results[2].r));
    EXPECT_TRUE(haveSameBits(results[1].r_alone, results[2].r_alone));
    EXPECT_TRUE(haveSameBits(results[1].J, results[2].J));
  }
}

}  // namespace slom::testing
