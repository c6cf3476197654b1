/// A free gauge, a motion of the whole world, told apart from other directions without influence.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/linearize/structure.hpp"

namespace slom {

/// A part of the problem that no measurement connects with the rest.
struct ConnectedPart {
  std::vector<int> variables;  // those with nonempty blocks
  std::vector<int> unknowns;   // the unknowns of these blocks
};

/// Returns the connected parts of a structure, in the order of their first blocks.
std::vector<ConnectedPart> connectedParts(const BlockStructure& structure);

/// The gauge generators that lie in a null space.
struct Gauge {
  /// kGaugeGenerators x count: combinations of gauge generators, each row times `length`.
  Eigen::MatrixXd motions;
  Eigen::VectorXd length;  ///< norm of each gauge generator in scaled unknowns
  /// Unknowns of the part x count: the motions as changes of the scaled unknowns, orthonormal.
  Eigen::MatrixXd directions;
  bool has_translation = false, has_rotation = false, has_scale = false;
  std::string text;  ///< `translation x, y; rotation about z`

  Eigen::Index count() const { return directions.cols(); }
};

/// Finds the gauge in a null space. `null_space`: unknowns of the part x k, orthonormal, in unknowns scaled by `scale`
/// (all unknowns). A single variable has no gauge: its directions are those of a variable that is not measured.
Gauge findGauge(const Problem& problem, const ProblemStructure& structure, const ConnectedPart& part,
                const Eigen::MatrixXd& null_space, const Eigen::VectorXd& scale);

}  // namespace slom
