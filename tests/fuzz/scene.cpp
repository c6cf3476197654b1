// Bundle adjustments in BAL's format, uncompressed. A scene that is read, checked and written again stays the same.
#include <slom/io/bal.hpp>

#include "bundle/check.hpp"
#include "bundle/output/output.hpp"
#include "fuzz/target.hpp"

SLOM_FUZZ_TARGET(scene) {
  using namespace slom::app::bundle;
  using slom::io::parseScene, slom::io::toBal;
  Scene scene;
  const auto read = [&] {
    scene = parseScene("FILE", input);
    checkScene(scene, SceneNumbers::ofWhole(scene));
  };
  if (!accepted(read)) return;
  const Scene second = parseScene("FILE", toBal(scene));
  require(second.cameras.size() == scene.cameras.size() && second.points.size() == scene.points.size() &&
              second.observations.size() == scene.observations.size(),
          "the scene that was written has other sizes");
  require(!toPly(scene).empty(), "no PLY");
}
