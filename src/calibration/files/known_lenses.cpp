// Lenses that are known: Kalibr's camchain and EuRoC's sensor.yaml.
//   source   https://github.com/ethz-asl/kalibr/wiki/yaml-formats; Burri et al., "The EuRoC micro aerial vehicle
//            datasets", 2016
#include <utility>

#include <fmt/format.h>

#include "calibration/files/document.hpp"
#include "calibration/files/text.hpp"
#include "slom/calibration/files.hpp"
#include "slom/calibration/models.hpp"
#include "slom/io/input_file.hpp"

namespace slom::calibration {
namespace {

constexpr double most_number = 1e6;  // px
constexpr int most_cameras = 100, most_side = 100'000;

class LensReader {
 public:
  LensReader(const Document& document, const Node& camera) : document_(document), camera_(camera) {}

  KnownLens read() const {
    const std::string_view camera = value("camera_model").text;
    if (camera == "ds") return of("double_sphere", {"xi", "alpha", "fx", "fy", "cx", "cy"}, {});
    if (camera != "pinhole") refuse("camera_model", "pinhole or ds");
    const std::string_view distortion = value("distortion_model").text;
    const std::vector<const char*> pinhole{"fx", "fy", "cx", "cy"};
    if (distortion == "radtan" || distortion == "radial-tangential")
      return of("opencv4", pinhole, {"k1", "k2", "p1", "p2"});
    if (distortion == "equidistant" || distortion == "equi")
      return of("fisheye", pinhole, {"k1", "k2", "k3", "k4"});
    refuse("distortion_model", "radtan or equidistant");
  }

 private:
  const Node& value(std::string_view key) const {
    const Node* const found = camera_.kind == Node::Kind::map ? camera_.find(key) : nullptr;
    if (!found)
      document_.fail(camera_.line,
                     fmt::format("there is no {}; give Kalibr's camchain or EuRoC's sensor.yaml", key));
    return *found;
  }

  [[noreturn]] void refuse(std::string_view key, const char* known) const {
    const Node& node = value(key);
    document_.fail(node.line, fmt::format("{} is \"{}\"; the models that can be read are {}", key,
                                          shortened(node.text, longest_quote), known));
  }

  KnownLens of(const char* model, const std::vector<const char*>& intrinsics,
               const std::vector<const char*>& distortion) const {
    KnownLens lens{model, {}, {}};
    append("intrinsics", value("intrinsics"), intrinsics, lens);
    const Node* const coefficients = camera_.find("distortion_coeffs");
    if (!distortion.empty())
      append("distortion_coeffs", coefficients ? *coefficients : value("distortion_coefficients"), distortion,
             lens);
    if (const Node* const size = camera_.find("resolution"); size && size->items.size() == 2)
      lens.image_size = ImageSize{document_.whole(size->items[0], "resolution", 1, most_side),
                                  document_.whole(size->items[1], "resolution", 1, most_side)};
    return lens;
  }

  void append(std::string_view key, const Node& list, const std::vector<const char*>& names,
              KnownLens& lens) const {
    if (list.kind != Node::Kind::list || list.items.size() != names.size())
      document_.fail(list.line, fmt::format("{} has {} numbers instead of {}; correct the file", key,
                                            list.items.size(), names.size()));
    for (std::size_t i = 0; i < names.size(); ++i)
      lens.parameters.emplace_back(names[i], document_.number(list.items[i], key, most_number));
  }

  const Document& document_;
  const Node& camera_;
};

}  // namespace

std::vector<KnownLens> readKnownLenses(const std::string& path) {
  const std::string file = inFolder(path, "sensor.yaml");
  Document document(file, io::readWhole(file));
  parseYaml(document);
  const Node& root = document.root;
  if (root.kind == Node::Kind::map && root.find("camera_model")) return {LensReader(document, root).read()};
  std::vector<KnownLens> lenses;
  for (int n = 0; n < most_cameras; ++n) {
    const Node* const camera = root.kind == Node::Kind::map ? root.find("cam" + std::to_string(n)) : nullptr;
    if (!camera) break;
    lenses.push_back(LensReader(document, *camera).read());
  }
  if (lenses.empty())
    document.fail(root.line, "there is no camera; give Kalibr's camchain or EuRoC's sensor.yaml");
  return lenses;
}

}  // namespace slom::calibration
