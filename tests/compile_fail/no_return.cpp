// expect: slom: a measurement function must return a number, a std::array or an Eigen column vector of doubles; one that predicts another manifold value needs slom::measured\(z\) among the arguments
#include <slom/slom.hpp>

void f(slom::Estimator& est, slom::VarID<double> x) {
#ifdef MUST_FAIL
  est.insertMeasurement([](double v) { v - 1.0; }, x);
#else
  est.insertMeasurement([](double v) { return v - 1.0; }, x);
#endif
}
