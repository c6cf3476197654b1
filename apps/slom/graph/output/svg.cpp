#include "graph/output/svg.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "printable.hpp"
#include "text.hpp"

namespace slom::app::graph {

namespace {

constexpr double page_width = 900, most_height = 1600, margin = 30, footer = 40;  // [px]

constexpr const char* style = R"(<style>
  .page { fill: #ffffff } .path { stroke: #1f5fa8 } .edge { stroke: #d9822b } .mark { stroke: #3a8f4d }
  .fixed { stroke: #b3261e } .ink { stroke: #444444 } text { fill: #444444; font: 14px sans-serif }
  path, circle { fill: none; stroke-linecap: round; stroke-linejoin: round }
  @media (prefers-color-scheme: dark) {
    .page { fill: #16181c } .path { stroke: #7ab4f5 } .edge { stroke: #e0a05a } .mark { stroke: #79c98b }
    .fixed { stroke: #ff8a80 } .ink { stroke: #bbbbbb } text { fill: #bbbbbb }
  }
</style>
)";

/// A place on the page, in hundredths of a pixel. Elements drawn at equal dots are drawn once.
struct Dot {
  long x = 0, y = 0;
  bool operator==(const Dot&) const = default;
};

class Picture {
 public:
  explicit Picture(const Sketch& sketch) : sketch_(sketch) {
    const auto [low, high] = sketch.bounds();
    const double width = high[0] - low[0], height = high[1] - low[1];
    scale_ = (page_width - 2 * margin) / width;
    if (height * scale_ > most_height) scale_ = most_height / height;
    left_ = margin + (page_width - 2 * margin - width * scale_) / 2 - low[0] * scale_;
    bottom_ = margin + high[1] * scale_;
    page_height_ = 2 * margin + footer + height * scale_;
  }

  std::string draw() {
    const std::size_t closures = sketch_.closures.size();
    append(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {:.0f}\" width=\"{}\" "
        "height=\"{:.0f}\">\n",
        page_width, page_height_, page_width, page_height_);
    append("<title>{}: {}, {} that {}</title>\n", xmlText(sketch_.name), plural(sketch_.poses.size(), "pose"),
           plural(closures, "edge"), closures == 1 ? "closes a loop" : "close loops");
    append("{}<rect class=\"page\" width=\"100%\" height=\"100%\"/>\n", style);
    lines("edge", "0.7", "0.55", sketch_.closures);
    lines("path", "1.6", "1", sketch_.path);
    landmarks();
    for (const int pose : sketch_.fixed) {
      const Dot d = dot(sketch_.poses[std::size_t(pose)]);
      append("<circle class=\"fixed\" stroke-width=\"2\" cx=\"{}\" cy=\"{}\" r=\"5\"/>\n", px(d.x), px(d.y));
    }
    scaleBar();
    append("</svg>\n");
    return fmt::to_string(text_);
  }

 private:
  template <class... Args>
  void append(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
  }
  static double px(long hundredths) { return double(hundredths) / 100; }
  Dot dot(const Sketch::Place& place) const {
    return {std::lround(100 * (left_ + scale_ * place[0])), std::lround(100 * (bottom_ - scale_ * place[1]))};
  }

  /// Draws one path; consecutive lines are one stroke.
  void lines(const char* kind, const char* width, const char* opacity, const std::vector<Sketch::Line>& all) {
    if (all.empty()) return;
    append("<path class=\"{}\" stroke-width=\"{}\" stroke-opacity=\"{}\" d=\"", kind, width, opacity);
    int end = -1;
    Dot last;
    for (const auto& [from, to] : all) {
      if (from != end) {
        last = dot(sketch_.poses[std::size_t(from)]);
        append("M{} {}", px(last.x), px(last.y));
      }
      const Dot next = dot(sketch_.poses[std::size_t(to)]);
      if (from != end || next != last) append("L{} {}", px(next.x), px(next.y));
      last = next;
      end = to;
    }
    append("\"/>\n");
  }

  void landmarks() {
    if (sketch_.landmarks.empty()) return;
    append("<path class=\"mark\" stroke-width=\"4\" d=\"");
    for (const auto& landmark : sketch_.landmarks)
      append("M{} {}h0", px(dot(landmark).x), px(dot(landmark).y));
    append("\"/>\n");
  }

  /// Draws the scale bar, in the unit of the file: 1, 2 or 5 times a power of ten, about a fifth of the page long.
  void scaleBar() {
    const double fifth = page_width / 5 / scale_, power = std::pow(10, std::floor(std::log10(fifth)));
    const double length = power * (fifth >= 5 * power ? 5 : fifth >= 2 * power ? 2 : 1);
    const double y = page_height_ - margin;
    append("<path class=\"ink\" stroke-width=\"1.5\" d=\"M{0} {1:.2f}v8M{0} {2:.2f}h{3:.2f}m0 -4v8\"/>\n",
           margin, y - 4, y, length * scale_);
    append("<text x=\"{:.2f}\" y=\"{:.2f}\">{:g}</text>\n", margin + length * scale_ + 10, y + 5, length);
  }

  const Sketch& sketch_;
  double scale_ = 1, left_ = 0, bottom_ = 0, page_height_ = 0;
  fmt::memory_buffer text_;
};

}  // namespace

std::string toSvg(const Sketch& sketch) { return Picture(sketch).draw(); }

}  // namespace slom::app::graph
