#include "mtk/error.hpp"
#include "slom/solve/cholmod.hpp"
#include "solve/named_list.hpp"

namespace slom {

struct Cholmod::Implementation {
  Eigen::VectorXd nothing;
};

bool Cholmod::isAvailable() { return false; }

Cholmod::Cholmod() : impl_(nullptr) {
  throw mtk::Error("slom.no-cholmod",
                   "this build of SLoM is without CHOLMOD; configure it with -DSLOM_WITH_CHOLMOD=ON, or use "
                   "the default solver");
}
Cholmod::~Cholmod() = default;

// None of these is ever called, as there is no object.
void Cholmod::analyze(const BlockStructure&) {}
void Cholmod::beginLinearization() {}
void Cholmod::add(const JacobianBatch&) {}
void Cholmod::endLinearization() {}
SolveStatus Cholmod::solve(const Eigen::VectorXd&, Eigen::VectorXd&) { return {}; }
const Eigen::VectorXd& Cholmod::gradient() const { return impl_->nothing; }
const Eigen::VectorXd& Cholmod::diagonal() const { return impl_->nothing; }
double Cholmod::squaredNormOfJd(const Eigen::VectorXd&) const { return 0; }
SolveStatus Cholmod::solveFor(const Eigen::MatrixXd&, Eigen::MatrixXd&) { return {}; }
double Cholmod::leastOfColumn() const { return 0; }
std::string Cholmod::description() const { return ""; }

const NamedSolver detail::solvers::cholmod{"cholmod", "CHOLMOD", &makeSolver<Cholmod>,
                                           "CHOLMOD (-DSLOM_WITH_CHOLMOD=ON)"};

}  // namespace slom
