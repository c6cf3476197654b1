#pragma once
#include <string>
#include <vector>

#include <Eigen/Core>

using Vec2 = Eigen::Vector2d;
using Points = std::vector<Vec2>;

inline constexpr const char* kBlue = "#1f5fa8";
inline constexpr const char* kRed = "#c0392b";
inline constexpr const char* kGreen = "#1a7f37";
inline constexpr const char* kGrey = "#8a97a5";
inline constexpr const char* kBlack = "#222";

/// Position of a diagram in the picture [px], and the range of its coordinates.
struct Frame {
  double x_px, y_px, width_px, height_px;
  double left, right, bottom, top;
};

/// An SVG of one or more diagrams. Shapes use the coordinates of the latest diagram.
class Plot {
 public:
  Plot(int width_px, int height_px);

  /// Begins a diagram with a frame. Everything outside of the frame is clipped.
  void diagram(const Frame& frame, const std::string& title = "");
  /// Draws marks and numbers along both axes, in steps of the given lengths; 0: none.
  void ticks(double x_step, double y_step, const std::string& x_label, const std::string& y_label);

  void curve(const Points& points, const char* colour, double width_px = 2, const char* dashes = "");
  /// Draws unconnected lines: each from a point of even index to the next one.
  void segments(const Points& ends, const char* colour, double width_px = 1);
  void area(const Points& points, const char* colour, double opacity);
  void dot(const Vec2& p, const char* colour, double radius_px = 4);
  void arrow(const Vec2& from, const Vec2& to, const char* colour);
  void rectangle(const Vec2& low, const Vec2& high, const char* colour, double opacity = 1);
  /// Draws the points with (x - mean)^T C^-1 (x - mean) = squared.
  void ellipse(const Vec2& mean, const Eigen::Matrix2d& C, double squared, const char* colour,
               const char* dashes = "");
  /// Writes a text. `anchor`: start, middle or end.
  void text(const Vec2& p, const std::string& words, const char* colour = kBlack, double dx_px = 8,
            double dy_px = -6, const char* anchor = "start");
  std::string svg() const;

 private:
  double right(const Vec2& p) const;
  double down(const Vec2& p) const;
  void path(const Points& points, const std::string& style);

  std::string body_, size_;
  Frame frame_{0, 0, 1, 1, 0, 1, 0, 1};
  int diagrams_ = 0;
};

/// Returns (x, f(x)) for `count` values of x from `low` to `high`.
template <class F>
Points graph(const F& f, double low, double high, int count = 200) {
  Points points;
  for (int i = 0; i < count; ++i) {
    const double x = low + (high - low) * i / (count - 1);
    points.emplace_back(x, f(x));
  }
  return points;
}
