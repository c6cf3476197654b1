/// Prior: prior knowledge of a variable, or a direct measurement of it.
///
///     est.insertMeasurement(slom::Prior(), x, slom::measured(z), slom::StandardDeviation(sigma));
///
///   variable  x    any manifold: numbers, vectors (also dynamic), rotations, poses, compounds, user-defined types
///   datum     z    of the type of x
///   residual  x [-] z, in the tangent space at z; units and names are those of the components of x
/// `est.prior(x, z, sigma)` is a short form.
#pragma once

#include "slom/model/prior.hpp"
