// What the help texts of all subcommands have in common.
#pragma once

namespace slom::app {

/// The group of the options that --help-all alone shows. A subcommand with such options has the flag --help-all.
inline constexpr const char* more_options = "More options";

/// Ends the help of a subcommand that fits a problem from a file.
inline constexpr const char* exit_codes =
    R"(Exit code: 0 success; 1 the fit did not converge or is not determined (the report says why),
or standard output could not be written; 2 wrong options or data.)";

}  // namespace slom::app
