#pragma once
// The sentence with which the command refuses something, for comparison word for word.

#include <string>

#include <mtk/error.hpp>

#include "error.hpp"

namespace slom::testing {

template <class F>
std::string refusalOf(const F& f) {
  try {
    f();
  } catch (const app::UserError& error) {
    return error.what();
  } catch (const mtk::Error& error) {
    return std::string(error.sentence());
  }
  return "no error";
}

}  // namespace slom::testing
