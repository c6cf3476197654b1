/// Collective: agreement of several processes that fit one problem together.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mtk/detail/cpp20.hpp"

namespace slom {

/// The processes of a fit. Every process has a part of the problem and runs the same algorithm. It decides by scalars
/// that are the same in all, because this interface forms them. This class is the single process, which agrees with
/// itself at no cost. A LinearSolver for several processes overrides all functions (LinearSolver::collective). All
/// processes must call them, in the same order.
class Collective {
 public:
  virtual ~Collective() = default;
  /// Returns whether there is only this process.
  virtual bool isAlone() const { return true; }
  /// Returns the sum of the numbers of all processes, with the same bits in each.
  virtual double sum(double x) const { return x; }
  /// Returns the largest number of all processes.
  virtual double max(double x) const { return x; }
  /// Returns a^T b for vectors with an entry for each unknown. An unknown that several processes have counts once.
  virtual double dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const { return a.dot(b); }
  /// Returns whether this process counts a block of unknowns. Of the processes that have the block, one counts it.
  virtual bool counts(int block) const { return static_cast<void>(block), true; }
  /// Returns the texts of all processes, in their order.
  virtual std::vector<std::string> gather(const std::string& text) const { return {text}; }

  /// Returns whether x holds in any process.
  bool any(bool x) const { return isAlone() ? x : max(x ? 1 : 0) > 0; }
  /// Returns whether x holds in all processes.
  bool all(bool x) const { return isAlone() ? x : !any(!x); }
  /// Calls f. If it throws in some processes, throws the error of the first of these in all processes.
  template <class F>
  void agree(const F& f) const {
    if (isAlone()) {
      f();
    } else {
      agreeOn(f);
    }
  }

 protected:
  /// Does the work of agree() for several processes.
  virtual void agreeOn(const std::function<void()>& f) const { f(); }
};

/// Returns the single process.
const Collective& singleProcess();

}  // namespace slom
