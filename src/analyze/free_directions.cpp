#include "analyze/free_directions.hpp"

#include "analyze/directions.hpp"
#include "analyze/null_space.hpp"

namespace slom {

FreeDirections findFreeDirections(const LinearizedProblem& linearized) {
  FreeDirections result;
  result.count = linearized.freeDirections();
  const Eigen::Index n = linearized.structure().system.unknowns();
  if (result.count == 0) {
    result.basis.resize(n, 0);
    return result;
  }
  for (const Finding& finding : linearized.diagnosis().findings) {
    if (finding.kind == Finding::Kind::gauge) result.gauge += finding.dimension;
  }
  const NearNullSpace& space = linearized.nearNullSpace();
  const Eigen::Index none = space.countBelow(linearized.digitsOfDerivatives());
  const Eigen::Index unobserved = static_cast<Eigen::Index>(space.unobserved.size());
  result.basis = Eigen::MatrixXd::Zero(n, none + unobserved);
  result.basis.leftCols(none) =
      space.scale.cwiseInverse().asDiagonal() * basisOfFewEntries(space.direction.leftCols(none));
  for (Eigen::Index k = 0; k < unobserved; ++k)
    result.basis(space.unobserved[static_cast<std::size_t>(k)], none + k) = 1;
  return result;
}

}  // namespace slom
