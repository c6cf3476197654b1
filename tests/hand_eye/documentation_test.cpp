// The run in docs/hand_eye.md is real.
#include "support/documented_run.hpp"

namespace slom::testing {
namespace {

TEST(HandEyeDocumentation, ShowsARealRun) { expectRealRun("docs/hand_eye.md"); }

}  // namespace
}  // namespace slom::testing
