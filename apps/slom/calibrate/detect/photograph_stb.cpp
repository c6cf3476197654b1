// Photographs read by stb_image, which reads the formats of cameras and has no dependencies.
#include <algorithm>
#include <cmath>
#include <fcntl.h>
#include <memory>

#include <fmt/format.h>
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>
#include <sys/stat.h>

#include "calibrate/detect/photo_patch.hpp"
#include "calibrate/detect/photograph.hpp"
#include "input_file.hpp"
#include "plausible.hpp"

namespace slom::app::calib {
namespace {

template <class T>
using Pixels = std::unique_ptr<T, decltype(&stbi_image_free)>;

std::optional<Photograph> readDeep(std::FILE* stream) {
  ImageSize size;
  int channels = 0;
  const Pixels<stbi_us> pixels(stbi_load_from_file_16(stream, &size.width, &size.height, &channels, 1),
                               stbi_image_free);
  if (!pixels) return {};
  const std::size_t count = std::size_t(size.width) * size.height;
  const double brightest = std::max<stbi_us>(1, *std::max_element(pixels.get(), pixels.get() + count));
  Photograph photo{size, std::vector<std::uint8_t>(count)};
  std::transform(pixels.get(), pixels.get() + count, photo.grey.begin(),
                 [&](stbi_us value) { return std::uint8_t(std::lround(255 * value / brightest)); });
  return photo;
}

std::optional<Photograph> readShallow(std::FILE* stream) {
  ImageSize size;
  int channels = 0;
  const Pixels<stbi_uc> pixels(stbi_load_from_file(stream, &size.width, &size.height, &channels, 1),
                               stbi_image_free);
  if (!pixels) return {};
  return Photograph{size, {pixels.get(), pixels.get() + std::size_t(size.width) * size.height}};
}

constexpr const char* unreadable = "is not an image that can be read (JPEG, PNG, BMP, PGM), or is damaged";

/// Twice the size of the largest sensors. Reading takes up to four bytes per pixel.
constexpr std::size_t most_pixels = 300'000'000;

/// Opens a regular file. Does not wait, as opening a pipe would.
InputStream openRegular(const std::string& file, std::string& reason) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  InputStream stream(descriptor < 0 ? nullptr : ::fdopen(descriptor, "rb"));
  struct stat status {};
  if (!stream || ::fstat(descriptor, &status) != 0) return reason = "cannot be opened", nullptr;
  if (!S_ISREG(status.st_mode)) return reason = "is not a regular file", nullptr;
  return stream;
}

std::string base64(const std::vector<unsigned char>& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const unsigned rest = unsigned(std::min<std::size_t>(3, bytes.size() - i));
    unsigned word = 0;
    for (unsigned k = 0; k < 3; ++k) word = word << 8 | (k < rest ? bytes[i + k] : 0u);
    for (unsigned k = 0; k < 4; ++k) text += k <= rest ? digits[word >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

std::optional<Photograph> readPhotograph(const std::string& file, std::string& reason) {
  const InputStream stream = openRegular(file, reason);
  if (!stream) return std::nullopt;
  const int first = std::fgetc(stream.get());
  if (first == EOF) return reason = "is empty", std::nullopt;
  std::rewind(stream.get());
  ImageSize size;
  int channels = 0;
  if (stbi_info_from_file(stream.get(), &size.width, &size.height, &channels) == 0)
    return reason = unreadable, std::nullopt;
  if (!isPlausible(size) || std::size_t(size.width) * std::size_t(size.height) > most_pixels) {
    reason = fmt::format("has {} x {} pixels, more than {} on a side or {} in all", size.width, size.height,
                         most_side_px, most_pixels);
    return std::nullopt;
  }
  const bool is_deep = stbi_is_16_bit_from_file(stream.get()) != 0;
  if (is_deep &&
      first == 'P')  // stb_image reads these bytes in the processor's order, which is not the file's
    return reason = "is a PGM of 16 bits, which must be converted, to PNG for example", std::nullopt;
  std::optional<Photograph> photo = is_deep ? readDeep(stream.get()) : readShallow(stream.get());
  if (!photo) reason = unreadable;
  return photo;
}

std::string photoPatch(const std::string& file, const vec2& pixel, int radius, int scale) {
  std::string reason;
  const auto photo = readPhotograph(file, reason);
  if (!photo) return {};
  const int width = 2 * radius + 1, left = int(std::lround(pixel.x())) - radius,
            top = int(std::lround(pixel.y())) - radius;
  const auto [columns, rows] = photo->size;
  std::vector<std::uint8_t> patch(std::size_t(width * scale) * (width * scale), 0);
  for (int v = 0; v < width * scale; ++v) {
    for (int u = 0; u < width * scale; ++u) {
      const int column = left + u / scale, row = top + v / scale;
      const bool inside = column >= 0 && row >= 0 && column < columns && row < rows;
      if (inside)
        patch[std::size_t(v) * (width * scale) + u] = photo->grey[std::size_t(row) * columns + column];
    }
  }
  std::vector<unsigned char> png;
  const auto append = [](void* to, void* bytes, int size) {
    const auto* first = static_cast<unsigned char*>(bytes);
    static_cast<std::vector<unsigned char>*>(to)->insert(static_cast<std::vector<unsigned char>*>(to)->end(),
                                                         first, first + size);
  };
  const int side = width * scale;
  if (stbi_write_png_to_func(append, &png, side, side, 1, patch.data(), side) == 0) return {};
  return "data:image/png;base64," + base64(png);
}

}  // namespace slom::app::calib
