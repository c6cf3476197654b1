#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include "io/bal/limits.hpp"
#include "io/fault.hpp"
#include "slom/io/bal_part.hpp"
#include "slom/io/number.hpp"

namespace slom::io {

namespace bal {

namespace {

constexpr std::size_t head_size = 3, observation_size = 4;

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  constexpr const char* blanks = " \t\r\v\f";
  for (std::size_t at = line.find_first_not_of(blanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(blanks, end);
  }
  return words;
}

class PartParser {
 public:
  PartParser(const std::string& file, const NumberedLines& lines, const BalPlace& place, BalPart& part)
      : file_(file), lines_(lines), place_(place), part_(part) {}

  void parse() {
    const BalCounts& counts = place_.counts;
    const std::int64_t observations_end =
        std::int64_t{head_size} + std::int64_t{observation_size} * counts.observations;
    const std::int64_t cameras_end = observations_end + std::int64_t{bal_camera_size} * counts.cameras;
    const std::int64_t end = cameras_end + std::int64_t{bal_point_size} * counts.points;
    std::int64_t word = place_.first_word;
    for (int i = 0; i < lines_.size(); ++i) {
      const auto words = wordsOf(lines_[i]);
      line_ = lines_.number(i);
      if (word >= std::int64_t{head_size} && word < observations_end) {
        observation(words, (word - std::int64_t{head_size}) / std::int64_t{observation_size});
      } else if (word >= std::int64_t{head_size}) {
        for (std::size_t k = 0; k < words.size(); ++k) {
          const std::int64_t place = word + std::int64_t(k);
          if (place >= end) refuseRest(words[k]);
          number(words[k], place < cameras_end,
                 place - (place < cameras_end ? observations_end : cameras_end));
        }
      }
      word += std::int64_t(words.size());
    }
    const bool is_last = place_.first_word < place_.word_count && word == place_.word_count;
    if (is_last && place_.word_count < end)
      failLine(fmt::format(
          "the file ends before the last point is complete: {}; complete the file, or correct the first line",
          announced()));
  }

 private:
  [[noreturn]] void failLine(const std::string& what) const { failAt("bad-line", file_, line_, what); }
  [[noreturn]] void refuseRest(std::string_view word) const {
    failLine(fmt::format(
        "\"{}\" comes after the last point, where the file should end: {}; correct the first line, or "
        "remove the rest",
        shortened(word, longest), announced()));
  }
  std::string announced() const {
    const auto counted = [](std::int64_t count, const char* noun) {
      return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
    };
    return fmt::format("the first line announces {}, {} and {}", counted(place_.counts.cameras, "camera"),
                       counted(place_.counts.points, "point"),
                       counted(place_.counts.observations, "observation"));
  }

  void observation(const std::vector<std::string_view>& words, std::int64_t number) {
    if (words.size() != observation_size)
      failLine(fmt::format(
          "an observation has 4 numbers on a line, \"camera point u v\", but this line has {}; {}",
          words.size() > observation_size ? "more than 4" : std::to_string(words.size()), announced()));
    BalObservation seen{number, 0, 0, line_, 0, 0};
    index(words[0], "camera", place_.counts.cameras, seen.camera);
    index(words[1], "point", place_.counts.points, seen.point);
    pixel(words[2], number, pixel_parts[0], seen.u);
    pixel(words[3], number, pixel_parts[1], seen.v);
    part_.observations.push_back(seen);
  }
  void index(std::string_view word, const char* what, int count, int& value) const {
    if (!parseNumber(word, value))
      failLine(fmt::format("the {} of this observation is \"{}\"; write a whole number there", what,
                           shortened(word, longest)));
    if (value >= 0 && value < count) return;
    const std::string known =
        count == 1 ? fmt::format("is 1 {}, with number 0", what)
                   : fmt::format("are {} {}s, with numbers from 0 to {}", count, what, count - 1);
    failLine(fmt::format("this observation is of {} {}, but there {}; correct it, or the first line", what,
                         value, known));
  }
  void pixel(std::string_view word, std::int64_t number, const char* part, double& value) const {
    if (!parseNumber(word, value) || !std::isfinite(value))
      failLine(fmt::format("{} of observation {} is \"{}\"; write a finite number there", part, number,
                           shortened(word, longest)));
    if (!(std::abs(value) <= most_px))
      failLine(fmt::format("{} of observation {} is \"{}\"; write a number from {:g} to {:g} [px] there",
                           part, number, shortened(word, longest), -most_px, most_px));
  }

