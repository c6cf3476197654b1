// The YAML that OpenCV's FileStorage and people write, and JSON: maps and lists by indentation or in brackets,
// comments, quotes and tags. No anchors, no multi-line texts, no second document.
#include <algorithm>

#include <fmt/format.h>

#include "calibration/files/document.hpp"
#include "calibration/files/text.hpp"

namespace slom::calibration {
namespace {

class YamlReader {
 public:
  explicit YamlReader(Document& document) : document_(document), text_(document.text) {}

  Node read() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = line_begin_ = 3;
    skip();
    while (peek() == '%') skipLine(), skip();
    if (startsWith("---")) at_ += 3, skip();
    if (isAtEnd()) document_.fail(line_, "the file has no keys and values; copy it again");
    Node root = block(0);
    skip();
    if (startsWith("...")) at_ += 3, skip();
    if (!isAtEnd())
      document_.fail(
          line_,
          fmt::format(
              "\"{}\" continues nothing above; correct its indentation, and keep one document in a file",
              shortened(line(), longest_quote)));
    return root;
  }

 private:
  bool isAtEnd() const { return at_ >= text_.size(); }
  char peek() const { return isAtEnd() ? '\0' : text_[at_]; }
  bool startsWith(std::string_view what) const { return text_.substr(at_).starts_with(what); }
  std::size_t column() const { return at_ - line_begin_; }
  std::string_view line() const { return text_.substr(at_, text_.substr(at_).find_first_of("\r\n")); }
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0'; }
  void skipLine() { at_ += line().size(); }

  /// Skips blanks, line ends and comments.
  void skip() {
    for (; !isAtEnd(); ++at_) {
      const char c = peek();
      const bool is_comment =
          (c == '#' && (at_ == line_begin_ || isBlank(text_[at_ - 1]))) || startsWith("//");
      if (is_comment) skipLine();
      if (isAtEnd()) return;
      if (peek() == '\n') ++line_, line_begin_ = at_ + 1;
      if (!isBlank(peek())) return;
    }
  }

  /// Parses the value at `column`: a list or map by indentation, a scalar, or a value in brackets.
  Node block(int depth) {
    requireDepth(depth);
    const std::string_view tag = takeTag();
    Node node = isDash() ? listByDashes(depth) : startsKey() ? mapByLines(depth) : flow(depth);
    if (!tag.empty()) node.type = tag;
    return node;
  }

  void requireDepth(int depth) const {
    if (depth > deepest_document) document_.fail(line_, "lists lie too deep within each other; flatten them");
  }

  /// Parses a tag such as `!!opencv-matrix`, which may be on the line above the value.
  std::string_view takeTag() {
    if (peek() == '&' || peek() == '*' || peek() == '|' || peek() == '>')
      document_.fail(line_, fmt::format("\"{}\" is YAML that is not supported; write plain numbers and texts",
                                        shortened(line(), longest_quote)));
    if (peek() != '!') return {};
    const std::size_t begin = at_;
    while (!isBlank(peek())) ++at_;
    const std::string_view tag = text_.substr(begin, at_ - begin);
    skip();
    return tag.substr(std::min(tag.find_first_not_of('!'), tag.size()));
  }

  bool isDash() const { return peek() == '-' && (at_ + 1 >= text_.size() || isBlank(text_[at_ + 1])); }

  /// Returns whether a key and a colon begin here.
  bool startsKey() const {
    const std::string_view rest = line();
    if (rest.starts_with('{') || rest.starts_with('[')) return false;
    std::size_t end = 0;
    if (const char quote = rest.empty() ? '\0' : rest.front(); quote == '"' || quote == '\'') {
      end = rest.find(quote, 1);
      if (end == std::string_view::npos) return false;
    }
    const std::size_t colon = rest.find(':', end);
    return colon != std::string_view::npos && (colon + 1 == rest.size() || isBlank(rest[colon + 1]));
  }

  Node listByDashes(int depth) {
    Node list{Node::Kind::list, line_};
    const std::size_t indent = column();
    while (!isAtEnd() && column() == indent && isDash()) {
      ++at_;
      const int line_of_dash = line_;
      skip();
      list.items.push_back(hasValue(line_of_dash, indent) ? block(depth + 1)
                                                          : Node{Node::Kind::scalar, line_of_dash});
      skip();
    }
    return list;
  }

  /// Returns whether the text after a dash or colon is its value: on the same line, or indented deeper below.
  bool hasValue(int line_before, std::size_t indent) const {
    return !isAtEnd() && (line_ == line_before || column() > indent);
  }

