#include "analyze/chart.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/classic_numbers.hpp"
#include "base/words.hpp"

namespace slom {

namespace {

std::string px(double x) {
  const ClassicNumbers points;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", x);
  return text.data();
}

std::string textAt(double x, double y, const char* anchor, const std::string& text, const char* more = "") {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" text-anchor=\"" + anchor + "\"" + more + ">" +
         escapedForXml(text) + "</text>\n";
}

std::string segment(double x1, double y1, double x2, double y2, const char* kind) {
  return "<path class=\"" + std::string(kind) + "\" d=\"M" + px(x1) + " " + px(y1) + "L" + px(x2) + " " +
         px(y2) + "\"/>\n";
}

/// Returns the text of a tick. A tick that differs from 0 only by rounding is 0.
std::string tickText(double x, double step) { return number(std::abs(x) < 1e-9 * step ? 0 : x, 6); }

}  // namespace

ChartRange ChartRange::of(const std::vector<double>& numbers, double margin) {
  double low = 0, high = 0;
  bool is_first = true;
  for (const double x : numbers) {
    if (!std::isfinite(x)) continue;
    low = is_first ? x : std::min(low, x);
    high = is_first ? x : std::max(high, x);
    is_first = false;
  }
  const double width = high - low > 0 ? margin * (high - low) : std::max(0.5, std::abs(high) / 2);
  return {low - width, high + width};
}

std::vector<double> ticks(const ChartRange& range, int count) {
  const double rough = (range.high - range.low) / std::max(1, count);
  const double power = std::pow(10, std::floor(std::log10(rough)));
  const double step = power * (rough / power < 1.5   ? 1
                               : rough / power < 3.5 ? 2
                               : rough / power < 7.5 ? 5
                                                     : 10);
  std::vector<double> result;
  const double first = std::ceil(range.low / step);
  for (int k = 0; (first + k) * step <= range.high && k <= 4 * count; ++k)
    result.push_back((first + k) * step);
  return result;
}

std::string escapedForXml(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t') result += c;
    }
  }
  return result;
}

std::array<double, 2> Chart::place(double x, double y) const {
  return {frame_.left + (x - frame_.x.low) / (frame_.x.high - frame_.x.low) * frame_.width,
          frame_.top + (frame_.y.high - y) / (frame_.y.high - frame_.y.low) * frame_.height};
}

bool Chart::isInside(double x, double y) const {
  return x >= frame_.x.low && x <= frame_.x.high && y >= frame_.y.low && y <= frame_.y.high;
}

void Chart::numbers(const std::vector<double>& at, bool is_x) {
  const double step = at.size() > 1 ? at[1] - at[0] : 1;
  for (const double t : at) {
    const auto [x, y] = is_x ? place(t, frame_.y.low) : place(frame_.x.low, t);
    svg_ += is_x ? textAt(x, y + 16, "middle", tickText(t, step))
                 : textAt(x - 6, y + 4, "end", tickText(t, step));
  }
}

void Chart::axes(const std::string& x_label, const std::string& y_label, bool has_x_numbers) {
  const double bottom = frame_.top + frame_.height, right = frame_.left + frame_.width;
  std::vector<double> at_x = ticks(frame_.x, static_cast<int>(frame_.width / 90)),
                      at_y = ticks(frame_.y, static_cast<int>(frame_.height / 40));
  if (frame_.has_whole_x) std::erase_if(at_x, [](double t) { return t != std::round(t); });
  for (const double t : at_x) svg_ += segment(place(t, 0)[0], frame_.top, place(t, 0)[0], bottom, "grid");
  for (const double t : at_y) svg_ += segment(frame_.left, place(0, t)[1], right, place(0, t)[1], "grid");
  svg_ += "<rect class=\"frame\" x=\"" + px(frame_.left) + "\" y=\"" + px(frame_.top) + "\" width=\"" +
          px(frame_.width) + "\" height=\"" + px(frame_.height) + "\"/>\n";
  numbers(at_y, false);
  if (has_x_numbers) numbers(at_x, true);
  const double middle = frame_.top + frame_.height / 2, side = frame_.left - 58;
  if (has_x_numbers) svg_ += textAt(frame_.left + frame_.width / 2, bottom + 36, "middle", x_label);
  const std::string turn = " transform=\"rotate(-90 " + px(side) + " " + px(middle) + ")\"";
  svg_ += textAt(side, middle, "middle", y_label, turn.c_str());
}

