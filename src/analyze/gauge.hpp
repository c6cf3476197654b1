/// Tells a free gauge, which is a motion of the whole world, from other directions without influence.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "slom/linearize/structure.hpp"

namespace slom {

/// A part of the problem that no measurement connects with the rest.
struct ConnectedPart {
  std::vector<int> variables;  // whose blocks are not empty
  std::vector<int> unknowns;   // the unknowns of these blocks
};

/// The connected parts of a structure, in the order of their first blocks.
std::vector<ConnectedPart> connectedParts(const BlockStructure& structure);

/// The gauge generators that lie in a null space.
struct Gauge {
  Eigen::MatrixXd
      motions;  ///< kGaugeGenerators x count: combinations of gauge generators, each row times `length`
  Eigen::VectorXd length;  ///< norm of each gauge generator in scaled unknowns
  Eigen::MatrixXd
      directions;  ///< unknowns of the part x count: what they do to the scaled unknowns, orthonormal
  bool has_translation = false, has_rotation = false, has_scale = false;
  std::string text;  ///< `translation x, y; rotation about z`

  Eigen::Index count() const { return directions.cols(); }
};

/// `null_space`: unknowns of the part x k, orthonormal, in unknowns scaled by `scale` (all unknowns). A variable alone has no
/// gauge: its directions are those of a thing that is not measured.
Gauge findGauge(const Problem& problem, const ProblemStructure& structure, const ConnectedPart& part,
                const Eigen::MatrixXd& null_space, const Eigen::VectorXd& scale);

}  // namespace slom
