// expect: mtk: a member of this compound is not a manifold; its type needs `scalar`, `DOF`, `boxplus` and `boxminus`, or must be a struct without constructors whose members are all manifolds
#include <Eigen/Geometry>

#include <slom/slom.hpp>

#ifdef MUST_FAIL
using Turn = Eigen::Quaterniond;
#else
using Turn = mtk::SO3<>;
#endif

MTK_BUILD_MANIFOLD(Camera, ((Turn, orient))((mtk::vect<2>, focal)))

void f(slom::Estimator& est) { est.insertRV(Camera()); }