void Chart::title(const std::string& text) {
  svg_ += textAt(frame_.left, frame_.top - 8, "start", text, " class=\"title\"");
}

void Chart::band(const std::vector<double>& x, const std::vector<double>& low,
                 const std::vector<double>& high) {
  std::string path;
  const auto add = [&](double at, double y) {
    const auto [u, v] = place(at, std::clamp(y, frame_.y.low, frame_.y.high));
    path += std::string(path.empty() ? "M" : "L") + px(u) + " " + px(v);
  };
  for (std::size_t i = 0; i < x.size(); ++i) add(x[i], high[i]);
  for (std::size_t i = x.size(); i-- > 0;) add(x[i], low[i]);
  svg_ += "<path class=\"band\" d=\"" + path + "Z\"/>\n";
}

void Chart::line(const std::vector<double>& x, const std::vector<double>& y) {
  std::string path;
  bool is_down = false;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(y[i]) || !isInside(x[i], y[i])) {
      is_down = false;
      continue;
    }
    const auto [u, v] = place(x[i], y[i]);
    path += (is_down ? "L" : "M") + px(u) + " " + px(v);
    is_down = true;
  }
  svg_ += "<path class=\"curve\" d=\"" + path + "\"/>\n";
}

void Chart::level(double y, bool is_dashed) {
  if (!isInside(frame_.x.low, y)) return;
  const double v = place(0, y)[1];
  svg_ += segment(frame_.left, v, frame_.left + frame_.width, v, is_dashed ? "dashed" : "level");
}

void Chart::bar(double x, double y, double half) {
  const auto [u, v] = place(x, std::min(y + half, frame_.y.high));
  svg_ += segment(u, v, u, place(x, std::max(y - half, frame_.y.low))[1], "bar");
}

void Chart::point(double x, double y, const std::string& name, bool is_marked) {
  const auto [u, v] = place(x, y);
  svg_ += "<circle class=\"" + std::string(is_marked ? "marked" : "point") + "\" cx=\"" + px(u) + "\" cy=\"" +
          px(v) + "\" r=\"" + (is_marked ? "4" : "2.5") + "\"" +
          (name.empty() ? "/>" : "><title>" + escapedForXml(name) + "</title></circle>") + "\n";
}

void Chart::label(double x, double y, const std::string& text) {
  const auto [u, v] = place(x, y);
  const bool is_right = u > frame_.left + 0.7 * frame_.width;
  svg_ += textAt(is_right ? u - 7 : u + 7, v + 4, is_right ? "end" : "start", text, " class=\"marked\"");
}

std::string svgFile(double width, double height, const std::string& elements) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + px(width) + "\" height=\"" + px(height) +
         "\" viewBox=\"0 0 " + px(width) + " " + px(height) +
         "\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n"
         "<style>path{fill:none}.frame{fill:none;stroke:#555}.grid{stroke:#e4e4e4}.level{stroke:#555}"
         ".dashed{stroke:#555;stroke-dasharray:5 4}.curve{stroke:#c23b22;stroke-width:1.8}"
         "path.band{fill:#c23b22;fill-opacity:.18}.bar{stroke:#1f5fa8}.point{fill:#1f5fa8}"
         ".marked{fill:#c23b22}.title{font-weight:bold}</style>\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n" +
         elements + "</svg>\n";
}

}  // namespace slom
