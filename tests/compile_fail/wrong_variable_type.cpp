// expect: (cannot convert|no matching function|no matching constructor|no known conversion)
// Handles are typed: a landmark's VarID is not a pose's.
#include <slom/slom.hpp>

typedef mtk::vect<2> vec2;
typedef mtk::trafo<mtk::SO2<>> Pose;
SLOM_BUILD_MEASUREMENT(Observation, 2, ((Pose, pose))((vec2, landmark)), ((vec2, z)))
SLOM_IMPLEMENT_MEASUREMENT(Observation, ret) { ret = pose->inverse() * *landmark - z; }

void f(slom::Estimator& est, slom::VarID<Pose> pose, slom::VarID<vec2> landmark) {
#ifdef MUST_FAIL
  est.insertMeasurement(Observation(landmark, pose, vec2()));
#else
  est.insertMeasurement(Observation(pose, landmark, vec2()));
#endif
}
