#pragma once
// The sentence with which the command refuses something, for comparison word for word.

#include <string>

#include "error.hpp"

namespace slom::testing {

template <class F>
std::string refusalOf(const F& f) {
  try {
    f();
  } catch (const app::UserError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace slom::testing
