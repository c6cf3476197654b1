/// Diagrams as SVG: axes with round numbers, points, lines and bands.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace slom {

/// Limits of an axis.
struct ChartRange {
  double low = 0, high = 1;

  /// The smallest that holds these finite numbers, and a margin.
  static ChartRange of(const std::vector<double>& numbers, double margin = 0.05);
};

/// Numbers at an axis: about `count` round ones within the range.
std::vector<double> ticks(const ChartRange& range, int count);

/// `text` within XML.
std::string escapedForXml(const std::string& text);

/// One diagram within a picture.
class Chart {
 public:
  /// Where it lies in the picture [px], and what it shows.
  struct Frame {
    double left, top, width, height;
    ChartRange x, y;
    bool has_whole_x = false;  // no numbers between whole ones at the axis
  };
  explicit Chart(const Frame& frame) : frame_(frame) {}

  /// Axes with numbers, and what they say. `has_x_numbers` false: another diagram below has them.
  void axes(const std::string& x_label, const std::string& y_label, bool has_x_numbers = true);
  /// A text above the frame.
  void title(const std::string& text);
  /// The region between two curves, given at the same x.
  void band(const std::vector<double>& x, const std::vector<double>& low, const std::vector<double>& high);
  void line(const std::vector<double>& x, const std::vector<double>& y);
  /// A horizontal line through the whole frame.
  void level(double y, bool is_dashed);
  /// A bar from y - half to y + half.
  void bar(double x, double y, double half);
  /// A point; `name` is shown where the pointer rests on it. Marked ones have another colour.
  void point(double x, double y, const std::string& name = "", bool is_marked = false);
  /// A text beside a point.
  void label(double x, double y, const std::string& text);

  /// The elements so far.
  const std::string& svg() const { return svg_; }

 private:
  std::array<double, 2> place(double x, double y) const;
  bool isInside(double x, double y) const;
  void numbers(const std::vector<double>& at, bool is_x);
  Frame frame_;
  std::string svg_;
};

/// The file of a picture of this size [px] with these elements.
std::string svgFile(double width, double height, const std::string& elements);

}  // namespace slom
