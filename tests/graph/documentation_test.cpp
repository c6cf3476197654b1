// The run in docs/graph.md is real, except for the iterations.
#include "support/documented_run.hpp"

namespace slom::testing {
namespace {

TEST(GraphDocumentation, ShowsARealRun) { expectRealRun("docs/graph.md"); }

}  // namespace
}  // namespace slom::testing
