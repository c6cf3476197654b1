/// Filters on manifolds: the states, measurement functions and noises of an Estimator, in real time.
///
///     slom::ErrorStateFilter filter(State{...}, slom::Covariance(P0));
///     const auto step = filter.predict(motion, slom::Covariance(Q), imu, dt);
///     const auto update = filter.update([](const auto& x, const vec3& gps) { return x.pose.pos - gps; }, gps,
///                                       slom::StandardDeviation(0.5));
///     if (!step || !update) ...                                    // step.message() says why
///
/// These headers need Eigen and no compiled library. They allocate nothing. The steps return a status instead of
/// exceptions; a refused step leaves the filter unchanged, and the compiler warns if the status is ignored.
#pragma once

#include "slom/filter/correlated.hpp"
#include "slom/filter/error_state_filter.hpp"
#include "slom/filter/invariant.hpp"
#include "slom/filter/models.hpp"
#include "slom/filter/rts_smoother.hpp"
#include "slom/filter/unscented_filter.hpp"
