// By stb_image, which reads what cameras write and brings nothing else along.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <stb/stb_image.h>
#include <stb/stb_image_write.h>

#include "calibrate/detect/photo_patch.hpp"
#include "calibrate/detect/photograph.hpp"

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
  const auto close = [](std::FILE* stream) { std::fclose(stream); };
  const std::unique_ptr<std::FILE, decltype(close)> stream(std::fopen(file.c_str(), "rb"), close);
  if (!stream) return reason = "cannot be opened", std::nullopt;
  if (std::fgetc(stream.get()) == EOF) return reason = "is empty", std::nullopt;
  std::rewind(stream.get());
  std::optional<Photograph> photo =
      stbi_is_16_bit_from_file(stream.get()) != 0 ? readDeep(stream.get()) : readShallow(stream.get());
  if (!photo) reason = "is no image that can be read (JPEG, PNG, BMP, PGM), or is damaged";
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
