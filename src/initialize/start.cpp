#include "slom/initialize/start.hpp"

namespace slom::initialize {

const char* toString(Start start) {
  switch (start) {
    case Start::given:
      return "given";
    case Start::odometry:
      return "odometry";
    case Start::spanning_tree:
      return "spanning tree";
    case Start::chordal:
      return "chordal";
    case Start::build_up:
      return "build-up";
  }
  return "unknown";
}

}  // namespace slom::initialize
