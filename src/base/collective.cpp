#include "slom/base/collective.hpp"

namespace slom {

const Collective& singleProcess() {
  static const Collective single;
  return single;
}

}  // namespace slom
