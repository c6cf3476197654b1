#include <slom/slom.hpp>

#include "honesty/methods.hpp"

namespace slom::bench {

using testing::classics::Problem;

Claim fitBySlom(const Problem& problem, Method method) {
  Estimator est;
  est.setThreads(1);
  const auto x = est.insertRV(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(
                                  problem.start.data(), static_cast<Eigen::Index>(problem.start.size()))),
                              "x");
  est.insertMeasurement(
      [&problem](const auto& v) {
        using T = std::decay_t<decltype(v[0] * 1.0)>;
        Eigen::Matrix<T, Eigen::Dynamic, 1> r(problem.residuals), values(v.size());
        for (Eigen::Index i = 0; i < v.size(); ++i) values[i] = v[i];
        testing::classics::evaluate<T>(problem, values.data(), r.data());
        return r;
      },
      x);
  if (method == Method::levenberg_marquardt) est.changeAlgorithm(LevenbergMarquardt());
  if (method == Method::dog_leg) est.changeAlgorithm(DogLeg());
  Claim claim;
  try {
    const Summary summary = est.optimize();
    claim.converged = summary.converged;
    claim.iterations = summary.iterations;
    claim.rss = summary.final_rss;
  } catch (const Error&) {  // a residual is not finite at the start
    claim.threw = true;
    claim.rss = std::nan("");
  }
  claim.x.assign((*x).begin(), (*x).end());
  return claim;
}

}  // namespace slom::bench
