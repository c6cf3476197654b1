// expect: slom: among classes over a list of variables, only slom::GaussianPrior can be saved; register it without further types
#include <slom/archive.hpp>

void f(slom::Archive& archive) {
#ifdef MUST_FAIL
  archive.measurement<slom::GaussianPrior, slom::VarID<double>>();
#else
  archive.measurement<slom::GaussianPrior>();
#endif
}
