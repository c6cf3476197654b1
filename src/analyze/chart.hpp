/// Diagrams as SVG: axes with round numbers, points, lines and bands.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace slom {

/// Limits of an axis.
struct ChartRange {
  double low = 0, high = 1;

  /// Returns the smallest range that holds these finite numbers, plus a margin.
  static ChartRange of(const std::vector<double>& numbers, double margin = 0.05);
};

/// Returns about `count` round numbers within the range, for an axis.
std::vector<double> ticks(const ChartRange& range, int count);

/// Returns `text`, escaped for XML.
std::string escapedForXml(const std::string& text);

/// One diagram within a picture.
class Chart {
 public:
  /// Position in the picture [px], and ranges of the axes.
  struct Frame {
    double left, top, width, height;
    ChartRange x, y;
    bool has_whole_x = false;  // true: only whole numbers at the axis
  };
  explicit Chart(const Frame& frame) : frame_(frame) {}

  /// Draws axes with numbers and labels. Pass `has_x_numbers` false if a diagram below shows the numbers.
  void axes(const std::string& x_label, const std::string& y_label, bool has_x_numbers = true);
  /// Writes a text above the frame.
  void title(const std::string& text);
  /// Fills the region between two curves given at the same x.
  void band(const std::vector<double>& x, const std::vector<double>& low, const std::vector<double>& high);
  void line(const std::vector<double>& x, const std::vector<double>& y);
  /// Draws a horizontal line through the whole frame.
  void level(double y, bool is_dashed);
  /// Draws a bar from y - half to y + half.
  void bar(double x, double y, double half);
  /// Draws a point. `name` appears when the pointer rests on the point. A marked point has another colour.
  void point(double x, double y, const std::string& name = "", bool is_marked = false);
  /// Writes a text beside a point.
  void label(double x, double y, const std::string& text);

  /// Returns the elements drawn so far.
  const std::string& svg() const { return svg_; }

 private:
  std::array<double, 2> place(double x, double y) const;
  bool isInside(double x, double y) const;
  void numbers(const std::vector<double>& at, bool is_x);
  Frame frame_;
  std::string svg_;
};

/// Returns the file of a picture of this size [px] with these elements.
std::string svgFile(double width, double height, const std::string& elements);

}  // namespace slom
