#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "io/bal/limits.hpp"
#include "io/bal/words.hpp"
#include "io/fault.hpp"
#include "slom/io/bal.hpp"
#include "slom/io/bal_part.hpp"
#include "slom/io/input_file.hpp"
#include "slom/io/number.hpp"

namespace slom::io {

namespace bal {

namespace {

constexpr const char* observation_form = "camera point u v";

class Reader {
 public:
  Reader(const std::string& file, std::string_view text) : words_(file, text), size_(text.size()) {
    scene_.file = file;
  }

  Scene read() {
    readCounts();
    readAll(scene_.observations, observations_, [this](int i) { return observation(i); });
    readAll(scene_.cameras, cameras_, [this](int i) { return camera(i); });
    readAll(scene_.points, points_, [this](int i) { return mtk::vect<3>(numbers("point", i, point_parts)); });
    if (words_.next()) {
      words_.fail(
          fmt::format("{} comes after the last point, where the file should end: {}; correct the first line, "
                      "or remove the rest",
                      words_.quoted(), announced()));
    }
    return std::move(scene_);
  }

 private:
  /// Reads `count` items; `make(i)` reads item i. Reserves no more memory than the file can fill.
  template <class T, class F>
  void readAll(std::vector<T>& things, int count, const F& make) {
    constexpr std::size_t least_bytes = 6;  // "0 0 0\n"
    things.reserve(std::min(std::size_t(count), size_ / least_bytes));
    for (int i = 0; i < count; ++i) things.push_back(make(i));
  }

  void readCounts() {
    if (!words_.next()) refuseEmptyBal(scene_.file);
    cameras_ = count("cameras");
    nextCount();
    points_ = count("points");
    nextCount();
    observations_ = count("observations");
    if (words_.moreOnLine()) failCounts();
  }
  void nextCount() {
    if (!words_.moreOnLine()) failCounts();
    words_.next();
  }
  [[noreturn]] void failCounts() const {
    words_.fail(
        "a BAL file begins with three numbers on a line, \"cameras points observations\"; correct this one");
  }
  int count(const char* what) const {
    int value = 0;
    if (parseNumber(words_.word(), value) && value > 0) return value;
    words_.fail(
        fmt::format("the number of {} is {}; a BAL file begins with a line \"cameras points "
                    "observations\" of whole numbers from 1 on",
                    what, words_.quoted()));
  }

  Observation observation(int i) {
    Observation result;
    next("observation", i);
    result.line = words_.line();
    result.camera = index("camera", cameras_);
    nextOnLine(1);
    result.point = index("point", points_);
    for (int k = 0; k < 2; ++k) {
      nextOnLine(2 + k);
      result.pixel[k] = pixel(i, pixel_parts[std::size_t(k)]);
    }
    if (words_.moreOnLine()) failObservation("more than 4");
    return result;
  }
  void nextOnLine(int words_before) {
    if (!words_.moreOnLine()) failObservation(std::to_string(words_before));
    words_.next();
  }
  [[noreturn]] void failObservation(const std::string& words) const {
    words_.fail(fmt::format("an observation has 4 numbers on a line, \"{}\", but this line has {}; {}",
                            observation_form, words, announced()));
  }
  int index(const char* what, int count) const {
    int value = 0;
    if (!parseNumber(words_.word(), value)) {
      words_.fail(
          fmt::format("the {} of this observation is {}; write a whole number there", what, words_.quoted()));
    }
    if (value >= 0 && value < count) return value;
    const std::string known =
        count == 1 ? fmt::format("is 1 {}, with number 0", what)
                   : fmt::format("are {} {}s, with numbers from 0 to {}", count, what, count - 1);
    words_.fail(fmt::format("this observation is of {} {}, but there {}; correct it, or the first line", what,
                            value, known));
  }

  Camera camera(int i) {
    const auto x = numbers("camera", i, camera_parts);
    return cameraFromBal(std::span<const double, bal_camera_size>(x.data(), bal_camera_size));
  }

  /// Reads the next numbers, on whatever lines, as item number i.
  template <std::size_t N>
  Eigen::Matrix<double, int(N), 1> numbers(const char* thing, int i,
                                           const std::array<const char*, N>& parts) {
    Eigen::Matrix<double, int(N), 1> values;
    for (std::size_t k = 0; k < N; ++k) {
      next(thing, i);
      values[Eigen::Index(k)] = number(thing, i, parts[k]);
      if (std::string_view(parts[k]) == "f") requireFocalLength(i, values[Eigen::Index(k)]);
    }
    return values;
  }
  void next(const char* thing, int i) {
    if (words_.next()) return;
    words_.fail(fmt::format(
        "the file ends before {} {} is complete: {}; complete the file, or correct the first line", thing, i,
        announced()));
  }
  double number(const char* thing, int i, const char* part) const {
    double value = 0;
    if (words_.number(value)) return value;
    words_.fail(
        fmt::format("{} of {} {} is {}; write a finite number there", part, thing, i, words_.quoted()));
  }
  /// Throws unless the focal length is plausible. Otherwise a point that moves a little away from the axis would leave
  /// the image, or not move in it at all.
  void requireFocalLength(int i, double f) const {
    if (f >= least_focal_px && f <= most_focal_px) return;
    words_.fail(fmt::format("f of camera {} is {}; write a focal length from {:g} to {:g} [px] there", i,
                            words_.quoted(), least_focal_px, most_focal_px));
  }
  double pixel(int i, const char* part) const {
    const double value = number("observation", i, part);
    if (std::abs(value) <= most_px) return value;
    words_.fail(fmt::format("{} of observation {} is {}; write a number from {:g} to {:g} [px] there", part,
                            i, words_.quoted(), -most_px, most_px));
  }
  static std::string counted(int count, const char* noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
  }
  std::string announced() const {
    return fmt::format("the first line announces {}, {} and {}", counted(cameras_, "camera"),
                       counted(points_, "point"), counted(observations_, "observation"));
  }

  Words words_;
  std::size_t size_;
  Scene scene_;
  int cameras_ = 0, points_ = 0, observations_ = 0;
};

Scene sceneFrom(const Container& container) {
  const BalCounts counts = readBalCounts(container);
  container.requireWhole();
  const BalPart part = readBalPart(container, 0, 1);
  Scene scene;
  scene.file = container.file();
  for (const BalObservation& seen : part.observations)
    scene.observations.push_back({seen.camera, seen.point, seen.line, mtk::vect<2>(seen.u, seen.v)});
  for (std::size_t i = 0; i < part.cameras.size(); i += bal_camera_size) {
    std::array<double, bal_camera_size> numbers{};
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] = part.cameras[i + k].value;
    scene.cameras.push_back(cameraFromBal(numbers));
  }
  scene.points.resize(std::size_t(counts.points));
  for (const BalNumber& number : part.points)
    scene.points[std::size_t(number.item)][number.part] = number.value;
  return scene;
}

}  // namespace
}  // namespace bal

Scene readScene(const std::string& file) {
  if (isContainer(file)) return bal::sceneFrom(Container(file));
  std::string content = readWhole(file);
  if (content.starts_with("BZh")) content = bzip2Decompressed(file, content);
  return parseScene(file, content);
}

Scene parseScene(const std::string& file, std::string_view text) { return bal::Reader(file, text).read(); }

}  // namespace slom::io
