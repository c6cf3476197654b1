#include "mtk/error.hpp"
#include "slom/solve/cholmod.hpp"

namespace slom {

namespace {

std::unique_ptr<LinearSolver> makeCholmod() {
  throw mtk::Error("slom.no-cholmod",
                   "this build of SLoM is without CHOLMOD; configure it with -DSLOM_WITH_CHOLMOD=ON, or use "
                   "the default solver");
}

}  // namespace

bool Cholmod::isAvailable() { return false; }
Cholmod::Cholmod() : ForwardingSolver(makeCholmod()) {}

}  // namespace slom
