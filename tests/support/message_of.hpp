#pragma once
// The text of the error that a call throws, for comparison word for word.

#include <string>

#include "mtk/error.hpp"

namespace slom::testing {

template <class F>
std::string messageOf(F&& f) {
  try {
    f();
  } catch (const mtk::Error& e) {
    return e.what();
  }
  return "no error";
}

}  // namespace slom::testing
