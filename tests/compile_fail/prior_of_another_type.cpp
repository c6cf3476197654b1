// expect: (cannot convert|no matching function|could not convert|no matching member function|no viable conversion)
#include <slom/slom.hpp>

typedef mtk::trafo<mtk::SO2<>> Pose;

void f(slom::Estimator& est, slom::VarID<Pose> x) {
#ifdef MUST_FAIL
  est.prior(x, mtk::SO2<>(), 0.1);
#else
  est.prior(x, Pose(), 0.1);
#endif
}
