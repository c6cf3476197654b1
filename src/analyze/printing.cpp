#include "slom/analyze/printing.hpp"

#include <ostream>

namespace Eigen {
SLOM_PRINT_ALL()
}  // namespace Eigen
