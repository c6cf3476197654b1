// expect: mtk: this type is not a manifold
#include <slom/slom.hpp>

struct Label {
  const char* text;
};

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.propagate([](double) { return Label{"text"}; }, x);
#else
  est.propagate([](double v) { return 2 * v; }, x);
#endif
}
