// expect: slom: a measurement function over a list of variables gets a std::span<const slom::VariableView> and a `const D&` for each datum of type D
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
  const auto residual = [](std::span<const slom::VariableView> v, double z) { return v[0].as<double>() - z; };
#ifdef MUST_FAIL
  est.insertMeasurement(residual, {x});
#else
  est.insertMeasurement(residual, {x}, 1.0);
#endif
}
