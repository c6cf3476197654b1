// The run in docs/bundle.md is real, except for the iterations.
#include "support/documented_run.hpp"

namespace slom::testing {
namespace {

TEST(BundleDocumentation, ShowsARealRun) { expectRealRun("docs/bundle.md"); }

}  // namespace
}  // namespace slom::testing
