/// Words of messages.
#pragma once

#include <string>
#include <vector>

namespace slom {

/// `3 poses`, `1 pose`
std::string counted(int count, const std::string& noun);
/// `a`, `a and b`, `a, b and c`; of more than `most` the first ones `and 7 more`.
std::string listed(const std::vector<std::string>& items, std::size_t most = 4);
/// `pose 0, pose 1, ..., pose 9`: the first two and the last of many.
std::string abridged(const std::vector<std::string>& items);
/// `0.125`: the number with at most `digits` significant digits.
std::string number(double x, int digits = 3);

}  // namespace slom
