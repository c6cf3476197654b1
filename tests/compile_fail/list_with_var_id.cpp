// expect: slom: a measurement over a list takes its variables only from the list: put this VarID into the list
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x, slom::VarID<double> y) {
  const auto difference = [](std::span<const slom::VariableView> v) {
    return v[0].as<double>() - v[1].as<double>();
  };
#ifdef MUST_FAIL
  est.insertMeasurement(difference, {x}, y);
#else
  est.insertMeasurement(difference, {x, y});
#endif
}
