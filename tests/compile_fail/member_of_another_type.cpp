// expect: (no matching function|no matching member function)
#include <slom/slom.hpp>

struct Lens {
  double focal, skew;
};
struct Rig {
  double height;
};

void f(slom::Estimator& est, slom::VarID<Lens> lens) {
#ifdef MUST_FAIL
  est.fix(&Rig::height, lens);
#else
  est.fix(&Lens::skew, lens);
#endif
}
