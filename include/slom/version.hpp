/// The version of the library. Versions are semantic (semver.org): programs for one version compile with later ones that have the
/// same major number or, while that is 0, the same minor number. CHANGELOG.md says what an upgrade breaks.
#pragma once

// The build takes the project's version from these lines.
#define SLOM_VERSION_MAJOR 0
#define SLOM_VERSION_MINOR 3
#define SLOM_VERSION_PATCH 0
