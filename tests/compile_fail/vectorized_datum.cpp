// expect: slom: slom::vectorized needs variables and data that exist over other scalars: numbers, vectors, mtk's types, compounds of them and class templates
#include <slom/slom.hpp>

struct Datum {
  double value;
};

void f(slom::Estimator& est, slom::VarID<mtk::vect<2>> x) {
#ifdef MUST_FAIL
  est.insertMeasurement(slom::vectorized([](const auto& v, const auto& z) { return v[0] - z.value; }), x,
                        Datum{1.0});
#else
  est.insertMeasurement([](const auto& v, const auto& z) { return v[0] - z.value; }, x, Datum{1.0});
#endif
}
