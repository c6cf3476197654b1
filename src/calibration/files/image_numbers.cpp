#include "slom/calibration/image_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "calibration/median.hpp"
#include "slom/calibration/number_text.hpp"
#include "slom/io/number.hpp"

namespace slom::calibration {
namespace {

/// A time stamp of a source. The 64-bit mantissa holds the 19 digits of nanoseconds.
struct Stamp {
  long double time = 0;
  std::size_t source = 0;
  std::string text;
};

long double timeOf(const std::string& digits) {
  long double time = 0;
  for (const char digit : digits) time = 10 * time + (digit - '0');
  return time;
}

/// Returns the stamps of each source, ascending.
std::vector<std::vector<Stamp>> sortedStamps(const std::vector<std::vector<std::string>>& by_source) {
  std::vector<std::vector<Stamp>> all;
  for (std::size_t source = 0; source < by_source.size(); ++source) {
    std::vector<Stamp>& own = all.emplace_back();
    for (const std::string& text : by_source[source]) own.push_back({timeOf(text), source, text});
    std::sort(own.begin(), own.end(), [](const Stamp& a, const Stamp& b) { return a.time < b.time; });
  }
  return all;
}

double spacingOf(const std::vector<Stamp>& stamps) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < stamps.size(); ++i) gaps.push_back(double(stamps[i].time - stamps[i - 1].time));
  return gaps.empty() ? std::numeric_limits<double>::infinity() : medianOf(gaps);
}

std::size_t nearest(const std::vector<Stamp>& stamps, long double time) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (std::abs(stamps[i].time - time) < std::abs(stamps[best].time - time)) best = i;
  }
  return best;
}

/// A moment: the stamps of the sources that recorded it.
using Moment = std::vector<Stamp>;

/// Adds each stamp of a source to its nearest moment, if within `most`. Makes new moments of the other stamps.
void addSource(const std::vector<Stamp>& stamps, double most, std::vector<Moment>& moments) {
  std::vector<Stamp> heads;
  for (const Moment& moment : moments) heads.push_back(moment.front());
  std::vector<Moment> fresh;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const std::size_t head = heads.empty() ? 0 : nearest(heads, stamps[i].time);
    const bool fits = !heads.empty() && double(std::abs(heads[head].time - stamps[i].time)) <= most &&
                      nearest(stamps, heads[head].time) == i;
    if (fits)
      moments[head].push_back(stamps[i]);
    else
      fresh.push_back({stamps[i]});
  }
  moments.insert(moments.end(), fresh.begin(), fresh.end());
}

bool fitsAll(const std::vector<std::vector<std::string>>& by_source) {
  int ignored = 0;
  return std::all_of(by_source.begin(), by_source.end(), [&](const std::vector<std::string>& own) {
    return std::all_of(own.begin(), own.end(),
                       [&](const std::string& text) { return io::parseNumber(text, ignored); });
  });
}

}  // namespace

ImageNumbers::ImageNumbers(const std::vector<std::vector<std::string>>& by_source)
    : are_stamps_(!fitsAll(by_source)), images_(by_source.size()) {
  if (!are_stamps_) return;
  const auto stamps = sortedStamps(by_source);
  double spacing = std::numeric_limits<double>::infinity();
  for (const auto& own : stamps) spacing = std::min(spacing, spacingOf(own));
  spacing_ = std::isfinite(spacing) ? spacing : 0;
  std::vector<Moment> moments;
  for (const auto& own : stamps) addSource(own, spacing_ / 2, moments);
  std::sort(moments.begin(), moments.end(),
            [](const Moment& a, const Moment& b) { return a.front().time < b.front().time; });
  int number = 0;
  for (const Moment& moment : moments) {
    ++number;
    double largest = 0;
    for (const Stamp& stamp : moment) {
      images_[stamp.source].emplace(stamp.text, number);
      largest = std::max(largest, double(std::abs(stamp.time - moment.front().time)));
    }
    paired_ += largest > 0 ? 1 : 0;
    largest_difference_ = std::max(largest_difference_, largest);
  }
}

int ImageNumbers::of(std::size_t source, const std::string& number) const {
  if (are_stamps_) return images_.at(source).at(number);
  int image = 0;
  io::parseNumber(number, image);
  return image;
}

std::optional<std::int64_t> timeInDigits(const std::string& digits) {
  constexpr std::size_t in_us = 16, in_ns = 19;
  std::int64_t time = 0;
  if ((digits.size() != in_us && digits.size() != in_ns) || !io::parseNumber(digits, time)) return {};
  return digits.size() == in_ns ? time : 1000 * time;
}

std::string sentenceOf(const ImageNumbers& numbers) {
  if (numbers.paired() == 0) return "";
  return fmt::format(
      "image numbers are time stamps; {} {} the nearest stamps of different cameras, which differ by up "
      "to {:.10g}, {} % of their spacing",
      numbers.paired(), numbers.paired() == 1 ? "image pairs" : "images pair", numbers.largestDifference(),
      twoDigits(100 * numbers.largestDifference() / numbers.spacing()));
}

}  // namespace slom::calibration
