// expect: mtk: this type is not a manifold: give it `scalar`, `DOF`, `boxplus` and `boxminus`, or make it a struct without constructors whose members are all manifolds
#include <slom/slom.hpp>

#ifdef MUST_FAIL
struct Name {
  std::string first, last;
};
#else
struct Name {
  double first, last;
};
#endif

void f(slom::Estimator& est) { est.insertRV(Name{}); }
