#include "mtk/error.hpp"
#include "slom/solve/cholmod.hpp"
#include "solve/named_list.hpp"

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
std::unique_ptr<LinearSolver> Cholmod::makeAnother() const { return std::make_unique<Cholmod>(); }

const NamedSolver detail::solvers::cholmod{"cholmod", "CHOLMOD", &makeSolver<Cholmod>,
                                           "CHOLMOD (-DSLOM_WITH_CHOLMOD=ON)"};

}  // namespace slom
