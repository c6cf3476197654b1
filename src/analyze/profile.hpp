#pragma once

#include <functional>

namespace slom {

/// The root of a function that grows with t > 0, is -1 at 0 and about (t / guess)^2 - 1, up to 1000 guesses; infinite beyond.
/// `most` where the function, which is not evaluated beyond, is not positive up to there.
double profileRoot(const std::function<double(double)>& f, double guess, double most);

}  // namespace slom
