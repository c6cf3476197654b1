// The XML of OpenCV's FileStorage: elements, text of numbers and words, comments. No namespaces, no CDATA sections.
#include <cctype>

#include <fmt/format.h>

#include "calibration/files/document.hpp"
#include "calibration/files/text.hpp"

namespace slom::calibration {
namespace {

class XmlReader {
 public:
  explicit XmlReader(Document& document) : document_(document), rest_(document.text) {}

  Node read() {
    if (rest_.starts_with("\xEF\xBB\xBF")) take(3);
    skipBetween();
    const auto [name, root] = element(0);
    if (name != "opencv_storage")
      document_.fail(root.line, fmt::format("the file begins with <{}>; OpenCV's files of corners begin with "
                                            "<opencv_storage>, so give one of cv::FileStorage",
                                            shortened(name, longest_quote)));
    skipBetween();
    if (!rest_.empty()) document_.fail(line_, "there is text after </opencv_storage>; remove it");
    return root;
  }

 private:
  struct Named {
    std::string_view name;
    Node node;
  };

  void take(std::size_t count) {
    for (const char c : rest_.substr(0, count)) line_ += c == '\n' ? 1 : 0;
    rest_.remove_prefix(std::min(count, rest_.size()));
  }

  [[noreturn]] void failCutOff(int line, std::string_view what) {
    document_.fail(line,
                   fmt::format("{} does not end; the file seems to be cut off, so copy it again", what));
  }

  /// Takes the text up to and including `end`.
  std::string_view takeTo(std::string_view end, std::string_view what) {
    const std::size_t at = rest_.find(end);
    if (at == std::string_view::npos) failCutOff(line_, what);
    const std::string_view before = rest_.substr(0, at);
    take(at + end.size());
    return before;
  }

  void skipBlanks() { take(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }

  /// Skips comments and declarations.
  void skipBetween() {
    for (skipBlanks();; skipBlanks()) {
      if (rest_.starts_with("<!--")) {
        takeTo("-->", "a comment");
      } else if (rest_.starts_with("<?")) {
        takeTo("?>", "a declaration");
      } else {
        return;
      }
    }
  }

  static std::string_view upTo(std::string_view text, const char* characters) {
    return text.substr(0, text.find_first_of(characters));
  }

  Named element(int depth) {
    if (depth > deepest_document)
      document_.fail(line_, "elements lie too deep within each other; flatten them");
    if (rest_.empty()) failCutOff(line_, "<opencv_storage>");
    if (!rest_.starts_with('<'))
      document_.fail(line_, fmt::format("\"{}\" is not XML; write elements as cv::FileStorage does",
                                        shortened(upTo(rest_, "\n"), longest_quote)));
    Named result;
    result.node.line = line_;
    take(1);
    std::string_view tag = takeTo(">", "an element");
    const bool is_empty = tag.ends_with('/');
    if (is_empty) tag.remove_suffix(1);
    result.name = upTo(tag, " \t\r\n");
    const std::size_t type = tag.find("type_id=");
    if (type != std::string_view::npos && type + 9 < tag.size())
      result.node.type = upTo(tag.substr(type + 9), "\"'");
    if (!is_empty) content(result, depth);
    return result;
  }

  /// Parses children or text, and the end tag.
  void content(Named& parent, int depth) {
    for (skipBetween(); !rest_.starts_with("</"); skipBetween()) {
      if (rest_.empty())
        failCutOff(parent.node.line, fmt::format("<{}>", shortened(parent.name, longest_quote)));
      if (rest_.front() == '<')
        addChild(parent.node, depth);
      else
        words(parent.node);
    }
    take(2);
    if (trimmed(takeTo(">", "an element")) == parent.name) return;
    const std::string name = shortened(parent.name, longest_quote);
    document_.fail(line_, fmt::format("<{0}> of line {1} ends with another name; close it by </{0}>", name,
                                      parent.node.line));
  }

  void addChild(Node& node, int depth) {
    const int line = line_;
    if (node.kind == Node::Kind::scalar && !node.text.empty())
      document_.fail(line, "there is an element after text; remove one of them");
    Named child = element(depth + 1);
    const Node::Kind kind = child.name == "_" ? Node::Kind::list : Node::Kind::map;
    if (node.items.empty()) node.kind = kind;
    if (kind != node.kind)
      document_.fail(line, "entries of lists, <_>, are mixed with others; write one or the other");
    if (kind == Node::Kind::map) {
      if (node.find(child.name))
        document_.fail(line,
                       fmt::format("{} is there twice; remove one", shortened(child.name, longest_quote)));
      node.keys.push_back(child.name);
    }
    node.items.push_back(std::move(child.node));
  }

  /// Parses the text of an element: one word is a scalar, several are a list.
  void words(Node& node) {
    std::vector<Node> found;
    for (skipBlanks(); !rest_.empty() && rest_.front() != '<'; skipBlanks()) {
      Node word;
      word.line = line_;
      if (rest_.front() == '"') {
        take(1);
        word.text = unescaped(takeTo("\"", "a text in quotes"));
      } else {
        word.text = unescaped(upTo(rest_, " \t\r\n<"));
        take(upTo(rest_, " \t\r\n<").size());
      }
      found.push_back(word);
    }
    if (!node.items.empty() || !node.text.empty())
      document_.fail(line_, "there is text after an element; remove it");
    if (found.size() == 1) {
      node.text = found.front().text;
    } else {
      node.kind = Node::Kind::list;
      node.items = std::move(found);
    }
  }

  std::string_view unescaped(std::string_view text) {
    if (text.find('&') == std::string_view::npos) return text;
    constexpr std::pair<std::string_view, char> entities[] = {
        {"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}};
    std::string plain;
    while (!text.empty()) {
      std::size_t length = 1;
      char c = text.front();
      for (const auto& [entity, meaning] : entities) {
        if (text.starts_with(entity)) c = meaning, length = entity.size();
      }
      plain += c;
      text.remove_prefix(length);
    }
    return document_.keep(std::move(plain));
  }

  Document& document_;
  std::string_view rest_;
  int line_ = 1;
};

}  // namespace

void parseXml(Document& document) { document.root = XmlReader(document).read(); }

}  // namespace slom::calibration
