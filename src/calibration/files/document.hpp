// Trees of keys and values from other programs: XML, YAML and JSON of OpenCV's FileStorage, and YAML that people
// write for Kalibr.
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace slom::calibration {

/// A scalar, a list or a map, with its line in the file. The Document owns the texts.
struct Node {
  enum class Kind { scalar, list, map };
  Kind kind = Kind::scalar;
  int line = 0;
  std::string_view text{};               ///< scalar: without quotes
  std::string_view type{};               ///< of XML's type_id or a YAML tag: `opencv-matrix`
  std::vector<std::string_view> keys{};  ///< map: in the order of the file
  std::vector<Node> items{};             ///< list: entries; map: values

  /// Returns the value of a key, or nullptr.
  const Node* find(std::string_view key) const;
};

/// A file as a tree. Errors are DataError [slom.calibration.bad-file] and name file, line, cause and remedy.
class Document {
 public:
  std::string file;
  std::string text;
  Node root;

  Document(std::string file_name, std::string whole) : file(std::move(file_name)), text(std::move(whole)) {}
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// Keeps a text that differs from the file, such as one with escapes replaced.
  std::string_view keep(std::string changed) { return kept_.emplace_back(std::move(changed)); }

  [[noreturn]] void fail(int line, const std::string& fault_and_remedy) const;
  /// Returns the number of a scalar called `key`, of magnitude `most` at most.
  double number(const Node& node, std::string_view key, double most) const;
  /// Returns the whole number from `least` to `most` of a scalar called `key`.
  int whole(const Node& node, std::string_view key, int least, int most) const;

 private:
  std::deque<std::string> kept_;
};

constexpr int deepest_document = 32;  ///< depth of nested lists; matrices of images need 5

/// Parse the text of a document into its root.
void parseXml(Document& document);
void parseYaml(Document& document);  ///< JSON too

}  // namespace slom::calibration
