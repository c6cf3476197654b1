// Words for people to read.
#pragma once

#include <cstddef>
#include <string>

namespace slom::app {

/// `1 image`, `2 images`
std::string plural(std::size_t count, const std::string& noun);

/// A sentence as lines of at most 100 characters, broken at spaces, the first with a bullet.
std::string bulleted(const std::string& sentence);

}  // namespace slom::app
