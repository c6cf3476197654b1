#include <algorithm>
#include <bzlib.h>
#include <limits>
#include <memory>
#include <new>

#include <fmt/format.h>

#include "io/fault.hpp"
#include "slom/io/bal.hpp"
#include "slom/io/input_file.hpp"

namespace slom::io {

namespace bal {

namespace {

/// Limits of unpacking. A scene shrinks to a quarter. A small file made to fill the memory unpacks to a million times
/// its size.
constexpr std::size_t always_allowed = std::size_t{16} << 20, most_ratio = 100;

/// A decompressor of consecutive compressed streams: some programs write a file as several streams.
class Decompressor {
 public:
  Decompressor(const std::string& file, std::string_view content)
      : file_(file),
        rest_(content),
        packed_(content.size()),
        allowed_(std::min(largest_input, std::max(always_allowed, most_ratio * content.size()))) {}

  std::string run() {
    do {
      readStream();
    } while (!rest_.empty());
    text_.resize(size_);
    return std::move(text_);
  }

 private:
  void readStream() {
    bz_stream stream{};
    require(BZ2_bzDecompressInit(&stream, 0, 0));
    const auto end = [](bz_stream* opened) { BZ2_bzDecompressEnd(opened); };
    const std::unique_ptr<bz_stream, decltype(end)> opened(&stream, end);
    int status = BZ_OK;
    while (status == BZ_OK) status = step(stream);
    if (status != BZ_STREAM_END) require(status);
  }

  int step(bz_stream& stream) {
    if (size_ == text_.size())
      text_.resize(std::min(std::max<std::size_t>(2 * size_, 1 << 20), allowed_ + 1));
    // libbz2 does not write to its input, although its type is not const.
    stream.next_in = const_cast<char*>(rest_.data());
    stream.avail_in = most(rest_.size());
    stream.next_out = text_.data() + size_;
    stream.avail_out = most(text_.size() - size_);
    const unsigned offered = stream.avail_in, space = stream.avail_out;
    const int status = BZ2_bzDecompress(&stream);
    rest_.remove_prefix(offered - stream.avail_in);
    size_ += space - stream.avail_out;
    if (size_ > allowed_) {
      io::fail(
          "damaged",
          fmt::format("{}: its {} bytes unpack to more than {}, too many for a scene; get the file again",
                      file_, packed_, allowed_),
          file_);
    }
    const bool is_stuck = status == BZ_OK && rest_.empty() && stream.avail_out > 0;
    return is_stuck ? BZ_UNEXPECTED_EOF : status;
  }

  static unsigned most(std::size_t size) {
    return unsigned(std::min<std::size_t>(size, std::numeric_limits<int>::max()));
  }

  void require(int status) const {
    if (status == BZ_OK) return;
    if (status == BZ_MEM_ERROR) throw std::bad_alloc();
    io::fail("damaged",
             fmt::format("{}: the compressed file {}; get it again", file_,
                         status == BZ_UNEXPECTED_EOF ? "ends too early" : "is damaged"),
             file_);
  }

  const std::string& file_;
  std::string_view rest_;
  std::size_t packed_, allowed_;  // sizes [bytes]
  std::string text_;
  std::size_t size_ = 0;  // number of characters in text_
};

}  // namespace
}  // namespace bal

const bool has_bzip2 = true;

std::string bzip2Decompressed(const std::string& file, std::string_view content) {
  return bal::Decompressor(file, content).run();
}

}  // namespace slom::io
