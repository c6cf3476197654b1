#include "io/bal/container.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "io/bal/limits.hpp"
#include "io/fault.hpp"

namespace slom::io {

namespace bal {

namespace {

[[noreturn]] void refuseNumber(const Container& container, const std::string& what) {
  fail("bad-scene",
       fmt::format("{}: {}; correct the program that writes the container", container.file(), what),
       container.file());
}

BalObservation observationFrom(const Container& container, const BalCounts& counts, std::uint64_t number,
                               std::span<const std::uint64_t> words) {
  const auto refuseIndex = [&](const char* what, std::uint64_t value, int count) {
    refuseNumber(container,
                 fmt::format("observation {} is of {} {}, but there are {} {}s, with numbers from 0 on",
                             number, what, value, count, what));
  };
  if (words[0] >= std::uint64_t(counts.cameras)) refuseIndex("camera", words[0], counts.cameras);
  if (words[1] >= std::uint64_t(counts.points)) refuseIndex("point", words[1], counts.points);
  const BalObservation seen{std::int64_t(number),
                            int(words[0]),
                            int(words[1]),
                            int(std::min<std::uint64_t>(number + 2, std::numeric_limits<int>::max())),
                            std::bit_cast<double>(words[2]),
                            std::bit_cast<double>(words[3])};
  for (std::size_t k = 0; k < pixel_parts.size(); ++k) {
    const double value = k == 0 ? seen.u : seen.v;
    if (!(std::abs(value) <= most_px))
      refuseNumber(container, fmt::format("{} of observation {} is {}, which is not from {:g} to {:g} [px]",
                                          pixel_parts[k], number, value, -most_px, most_px));
  }
  return seen;
}

template <std::size_t N>
void addNumbers(const Container& container, const char* what, const std::array<const char*, N>& parts,
                std::uint64_t number, std::span<const std::uint64_t> words, std::vector<BalNumber>& to) {
  for (std::size_t k = 0; k < N; ++k) {
    const auto value = std::bit_cast<double>(words[k]);
    const bool is_good = k == std::size_t(focal_part) ? value >= least_focal_px && value <= most_focal_px
                                                      : std::isfinite(value);
    if (!is_good) refuseNumber(container, fmt::format("{} of {} {} is {}", parts[k], what, number, value));
    to.push_back({int(number), int(k), value});
  }
}

}  // namespace
}  // namespace bal

BalCounts readBalCounts(const Container& container) {
  container.requireContent(ContainerContent::bundle);
  const auto count = [&](bal::Section which) {
    const ContainerSection& section = bal::sectionIn(container, which);
    if (section.count == 0 || section.count > std::uint64_t(std::numeric_limits<int>::max()))
      bal::refuseNumber(container, fmt::format("there are {} records {}; 1 to {} are possible", section.count,
                                               section.name, std::numeric_limits<int>::max()));
    return int(section.count);
  };
  return {count(bal::camera_section), count(bal::point_section), count(bal::observation_section)};
}

BalPart readBalPart(const Container& container, int part, int parts) {
  using namespace bal;
  const BalCounts counts = readBalCounts(container);
  BalPart result;
  const auto reserve = [&](auto& numbers, std::int64_t count) {
    numbers.reserve(std::size_t(count / parts + 1));
  };
  reserve(result.observations, counts.observations);
  reserve(result.cameras, std::int64_t{bal_camera_size} * counts.cameras);
  reserve(result.points, std::int64_t{bal_point_size} * counts.points);
  const auto read = [&](Section which, const Container::Visit& visit) {
    const ContainerSection& section = sectionIn(container, which);
    container.read(section, rangeOf(section, part, parts), visit);
  };
  read(observation_section, [&](std::uint64_t number, std::span<const std::uint64_t> words) {
    result.observations.push_back(observationFrom(container, counts, number, words));
  });
  read(camera_section, [&](std::uint64_t number, std::span<const std::uint64_t> words) {
    addNumbers(container, "camera", camera_parts, number, words, result.cameras);
  });
  read(point_section, [&](std::uint64_t number, std::span<const std::uint64_t> words) {
    addNumbers(container, "point", point_parts, number, words, result.points);
  });
  return result;
}

}  // namespace slom::io
