#include "plot.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

#include "text.hpp"

namespace {

/// Formats a number for SVG [px]. Shapes that leave the frame by far stay near it.
double px(double x) { return std::isfinite(x) ? std::min(std::max(x, -4000.0), 4000.0) + 0.0 : 4000; }

std::string number(double x) { return format("%g", std::abs(x) < 1e-12 ? 0.0 : x); }

}  // namespace

Plot::Plot(int width_px, int height_px) : size_(format("%d %d", width_px, height_px)) {
  body_ = format("  <rect width=\"%d\" height=\"%d\" fill=\"white\"/>\n", width_px, height_px);
}

double Plot::right(const Vec2& p) const {
  return px(frame_.x_px + frame_.width_px * (p.x() - frame_.left) / (frame_.right - frame_.left));
}
double Plot::down(const Vec2& p) const {
  return px(frame_.y_px + frame_.height_px * (frame_.top - p.y()) / (frame_.top - frame_.bottom));
}

void Plot::diagram(const Frame& frame, const std::string& title) {
  if (diagrams_ > 0) body_ += "  </g>\n";
  frame_ = frame;
  ++diagrams_;
  const std::string box = format("x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"", frame.x_px,
                                 frame.y_px, frame.width_px, frame.height_px);
  body_ += format("  <clipPath id=\"d%d\"><rect %s/></clipPath>\n", diagrams_, box.c_str());
  body_ += format("  <rect %s fill=\"none\" stroke=\"#c8d0d8\"/>\n", box.c_str());
  if (!title.empty()) {
    body_ += format("  <text x=\"%.1f\" y=\"%.1f\" fill=\"%s\" text-anchor=\"middle\">%s</text>\n",
                    frame.x_px + frame.width_px / 2, frame.y_px - 8, kBlack, title.c_str());
  }
  body_ += format("  <g clip-path=\"url(#d%d)\">\n", diagrams_);
}

void Plot::ticks(double x_step, double y_step, const std::string& x_label, const std::string& y_label) {
  body_ += "  </g>\n";
  const double bottom = frame_.y_px + frame_.height_px;
  const auto mark = [&](double x1, double y1, double x2, double y2) {
    body_ += format("  <line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke=\"#c8d0d8\"/>\n", x1, y1,
                    x2, y2);
  };
  const auto words = [&](double x, double y, const char* anchor, const std::string& text) {
    body_ += format("  <text x=\"%.1f\" y=\"%.1f\" fill=\"#555\" text-anchor=\"%s\">%s</text>\n", x, y,
                    anchor, text.c_str());
  };
  for (double x = std::ceil(frame_.left / x_step - 1e-9) * x_step;
       x_step > 0 && x <= frame_.right + 1e-9 * x_step; x += x_step) {
    const double at = right({x, 0});
    mark(at, bottom, at, bottom + 5);
    words(at, bottom + 20, "middle", number(x));
  }
  for (double y = std::ceil(frame_.bottom / y_step - 1e-9) * y_step;
       y_step > 0 && y <= frame_.top + 1e-9 * y_step; y += y_step) {
    const double at = down({0, y});
    mark(frame_.x_px - 5, at, frame_.x_px, at);
    words(frame_.x_px - 9, at + 5, "end", number(y));
  }
  words(frame_.x_px + frame_.width_px / 2, bottom + 40, "middle", x_label);
  body_ += format(
      "  <text transform=\"translate(%.1f %.1f) rotate(-90)\" fill=\"#555\" text-anchor=\"middle\">%s</text>\n",
      frame_.x_px - 48, frame_.y_px + frame_.height_px / 2, y_label.c_str());
  body_ += format("  <g clip-path=\"url(#d%d)\">\n", diagrams_);
}

void Plot::path(const Points& points, const std::string& style) {
  body_ += "  <path d=\"";
  for (std::size_t i = 0; i < points.size(); ++i)
    body_ += format("%s%.1f %.1f", i == 0 ? "M" : " L", right(points[i]), down(points[i]));
  body_ += "\" " + style + "/>\n";
}

void Plot::curve(const Points& points, const char* colour, double width_px, const char* dashes) {
  path(points, format("fill=\"none\" stroke=\"%s\" stroke-width=\"%g\"%s", colour, width_px,
                      dashes[0] == 0 ? "" : format(" stroke-dasharray=\"%s\"", dashes).c_str()));
}

void Plot::segments(const Points& ends, const char* colour, double width_px) {
  body_ += "  <path d=\"";
  for (std::size_t i = 0; i < ends.size(); ++i)
    body_ += format("%s%.1f %.1f", i % 2 == 0 ? "M" : "L", right(ends[i]), down(ends[i]));
  body_ += format("\" fill=\"none\" stroke=\"%s\" stroke-width=\"%g\"/>\n", colour, width_px);
}

void Plot::area(const Points& points, const char* colour, double opacity) {
  path(points, format("fill=\"%s\" fill-opacity=\"%g\"", colour, opacity));
}

void Plot::dot(const Vec2& p, const char* colour, double radius_px) {
  body_ += format("  <circle cx=\"%.1f\" cy=\"%.1f\" r=\"%g\" fill=\"%s\"/>\n", right(p), down(p), radius_px,
                  colour);
}

void Plot::arrow(const Vec2& from, const Vec2& to, const char* colour) {
  const Vec2 a(right(from), down(from)), b(right(to), down(to));
  const Vec2 along = (b - a).normalized(), across(-along.y(), along.x());
  const Vec2 left = b - 9 * along + 4 * across, right_end = b - 9 * along - 4 * across;
  body_ += format(
      "  <path d=\"M%.1f %.1f L%.1f %.1f M%.1f %.1f L%.1f %.1f L%.1f %.1f\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/>\n",
      a.x(), a.y(), b.x(), b.y(), left.x(), left.y(), b.x(), b.y(), right_end.x(), right_end.y(), colour);
}

void Plot::rectangle(const Vec2& low, const Vec2& high, const char* colour, double opacity) {
  body_ += format(
      "  <rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\" fill-opacity=\"%g\"/>\n",
      right(low), down(high), right(high) - right(low), down(low) - down(high), colour, opacity);
}

void Plot::ellipse(const Vec2& mean, const Eigen::Matrix2d& C, double squared, const char* colour,
                   const char* dashes) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(C);
  const Eigen::Matrix2d root = axes.eigenvectors() * (squared * axes.eigenvalues()).cwiseSqrt().asDiagonal() *
                               axes.eigenvectors().transpose();
  Points points;
  for (int i = 0; i <= 90; ++i) {
    const double t = i * 2 * 3.14159265358979 / 90;
    points.emplace_back(mean + root * Vec2(std::cos(t), std::sin(t)));
  }
  curve(points, colour, 2, dashes);
}

void Plot::text(const Vec2& p, const std::string& words, const char* colour, double dx_px, double dy_px,
                const char* anchor) {
  body_ += format("  <text x=\"%.1f\" y=\"%.1f\" fill=\"%s\" text-anchor=\"%s\">%s</text>\n",
                  right(p) + dx_px, down(p) + dy_px, colour, anchor, words.c_str());
}

std::string Plot::svg() const {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size_ +
         "\" font-family=\"sans-serif\" font-size=\"15\">\n" + body_ + (diagrams_ > 0 ? "  </g>\n" : "") +
         "</svg>\n";
}
