/// The version of the library. Versions are semantic (semver.org). A program for one version compiles with later
/// versions of the same major number or, while the major number is 0, of the same minor number. CHANGELOG.md lists what
/// an upgrade breaks.
#pragma once

// The build takes the project's version from these lines.
#define SLOM_VERSION_MAJOR 0
#define SLOM_VERSION_MINOR 3
#define SLOM_VERSION_PATCH 0
