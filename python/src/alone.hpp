// One thing at a time with an estimator. A fit runs without the interpreter's lock, and functions of the user run within
// it: neither other threads nor these functions may change the estimator meanwhile.
#pragma once

#include <utility>

#include "measure.hpp"
#include "variable.hpp"

namespace slom::python {

/// Marks an estimator as being used while it exists. Throws [slom.in-use] if another one exists.
class InUse {
 public:
  explicit InUse(const Estimator& est);
  ~InUse();
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  const Estimator* est_;
};

namespace parts {
inline const Estimator& estimatorOf(const Estimator& est) { return est; }
inline const Estimator& estimatorOf(const Shared& est) { return *est; }
template <class T>
const Estimator& estimatorOf(const T& part) {
  return *part.est;
}
}  // namespace parts

/// Returns f, which takes an estimator or a part of one first, with the estimator marked during its calls.
template <class R, class Own, class... More>
auto alone(R (*f)(Own, More...)) {
  return [f](Own own, More... more) -> R {
    const InUse in_use(parts::estimatorOf(own));
    return f(std::forward<Own>(own), std::forward<More>(more)...);
  };
}

}  // namespace slom::python
