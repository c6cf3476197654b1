// expect: slom: a measurement function must return a number, a std::array or an Eigen column vector of doubles; one that predicts another manifold value needs slom::measured\(z\) among the arguments
#include <slom/slom.hpp>

typedef mtk::trafo<mtk::SO2<>> Pose;

void f(slom::Estimator& est, slom::VarID<Pose> a, slom::VarID<Pose> b) {
  const auto relative = [](const auto& x, const auto& y) { return x.inverse() * y; };
#ifdef MUST_FAIL
  est.insertMeasurement(relative, a, b);
#else
  est.insertMeasurement(relative, a, b, slom::measured(Pose()));
#endif
}
