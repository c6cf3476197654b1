/// Words of messages.
#pragma once

#include <string>
#include <vector>

namespace slom {

/// Returns `3 poses` or `1 pose`.
std::string counted(int count, const std::string& noun);
/// Returns `a`, `a and b` or `a, b and c`. Of more than `most` items, the first ones and `and 7 more`.
std::string listed(const std::vector<std::string>& items, std::size_t most = 4);
/// Returns `pose 0, pose 1, ..., pose 9`: of many items the first two and the last.
std::string abridged(const std::vector<std::string>& items);
/// Returns the number with at most `digits` significant digits: `0.125`.
std::string number(double x, int digits = 3);

}  // namespace slom
