// expect: mtk: this vector has fewer entries
#include <slom/slom.hpp>

double f(const mtk::vect<2>& p) {
#ifdef MUST_FAIL
  return p.z();
#else
  return p.y();
#endif
}
