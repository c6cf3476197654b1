// Photographs of boards at known poses, drawn by following each pixel's ray to the board. They are the truth for
// detectors.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "calibrate/detect/board.hpp"
#include "calibrate/detect/photograph.hpp"
#include "calibration/models/fisheye.hpp"
#include "calibration/models/opencv.hpp"
#include "support/temporary_folder.hpp"

namespace slom::app::calib::testing {

/// Brightness of the board's plane at (x, y) [m], 0 to 1.
using Picture = std::function<double(double x, double y)>;

/// White paper with a margin of one square; grey beyond it.
inline Picture chessboardPicture(const Board& board, bool dark_first = true) {
  return [=](double x, double y) {
    const int column = int(std::floor(x / board.square_m)), row = int(std::floor(y / board.square_m));
    if (column < -2 || row < -2 || column > board.columns || row > board.rows) return 0.5;
    if (column < -1 || row < -1 || column > board.columns - 1 || row > board.rows - 1) return 0.95;
    return ((column + row) % 2 == 0) == dark_first ? 0.05 : 0.95;
  };
}

/// A pinhole without distortion, or an equidistant fisheye.
struct Viewer {
  Pinhole camera{700, 700, 322, 236};
  ImageSize size{640, 480};
  bool is_equidistant = false;

  vec2 project(const SE3& board2camera, const vec3& point) const {
    const vec3 p = board2camera * point;
    if (is_equidistant) return Fisheye<>::fromPinhole(camera).project(p);
    return vec2(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
  }

  /// Direction of the ray of a pixel.
  vec3 ray(double u, double v) const {
    const double x = (u - camera.cx) / camera.fx, y = (v - camera.cy) / camera.fy, angle = std::hypot(x, y);
    if (!is_equidistant || angle == 0) return vec3(x, y, 1.);
    return vec3(x / angle * std::sin(angle), y / angle * std::sin(angle), std::cos(angle));
  }

  /// Renders a photograph. Each pixel is the mean of rays around it, spread by a blur of half a pixel, plus a little
  /// noise. If nothing changes within a pixel, one ray is enough.
  Photograph photograph(const SE3& board2camera, const Picture& picture, unsigned seed = 1) const {
    std::mt19937 random(seed);
    std::normal_distribution<> noise(0, 1.5);
    constexpr int rings = 4, around = 12, rays = rings * around;
    std::vector<vec2> offsets;  // as many inside of each ring, so that no direction has more of them
    for (int ring = 0; ring < rings; ++ring) {
      const double radius = 0.5 * std::sqrt(-2 * std::log(1 - (ring + 0.5) / rings));
      for (int k = 0; k < around; ++k) {
        const double angle = 2 * std::numbers::pi * (k + ring * 0.618) / around;
        offsets.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
      }
    }
    const SE3 camera2board = board2camera.inverse();
    const auto brightness = [&](double u, double v) {
      const vec3 direction(camera2board.orient * ray(u, v));
      const double distance = -camera2board.pos.z() / direction.z();
      return distance > 0 ? picture(camera2board.pos.x() + distance * direction.x(),
                                    camera2board.pos.y() + distance * direction.y())
                          : 0.5;
    };
    const int columns = size.width + 2, rows = size.height + 2;  // one more on each side
    std::vector<double> coarse(std::size_t(columns) * rows);
    for (int i = 0; i < columns * rows; ++i)
      coarse[std::size_t(i)] = brightness(i % columns - 1, i / columns - 1);
    Photograph photo{size, std::vector<std::uint8_t>(std::size_t(size.width) * size.height)};
    for (int v = 0; v < size.height; ++v) {
      for (int u = 0; u < size.width; ++u) {
        const std::size_t middle = std::size_t(v + 1) * columns + u + 1;
        double sum = rays * coarse[middle];
        bool is_flat = true;
        for (const int row : {-1, 0, 1}) {
          for (const int column : {-1, 0, 1})
            is_flat = is_flat && coarse[middle + std::size_t(row * columns + column)] == coarse[middle];
        }
        if (!is_flat) {
          sum = 0;
          for (const vec2& offset : offsets) sum += brightness(u + offset.x(), v + offset.y());
        }
        photo.grey[std::size_t(v) * size.width + u] =
            std::uint8_t(std::clamp(20 + 200 * sum / rays + noise(random), 0.0, 255.0));
      }
    }
    return photo;
  }
};

/// The board before the camera: its centre at (x, y, z) [m], tilted about the camera's x and y axes, turned
/// about its own normal.
inline SE3 placed(const Board& board, const vec3& centre, double tilt_x, double tilt_y, double turn) {
  const vec3 last = board.corner(board.cornerCount() - 1);
  const SO3 orient =
      SO3::exp(vec3(tilt_x, 0., 0.)) * SO3::exp(vec3(0., tilt_y, 0.)) * SO3::exp(vec3(0., 0., turn));
  return SE3(orient, vec3(centre - orient * vec3(last / 2)));
}

inline void writePgm(const std::filesystem::path& path, const Photograph& photo) {
  slom::testing::writeFile(path, fmt::format("P5\n{} {}\n255\n", photo.size.width, photo.size.height) +
                                     std::string(photo.grey.begin(), photo.grey.end()));
}

inline Board chessboard(int columns, int rows, double square_m = 0.03) {
  Board board;
  board.columns = columns;
  board.rows = rows;
  board.square_m = square_m;
  return board;
}

}  // namespace slom::app::calib::testing
