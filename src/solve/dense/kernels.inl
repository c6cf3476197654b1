// The kernels for one instruction set: included by one source for each, which is compiled for it. Everything is local to
// that source, down to `smaller` instead of std::min: the linker keeps one copy of a library's inline function, and it
// must not be one that was compiled for a newer processor.
#include <utility>

#include "vectors.inl"

#include "columns.inl"
#include "fronts.inl"
#include "points.inl"
#include "products.inl"
#include "triangles.inl"

namespace slom::dense {
namespace {

constexpr Kernels makeKernels(const char* name) {
  return {name,          &factorize,   &solveStripes, &updateStripes,  &addToPanel,   &addToUpdate,    &addShuffledToPanel, &addShuffledToUpdate, &forwardPivots,
          &forwardRows, &backwardRows, &backwardPivots, &addProduct, &gram, &addPairs, &solveRight, &subtractOuters,
          &subtractProduct, &subtractTransposedProduct, &eliminate, &forwardColumn, &backwardColumn};
}

}  // namespace
}  // namespace slom::dense
