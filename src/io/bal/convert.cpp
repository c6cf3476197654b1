#include "io/bal/convert.hpp"

#include <bit>
#include <optional>

#include <fmt/format.h>

#include "io/bal/container.hpp"
#include "io/pieces.hpp"
#include "slom/io/bal.hpp"

namespace slom::io::bal {

namespace {

/// Adds numbers of cameras or points, which come one after another, as records.
class RecordJoiner {
 public:
  RecordJoiner(ContainerWriter& writer, std::size_t section, std::size_t size)
      : writer_(writer), section_(section), size_(size) {}
  void add(const std::vector<BalNumber>& numbers) {
    for (const BalNumber& number : numbers) {
      words_.push_back(std::bit_cast<std::uint64_t>(number.value));
      if (words_.size() < size_) continue;
      writer_.add(section_, words_);
      words_.clear();
    }
  }

 private:
  ContainerWriter& writer_;
  std::size_t section_, size_;
  std::vector<std::uint64_t> words_;
};

}  // namespace

void writeContainer(const std::string& text_file, int descriptor, const std::string& name) {
  BalPlace place;
  forEachPiece(text_file, [&](const NumberedLines& lines) {
    if (place.word_count == 0 && lines.size() > 0) place.counts = readBalCounts(text_file, lines);
    place.word_count += countBalWords(lines);
  });
  if (place.word_count == 0) refuseEmptyBal(text_file);
  ContainerWriter writer(descriptor, name, ContainerContent::bundle, sectionsOf(place.counts));
  RecordJoiner cameras(writer, camera_section, bal_camera_size),
      points(writer, point_section, bal_point_size);
  forEachPiece(text_file, [&](const NumberedLines& lines) {
    BalPart part;
    parseBal(text_file, lines, place, part);
    place.first_word += countBalWords(lines);
    for (const BalObservation& seen : part.observations) {
      const std::uint64_t words[] = {std::uint64_t(seen.camera), std::uint64_t(seen.point),
                                     std::bit_cast<std::uint64_t>(seen.u),
                                     std::bit_cast<std::uint64_t>(seen.v)};
      writer.add(observation_section, words);
    }
    cameras.add(part.cameras);
    points.add(part.points);
  });
  writer.finish();
}

void readAsText(const Container& container, const std::function<void(std::string_view)>& f) {
  const BalCounts counts = readBalCounts(container);
  TextPieces pieces(f);
  appendBalCounts(pieces.text(), std::size_t(counts.cameras), std::size_t(counts.points),
                  std::size_t(counts.observations));
  const auto read = [&](Section which, const Container::Visit& visit) {
    const ContainerSection& section = sectionIn(container, which);
    container.read(section, {0, section.count}, visit);
  };
  read(observation_section, [&](std::uint64_t, std::span<const std::uint64_t> words) {
    const mtk::vect<2> pixel(std::bit_cast<double>(words[2]), std::bit_cast<double>(words[3]));
    appendBal(pieces.text(), Observation{int(words[0]), int(words[1]), 0, pixel});
  });
  for (const Section which : {camera_section, point_section}) {
    read(which, [&](std::uint64_t, std::span<const std::uint64_t> words) {
      for (const std::uint64_t word : words) appendBal(pieces.text(), std::bit_cast<double>(word));
    });
  }
  pieces.flush();
}

}  // namespace slom::io::bal