  void number(std::string_view word, bool is_camera, std::int64_t place) {
    const int size = is_camera ? bal_camera_size : bal_point_size;
    BalNumber entry{int(place / size), int(place % size), 0};
    const auto k = std::size_t(entry.part);
    if (!parseNumber(word, entry.value) || !std::isfinite(entry.value))
      failLine(fmt::format("{} of {} {} is \"{}\"; write a finite number there",
                           is_camera ? camera_parts[k] : point_parts[k], is_camera ? "camera" : "point",
                           entry.item, shortened(word, longest)));
    if (is_camera && entry.part == focal_part &&
        !(entry.value >= least_focal_px && entry.value <= most_focal_px))
      failLine(fmt::format("f of camera {} is \"{}\"; write a focal length from {:g} to {:g} [px] there",
                           entry.item, shortened(word, longest), least_focal_px, most_focal_px));
    (is_camera ? part_.cameras : part_.points).push_back(entry);
  }

  static constexpr std::size_t longest = 40;  // of a word in a message

  const std::string& file_;
  const NumberedLines& lines_;
  const BalPlace& place_;
  BalPart& part_;
  int line_ = 0;
};

}  // namespace
}  // namespace bal

Camera cameraFromBal(std::span<const double, bal_camera_size> numbers) {
  const Eigen::Map<const Eigen::Matrix<double, bal_camera_size, 1>> x(numbers.data());
  Camera camera;
  camera.pose = {mtk::SO3<>::exp(mtk::vect<3>(x.head<3>())), mtk::vect<3>(x.segment<3>(3))};
  camera.lens = slom::SnavelyIntrinsics<>(x.tail<3>());
  return camera;
}

void refuseEmptyBal(const std::string& file) {
  fail("empty-file",
       file + ": the file is empty; a BAL file begins with a line \"cameras points observations\"", file);
}

std::int64_t countBalWords(const NumberedLines& lines) {
  std::int64_t words = 0;
  for (int i = 0; i < lines.size(); ++i) words += std::int64_t(bal::wordsOf(lines[i]).size());
  return words;
}

BalCounts readBalCounts(const std::string& file, const NumberedLines& lines) {
  const auto words = bal::wordsOf(lines[0]);
  std::array<std::int64_t, bal::head_size> counts{};
  const std::array<const char*, bal::head_size> names{"cameras", "points", "observations"};
  for (std::size_t k = 0; k < counts.size() && k < words.size(); ++k) {
    if (parseNumber(words[k], counts[k]) && counts[k] > 0 && counts[k] <= std::numeric_limits<int>::max())
      continue;
    failAt("bad-line", file, lines.number(0),
           fmt::format(
               "the number of {} is \"{}\"; a BAL file begins with a line \"cameras points observations\" of "
               "whole numbers from 1 on",
               names[k], shortened(words[k], 40)));
  }
  if (words.size() != bal::head_size)
    failAt(
        "bad-line", file, lines.number(0),
        "a BAL file begins with three numbers on a line, \"cameras points observations\"; correct this one");
  return {int(counts[0]), int(counts[1]), counts[2]};
}

void parseBal(const std::string& file, const NumberedLines& lines, const BalPlace& place, BalPart& part) {
  bal::PartParser(file, lines, place, part).parse();
}

}  // namespace slom::io