  Node mapByLines(int depth) {
    Node map{Node::Kind::map, line_};
    const std::size_t indent = column();
    while (!isAtEnd() && column() == indent && startsKey()) {
      addKey(map, key(), line_);
      const int line_of_key = line_;
      skip();
      const bool is_list_below = column() == indent && isDash();  // a list below its key needs no indentation
      map.items.push_back(hasValue(line_of_key, indent) || is_list_below
                              ? block(depth + 1)
                              : Node{Node::Kind::scalar, line_of_key});
      skip();
      if (!isAtEnd() && column() > indent)
        document_.fail(line_, fmt::format("\"{}\" continues nothing above; correct its indentation",
                                          shortened(line(), longest_quote)));
    }
    return map;
  }

  /// Parses a key with its colon.
  std::string_view key() {
    std::string_view name;
    if (peek() == '"' || peek() == '\'') {
      name = quoted();
      skip();
    } else {
      const std::size_t colon = text_.find(':', at_);
      name = trimmed(text_.substr(at_, colon - at_));
      at_ = std::min(colon, text_.size());
    }
    if (peek() != ':')
      document_.fail(
          line_, fmt::format("the key {} has no colon; write one after it", shortened(name, longest_quote)));
    ++at_;
    return name;
  }

  void addKey(Node& map, std::string_view name, int line) {
    if (map.find(name))
      document_.fail(line, fmt::format("{} is there twice; remove one", shortened(name, longest_quote)));
    map.keys.push_back(name);
  }

  /// Parses a value in brackets, or a scalar.
  Node flow(int depth) {
    requireDepth(depth);
    if (peek() == '[') return listInBrackets(depth);
    if (peek() == '{') return mapInBraces(depth);
    Node scalar{Node::Kind::scalar, line_};
    const bool is_quoted = peek() == '"' || peek() == '\'';
    scalar.text = is_quoted ? quoted() : plain(depth_of_brackets_ > 0);
    return scalar;
  }

  Node listInBrackets(int depth) {
    Node list{Node::Kind::list, line_};
    ++at_, ++depth_of_brackets_;
    for (skip(); peek() != ']'; skip()) {
      if (isAtEnd()) failCutOff(list.line);
      list.items.push_back(inBrackets(depth));
      requireComma(list, ']');
    }
    ++at_, --depth_of_brackets_;
    return list;
  }

  Node mapInBraces(int depth) {
    Node map{Node::Kind::map, line_};
    ++at_, ++depth_of_brackets_;
    for (skip(); peek() != '}'; skip()) {
      if (isAtEnd()) failCutOff(map.line);
      addKey(map, key(), line_);
      skip();
      map.items.push_back(inBrackets(depth));
      if (map.keys.back() == "type_id") map.type = map.items.back().text;
      requireComma(map, '}');
    }
    ++at_, --depth_of_brackets_;
    return map;
  }

  Node inBrackets(int depth) {
    const std::string_view tag = takeTag();
    Node node = flow(depth + 1);
    if (!tag.empty()) node.type = tag;
    return node;
  }

  void requireComma(const Node& of, char end) {
    skip();
    if (peek() == ',') {
      ++at_;
    } else if (isAtEnd()) {
      failCutOff(of.line);
    } else if (peek() != end) {
      document_.fail(line_, fmt::format("\"{}\" follows without a comma or {}; write one",
                                        shortened(line(), longest_quote), end));
    }
  }

  [[noreturn]] void failCutOff(int line) const {
    document_.fail(line,
                   "the brackets that begin here do not end; the file seems to be cut off, so copy it again");
  }

  std::string_view quoted() {
    const char quote = peek();
    const std::size_t begin = ++at_;
    std::string plain;
    bool is_changed = false;
    for (; !isAtEnd() && peek() != quote && peek() != '\n'; ++at_) {
      if (quote == '"' && peek() == '\\' && at_ + 1 < text_.size()) is_changed = true, ++at_;
      plain += peek();
    }
    if (peek() != quote) document_.fail(line_, "a text in quotes does not end in its line; end it");
    const std::string_view as_it_is = text_.substr(begin, at_++ - begin);
    return is_changed ? document_.keep(std::move(plain)) : as_it_is;
  }

  /// Takes the text up to a comment or the end of the line; in brackets up to a comma or bracket.
  std::string_view plain(bool is_in_brackets) {
    const std::string_view rest = line();
    std::size_t end = is_in_brackets ? rest.find_first_of(",]}") : rest.size();
    end = std::min({end, rest.find(" #"), rest.find("\t#"), rest.size()});
    at_ += end;
    const std::string_view found = trimmed(rest.substr(0, end));
    if (found.empty()) document_.fail(line_, "there is no value; write one");
    return found;
  }

  Document& document_;
  std::string_view text_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
  int depth_of_brackets_ = 0;
};

}  // namespace

void parseYaml(Document& document) { document.root = YamlReader(document).read(); }

}  // namespace slom::calibration
