// The run that docs/graph.md shows is real, but for the iterations.
#include "support/documented_run.hpp"

namespace slom::testing {
namespace {

TEST(GraphDocumentation, ShowsARealRun) { expectRealRun("docs/graph.md"); }

}  // namespace
}  // namespace slom::testing
