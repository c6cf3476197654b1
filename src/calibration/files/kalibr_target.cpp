// Kalibr's description of a calibration target, a small YAML file.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "calibration/files/document.hpp"
#include "calibration/files/text.hpp"
#include "slom/calibration/files.hpp"
#include "slom/io/input_file.hpp"

namespace slom::calibration {
namespace {

constexpr int most_target_side = 1000;

class TargetReader {
 public:
  explicit TargetReader(const Document& document) : document_(document) {}

  KalibrTarget read() const {
    if (document_.root.kind != Node::Kind::map || !document_.root.find("target_type"))
      document_.fail(document_.root.line,
                     "there is no target_type; give Kalibr's YAML of a target, or COLUMNSxROWS");
    const Node& type = value("target_type");
    KalibrTarget target;
    if (type.text == "checkerboard") {
      size(target, "targetCols", "targetRows");
      target.column_spacing_m = length("colSpacingMeters"), target.row_spacing_m = length("rowSpacingMeters");
    } else if (type.text == "circlegrid") {
      target.kind = KalibrTarget::Kind::circlegrid;
      size(target, "targetCols", "targetRows");
      target.column_spacing_m = target.row_spacing_m = length("spacingMeters");
      target.is_asymmetric = flag("asymmetricGrid");
    } else if (type.text == "aprilgrid") {
      target.kind = KalibrTarget::Kind::aprilgrid;
      size(target, "tagCols", "tagRows");
      target.tag_m = length("tagSize"), target.spacing = length("tagSpacing");
    } else {
      document_.fail(type.line,
                     fmt::format("target_type is \"{}\"; write checkerboard, circlegrid or aprilgrid",
                                 shortened(type.text, longest_quote)));
    }
    return target;
  }

 private:
  const Node& value(std::string_view key) const {
    const Node* const found = document_.root.find(key);
    if (!found) document_.fail(document_.root.line, fmt::format("the target has no {}; add it", key));
    if (found->kind != Node::Kind::scalar)
      document_.fail(found->line, fmt::format("{} is no single value; write one", key));
    return *found;
  }

  void size(KalibrTarget& target, std::string_view columns, std::string_view rows) const {
    target.columns = document_.whole(value(columns), columns, 1, most_target_side);
    target.rows = document_.whole(value(rows), rows, 1, most_target_side);
  }

  double length(std::string_view key) const {
    const Node& node = value(key);
    const double length = document_.number(node, key, most_corner_m);
    if (!(length > 0))
      document_.fail(node.line, fmt::format("{} is {:g}; write a positive number", key, length));
    return length;
  }

  bool flag(std::string_view key) const {
    const Node* const node = document_.root.find(key);
    if (!node) return false;
    for (const auto& [word, meaning] : {std::pair<std::string_view, bool>{"true", true},
                                        {"True", true},
                                        {"1", true},
                                        {"yes", true},
                                        {"false", false},
                                        {"False", false},
                                        {"0", false},
                                        {"no", false}}) {
      if (node->text == word) return meaning;
    }
    document_.fail(node->line, fmt::format("{} is \"{}\"; write true or false", key,
                                           shortened(node->text, longest_quote)));
  }

  const Document& document_;
};

}  // namespace

KalibrTarget readKalibrTarget(const std::string& file) {
  Document document(file, io::readWhole(file));
  parseYaml(document);
  return TargetReader(document).read();
}

}  // namespace slom::calibration
