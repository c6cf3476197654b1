// The only kind of error of the command: a mistake that its user can correct.
#pragma once

#include <stdexcept>
#include <string>

namespace slom::app {

/// The error, thrown anywhere in the command. main() prints it as `slom: <text>` and exits with code 2. The text is one
/// sentence: where (file:line, or option), what is wrong and what to do.
struct UserError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Exit codes of the command.
inline constexpr int exit_success = 0;
inline constexpr int exit_not_converged =
    1;  ///< the fit did not converge or is not determined; or output was lost
inline constexpr int exit_user_error = 2;  ///< bad options, bad input, unwritable output

}  // namespace slom::app
