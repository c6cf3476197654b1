/// What is known of a variable beforehand, or measured of it directly.
///
///     est.insertMeasurement(slom::Prior(), x, slom::measured(z), slom::StandardDeviation(sigma));
///
///   variable  x    any manifold: numbers, vectors (dynamic ones too), rotations, poses, compounds, the user's own
///   datum     z    of the type of x
///   residual  x [-] z, in the tangent space at z; units and names are those of the components of x
/// `est.prior(x, z, sigma)` is short for it.
#pragma once

#include "slom/model/prior.hpp"
