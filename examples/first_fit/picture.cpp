#include "picture.hpp"

#include <cmath>
#include <cstdio>

#include <Eigen/Eigenvalues>

namespace {

constexpr double kScale = 60;             // [px/m]
constexpr double kLeft = -2.2, kTop = 8;  // top left corner of the picture, in the plane of the anchors [m]

double right(const Eigen::Vector2d& p) { return kScale * (p.x() - kLeft); }
double down(const Eigen::Vector2d& p) { return kScale * (kTop - p.y()); }

template <class... Numbers>
std::string text(const char* format, const Numbers&... numbers) {
  char line[400];
  std::snprintf(line, sizeof line, format, numbers...);
  return line;
}

std::string circle(const Eigen::Vector2d& p, double radius_px, const char* style) {
  return text("  <circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" %s/>\n", right(p), down(p), radius_px, style);
}

std::string label(const Eigen::Vector2d& p, const std::string& words, const char* colour) {
  return text("  <text x=\"%.1f\" y=\"%.1f\" fill=\"%s\">%s</text>\n", right(p) + 9, down(p) - 7, colour,
              words.c_str());
}

}  // namespace

std::string picture(const std::vector<Reading>& readings, const Eigen::Vector2d& plain,
                    const Eigen::Vector2d& robust, const Eigen::Matrix2d& covariance) {
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 740 600\" font-family=\"sans-serif\" font-size=\"15\">\n"
      "  <rect width=\"740\" height=\"600\" fill=\"white\"/>\n";
  for (const Reading& r : readings) {
    const bool is_wrong =
        std::abs((robust - r.anchor).norm() - r.distance) > 5 * 0.05;  // five standard deviations
    svg += circle(r.anchor, kScale * r.distance,
                  is_wrong ? "fill=\"none\" stroke=\"#c0392b\" stroke-width=\"1.5\" stroke-dasharray=\"7 5\""
                           : "fill=\"none\" stroke=\"#9db4c8\" stroke-width=\"1.2\"");
  }
  for (const Reading& r : readings) {
    svg += circle(r.anchor, 5, "fill=\"#222\"") + label(r.anchor, r.anchor_name, "#222");
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const Eigen::Vector2d lengths = 20 * kScale * (5.991 * axes.eigenvalues()).cwiseSqrt();
  const Eigen::Vector2d major = axes.eigenvectors().col(1) * (axes.eigenvectors()(0, 1) < 0 ? -1 : 1);
  const double degrees = std::atan2(-major.y(), major.x()) * 180 / 3.14159265358979;
  svg += text(
      "  <ellipse rx=\"%.1f\" ry=\"%.1f\" transform=\"translate(%.1f %.1f) rotate(%.1f)\" fill=\"#1a7f3722\" stroke=\"#1a7f37\"/>\n",
      lengths[1], lengths[0], right(robust), down(robust), degrees);
  svg += circle(plain, 5, "fill=\"#c0392b\"") + label(plain, "all distances count alike", "#c0392b");
  svg += circle(robust, 5, "fill=\"#1a7f37\"");
  svg += text("  <text x=\"%.1f\" y=\"%.1f\" fill=\"#1a7f37\" text-anchor=\"end\">with a loss</text>\n",
              right(robust) - 9, down(robust) + 18);
  return svg + "</svg>\n";
}
