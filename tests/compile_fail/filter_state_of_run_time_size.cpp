// expect: slom: a filter needs a state of a size known at compile time
#include <slom/filter.hpp>

auto f() {
#ifdef MUST_FAIL
  slom::ErrorStateFilter filter(mtk::vect<mtk::Dynamic>{1, 2}, slom::StandardDeviation(0.1));
#else
  slom::ErrorStateFilter filter(mtk::vect<2>(1, 2), slom::StandardDeviation(0.1));
#endif
}
