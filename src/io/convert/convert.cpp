#include "slom/io/convert.hpp"

#include "io/bal/convert.hpp"
#include "io/fault.hpp"
#include "io/g2o/convert.hpp"
#include "slom/io/numbered_lines.hpp"

namespace slom::io {

ContainerContent contentOfText(const std::string& file) {
  for (int pieces = 1 << 20; pieces > 0; pieces = pieces == 1 ? 0 : 1) {
    const PartOfFile part = readLinesOfPart(file, 0, pieces);
    if (part.lines.size() == 0) continue;
    const std::string_view line = part.lines[0];
    const char first = line[line.find_first_not_of(" \t\r")];
    return first >= '0' && first <= '9' ? ContainerContent::bundle : ContainerContent::graph;
  }
  fail("empty-file", file + ": the file is empty; give a pose graph or a bundle adjustment", file);
}

UnknownTags writeContainer(const std::string& text_file, int descriptor, const std::string& name) {
  if (contentOfText(text_file) == ContainerContent::graph)
    return g2o::writeContainer(text_file, descriptor, name);
  bal::writeContainer(text_file, descriptor, name);
  return {};
}

void readAsText(const Container& container, const std::function<void(std::string_view)>& f) {
  container.requireWhole();
  if (container.content() == ContainerContent::graph) {
    g2o::readAsText(container, f);
  } else {
    bal::readAsText(container, f);
  }
}

}  // namespace slom::io
